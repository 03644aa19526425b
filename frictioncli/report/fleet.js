"use strict";
/* The table of a fleet: sorted and filtered here, drawn a hundred rows at a time, so that thousands
   of joints stay fluid. All values come from the page's JSON; texts are only ever set as text. */
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const AT_ONCE = 100, MOST_PRINTED = 1000;
  const box = document.querySelector(".joints");
  const data = JSON.parse(document.getElementById("fleet").textContent);
  const part = (name) => box.querySelector(`[data-part="${name}"]`);
  const place = Object.fromEntries(data.columns.map((column, at) => [column.key, at]));
  const text = (row) => data.searched.map((key) => row[place[key]] ?? "").join(" ").toLowerCase();
  const rows = data.rows.map((cells, at) => ({ cells, at, text: text(cells) }));
  let sorted = { key: null, falling: false };
  let chosen = rows, drawn = 0;

  /* Three significant digits, as everywhere in the reports. */
  function number(value) {
    if (value === 0) return "0";
    const size = Math.floor(Math.log10(Math.abs(value)));
    const shown = size < -4 ? value.toExponential(2) : value.toFixed(Math.max(2 - size, 0));
    return shown.replace(/-/g, "\u2212");
  }

  /* With the decimals that its interval deserves, one more to see the side of zero, and a sign. */
  function change(value, digits) {
    const shown = Math.abs(value).toFixed(Math.min(digits, 20));
    return (Number(shown) === 0 ? "" : value < 0 ? "\u2212" : "+") + shown;
  }

  function add(parent, name, content, kind) {
    const made = document.createElement(name);
    if (kind) made.className = kind;
    if (content !== undefined) made.textContent = content;
    return parent.appendChild(made);
  }

  function shape(parent, name, attributes) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return parent.appendChild(made);
  }

  function spark(cell, [values, share]) {
    const width = 120, height = 26, room = 3;
    const reach = Math.max(share * 1.2, ...values.map(Math.abs)) || 1;
    const x = (at) => room + (at / Math.max(values.length - 1, 1)) * (width - 2 * room);
    const y = (value) => height / 2 - (value / reach) * (height / 2 - room);
    const svg = shape(cell, "svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img",
      "aria-label": `friction by run: ${values.map(number).join(", ")}` });
    shape(svg, "title", {}).textContent = `${values.map(number).join(", ")} ${data.unit}`;
    if (share) shape(svg, "rect", { class: "band", x: 0, width, y: y(share), height: y(-share) - y(share) });
    shape(svg, "line", { class: "zero", x1: 0, x2: width, y1: height / 2, y2: height / 2 });
    shape(svg, "polyline", { class: "line",
      points: values.map((value, at) => `${x(at).toFixed(1)},${y(value).toFixed(1)}`).join(" ") });
    const last = values.length - 1;
    shape(svg, "circle", { class: "last", cx: x(last), cy: y(values[last]), r: 2.6 });
  }

  function fill(cell, column, value, row) {
    if (["number", "count", "interval"].includes(column.kind)) cell.className = "number";
    if (value === null) { cell.textContent = "–"; return; }
    if (column.kind === "spark") spark(cell, value);
    else if (column.kind === "number") cell.textContent = number(value);
    else if (column.kind === "count") cell.textContent = value;
    else if (column.kind === "interval") {
      const [estimate, low, high] = value;
      const digits = Math.max(1 - Math.floor(Math.log10(0.55 * (high - low))), 0);
      add(cell, low > 0 || high < 0 ? "b" : "span", change(estimate, digits));
      add(cell, "span", ` (${change(low, digits)} to ${change(high, digits)})`, "fine");
    } else if (column.key === "joint" && row[place.page]) {
      const link = add(cell, "a", value);
      link.href = row[place.page];
      link.setAttribute("aria-label", `report of robot ${row[place.robot]}, joint ${value}`);
    } else if (column.kind === "verdict") add(cell, "span", value, `tag ${data.tags[value] ?? ""}`);
    else cell.textContent = value;
  }

  function draw(most) {
    const until = Math.min(drawn + most, chosen.length);
    const made = document.createDocumentFragment();
    for (; drawn < until; drawn += 1) {
      const line = add(made, "tr");
      data.columns.forEach((column, at) => {
        if (column.title) fill(add(line, "td"), column, chosen[drawn].cells[at], chosen[drawn].cells);
      });
    }
    part("rows").append(made);
    const left = chosen.length - drawn;
    part("more").textContent = left ? `${left} more: scroll on, or search.` : "";
  }

  const key = (column, value) => {
    if (column.kind === "interval") return value[0];
    if (column.kind === "spark") return value[0][value[0].length - 1];
    return value;
  };

  function compare(column, at) {
    return (one, other) => {
      const [left, right] = [one.cells[at], other.cells[at]];
      // what has no value is last in either direction
      if (left === null || right === null) return (left === null) - (right === null) || one.at - other.at;
      const [a, b] = [key(column, left), key(column, right)];
      const order = typeof a === "string" ? data.collator.compare(a, b) : a - b;
      return (sorted.falling ? -order : order) || one.at - other.at;
    };
  }

  function redraw() {
    const found = part("find").value.trim().toLowerCase();
    const [group, wanted] = part("only").value.split(":");
    chosen = rows.filter((row) => (!found || row.text.includes(found))
      && (!group || row.cells[place[group]] === (group === "changed" ? true : wanted)));
    if (sorted.key) chosen.sort(compare(data.columns[place[sorted.key]], place[sorted.key]));
    part("told").textContent = `${chosen.length} of ${rows.length} joints.`;
    part("rows").replaceChildren();
    drawn = 0;
    draw(AT_ONCE);
  }

  data.collator = new Intl.Collator("en", { numeric: true });
  for (const column of data.columns) {
    if (!column.title) continue;
    const head = add(part("heads"), "th", undefined, ["number", "count", "interval"].includes(column.kind) ? "number" : "");
    head.scope = "col";
    const button = add(head, "button", column.title, "sort");
    button.type = "button";
    if (column.about) button.title = column.about;
    button.addEventListener("click", () => {
      sorted = { key: column.key, falling: sorted.key === column.key && !sorted.falling };
      for (const other of part("heads").children) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", sorted.falling ? "descending" : "ascending");
      redraw();
    });
  }
  box.hidden = false;
  for (const name of ["find", "only"]) part(name).addEventListener("input", redraw);
  const end = new IntersectionObserver((seen) => {
    if (!seen.some((one) => one.isIntersecting) || drawn >= chosen.length) return;
    draw(AT_ONCE);
    // whoever scrolls on at once never leaves the end: it is told anew whether it is in view
    end.unobserve(part("more"));
    end.observe(part("more"));
  }, { rootMargin: "600px" });
  end.observe(part("more"));
  addEventListener("beforeprint", () => draw(MOST_PRINTED));
  redraw();
})();
