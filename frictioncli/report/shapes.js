"use strict";
/* Shapes of SVG charts: elements of a page, marks, hints and scales. */
const frictionShapes = (() => {
  const SVG = "http://www.w3.org/2000/svg";
  /* Outlines of the marks, to follow a move to their centre. */
  const MARKS = {
    o: "m-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z",
    s: "m-2.7 -2.7h5.4v5.4h-5.4z",
    "^": "m0 -3.4l3.3 6h-6.6z",
    v: "m0 3.4l3.3 -6h-6.6z",
    D: "m0 -3.7l3.7 3.7l-3.7 3.7l-3.7 -3.7z",
    P: "m-1.2 -3.5h2.4v2.3h2.3v2.4h-2.3v2.3h-2.4v-2.3h-2.3v-2.4h2.3z",
  };
  const GHOST = "m-1.3 0a1.3 1.3 0 1 0 2.6 0a1.3 1.3 0 1 0 -2.6 0z";

  function shape(parent, name, attributes, text) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return parent.appendChild(made);
  }

  function element(parent, name, text, kind) {
    const made = document.createElement(name);
    if (kind) made.className = kind;
    made.textContent = text;
    return parent.appendChild(made);
  }

  function hint(element, text) {
    const title = element.querySelector("title");
    if (title) title.textContent = text;
    else shape(element, "title", {}, text);
  }

  /* One outline of many marks: a thousand elements of their own would be slow to move. */
  function outline(mark, xs, ys) {
    return xs.map((x, at) => `M${x.toFixed(1)} ${ys[at].toFixed(1)}${mark}`).join("");
  }

  const scale = (low, high, from, to) => (value) => from + ((value - low) / (high - low)) * (to - from);

  function extent(values) {
    return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)],
      [Infinity, -Infinity]);
  }

  return { MARKS, GHOST, element, shape, hint, outline, scale, extent };
})();
