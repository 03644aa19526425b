"use strict";
/* Figures as files: SVG and PNG are made from the page itself, when they are asked for. */
(() => {
  const SCALE = 3;

  function save(blob, name) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  function markup(shown) {
    const svg = shown.cloneNode(true);
    for (const cell of svg.querySelectorAll(".cell")) cell.remove();
    return `<?xml version="1.0" encoding="utf-8"?>\n${new XMLSerializer().serializeToString(svg)}`;
  }

  function savePng(svg, name) {
    const picture = new Image();
    picture.onload = () => {
      const box = svg.viewBox.baseVal;
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [box.width * SCALE, box.height * SCALE].map(Math.round);
      canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => save(blob, name), "image/png");
    };
    picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(markup(svg))}`;
  }

  for (const button of document.querySelectorAll("button[data-save]")) {
    button.hidden = false;
    button.addEventListener("click", () => {
      const figure = button.closest("figure");
      const svg = figure.querySelector(".card svg");
      if (button.dataset.save === "png") savePng(svg, `${figure.id}.png`);
      else save(new Blob([markup(svg)], { type: "image/svg+xml" }), `${figure.id}.svg`);
    });
  }
})();
