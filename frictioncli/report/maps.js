"use strict";
/* The cells of the residual maps: by pointer or by keyboard each tells its mean, and shows its points
   in the chart. The cells of all maps are one stop of the tab key; arrow keys go from cell to cell. */
const frictionMaps = (() => {
  const SVG = "http://www.w3.org/2000/svg";
  const { shown } = frictionNumbers;
  const { meanInCell } = frictionPoints;
  const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

  function link(figure, data, points, showCell) {
    const svg = figure.querySelector("svg");
    const maps = [...figure.querySelectorAll('[id*="-cells-"]')].map((element) => {
      const [across, up, channel, model] = element.id.split("-cells-")[1].split("-");
      return { element, across, up, channel, model: model === "base" ? "base" : "extended" };
    });
    if (!maps.length) return;
    const columns = (map) => data.cells[map.across].texts.length, rows = (map) => data.cells[map.up].texts.length;

    /* Limits of a cell as shares of its axis, and the number of the cell at a share. */
    function limits(name, number) {
      const { texts, edges } = data.cells[name], count = texts.length;
      if (!edges) return [number / count, (number + 1) / count];
      return [edges[number], edges[number + 1]].map((edge) => (edge - edges[0]) / (edges[count] - edges[0]));
    }

    function cellAt(name, share) {
      const count = data.cells[name].texts.length;
      return Array.from({ length: count }, (_, number) => number).findLast((number) => limits(name, number)[0] <= share) ?? 0;
    }

    function label({ map, column, row }) {
      const { mean, count } = meanInCell(data, points, { [map.across]: column, [map.up]: row }, map.model, map.channel);
      const where = `${map.channel}, ${map.model} model: ${data.cells[map.across].texts[column]}, ${data.cells[map.up].texts[row]}`;
      if (!count) return `${where}: no data`;
      // a load channel beside a motor current has another unit, and no points in the chart
      const value = map.channel === "load" && !data.load ? "" : ` mean residual ${shown(mean)} ${data.unit},`;
      return `${where}:${value} ${count} points`;
    }

    /* The frame around a cell: it takes the focus and the pointer. */
    function frame(at) {
      const { map, column, row } = at, box = map.element.getBBox();
      const [left, right] = limits(map.across, column), [bottom, top] = limits(map.up, row);
      const made = document.createElementNS(SVG, "rect");
      const text = label(at);
      for (const [name, value] of Object.entries({
        class: "cell", x: box.x + left * box.width, y: box.y + (1 - top) * box.height,
        width: (right - left) * box.width, height: (top - bottom) * box.height,
        role: "button", tabindex: -1, "aria-label": `${text}; Enter shows them in the chart`,
      })) made.setAttribute(name, value);
      made.appendChild(document.createElementNS(SVG, "title")).textContent = text;
      return svg.appendChild(made);
    }

    let here = { map: maps[0], column: 0, row: rows(maps[0]) - 1 }, focused = null, pointed = null;

    /* Move the stop of the tab key to a cell. */
    function stopAt(at) {
      const before = focused;
      [here, focused] = [at, frame(at)];
      focused.setAttribute("tabindex", 0);
      focused.addEventListener("keydown", pressed);
      return before;
    }

    /* The map beside another, with the nearest cell: maps stand in rows of equal axes. */
    function beyond({ map, column, row }, [right, up]) {
      const from = map.element.getBoundingClientRect();
      const ahead = maps.filter((other) => {
        const to = other.element.getBoundingClientRect();
        return right ? Math.abs(to.top - from.top) < 2 && right * (to.left - from.left) > 2
          : Math.abs(to.left - from.left) < 2 && up * (from.top - to.top) > 2;
      }).sort((one, other) => {
        const away = ({ element }) => {
          const to = element.getBoundingClientRect();
          return Math.abs(to.left - from.left) + Math.abs(to.top - from.top);
        };
        return away(one) - away(other);
      });
      if (!ahead.length) return null;
      const next = ahead[0];
      return {
        map: next,
        column: right ? (right > 0 ? 0 : columns(next) - 1) : Math.floor(((column + 0.5) / columns(map)) * columns(next)),
        row: up ? (up > 0 ? 0 : rows(next) - 1) : row,
      };
    }

    function pressed(event) {
      if (event.key === "Enter" || event.key === " ") {
        event.preventDefault();
        show(here);
        return;
      }
      let next = null;
      if (event.key === "Home") next = { ...here, column: 0 };
      else if (event.key === "End") next = { ...here, column: columns(here.map) - 1 };
      else if (STEPS[event.key]) {
        const [right, up] = STEPS[event.key];
        const [column, row] = [here.column + right, here.row + up];
        const inside = column >= 0 && column < columns(here.map) && row >= 0 && row < rows(here.map);
        next = inside ? { map: here.map, column, row } : beyond(here, [right, up]);
      } else return;
      event.preventDefault();
      if (!next) return;
      const before = stopAt(next);
      focused.focus();
      before.remove();
    }

    const show = ({ map, column, row }) => showCell({ [map.across]: column, [map.up]: row }, map.across);

    /* The cell under the pointer, if there is one. */
    function under(event) {
      for (const map of maps) {
        const { left, top, width, height } = map.element.getBoundingClientRect();
        const [x, y] = [(event.clientX - left) / width, 1 - (event.clientY - top) / height];
        if (x >= 0 && x < 1 && y >= 0 && y < 1) return { map, column: cellAt(map.across, x), row: cellAt(map.up, y) };
      }
      return null;
    }

    figure.addEventListener("click", (event) => {
      const found = under(event);
      if (found) show(found);
    });
    figure.addEventListener("pointermove", (event) => {
      const found = under(event);
      const same = found && pointed && ["map", "column", "row"].every((name) => pointed.at[name] === found[name]);
      if (same) return;
      if (pointed) pointed.frame.remove();
      pointed = found ? { at: found, frame: frame(found) } : null;
    });
    figure.addEventListener("pointerleave", () => { if (pointed) pointed.frame.remove(); pointed = null; });
    // a picture has no parts for a screen reader, a group has
    svg.setAttribute("role", "group");
    stopAt(here);
  }

  return link;
})();
