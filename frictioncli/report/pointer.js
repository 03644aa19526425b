"use strict";
/* The values under the pointer in every figure whose axes are quantities. Points with values of their own
   show these instead. */
(() => {
  const { shown } = frictionNumbers;
  const FINEST = 6;

  const decimals = (low, high) => Math.min(FINEST, Math.max(0, 2 - Math.floor(Math.log10(Math.abs(high - low)))));

  function value([name, low, high, logarithmic], share) {
    const at = logarithmic ? low * (high / low) ** share : low + share * (high - low);
    const [, words, unit] = name.match(/^(.*?)(?: \[(.*)\])?$/);
    const digits = logarithmic ? decimals(0, at) : decimals(low, high);
    return `${words}: ${shown(at, digits)}${unit ? ` ${unit}` : ""}`;
  }

  function texts(panels, { x, y }) {
    const panel = panels.find(([[left, upper, right, lower]]) => left <= x && x <= right && upper <= y && y <= lower);
    if (!panel) return [];
    const [[left, upper, right, lower], across, up] = panel;
    return [value(across, (x - left) / (right - left)), value(up, (lower - y) / (lower - upper))];
  }

  for (const svg of document.querySelectorAll("svg[data-panels]")) {
    const panels = JSON.parse(svg.dataset.panels), card = svg.closest(".card");
    if (!panels.length || !card) continue;
    const box = card.appendChild(document.createElement("p"));
    box.className = "pointer";
    box.setAttribute("aria-hidden", "true"); // the tables have the values
    box.hidden = true;
    svg.addEventListener("pointermove", (event) => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      const found = event.target.querySelector(":scope > title") ? [] : texts(panels, at);
      box.hidden = !found.length;
      if (box.hidden) return;
      box.replaceChildren(...found.flatMap((text, line) => (line ? [document.createElement("br"), text] : [text])));
      const { left, top, width } = card.getBoundingClientRect(), x = event.clientX - left;
      box.style.top = `${event.clientY - top + 14}px`;
      box.style.left = x < width / 2 ? `${x + 12}px` : "auto";
      box.style.right = x < width / 2 ? "auto" : `${width - x + 12}px`;
    });
    svg.addEventListener("pointerleave", () => { box.hidden = true; });
  }
})();
