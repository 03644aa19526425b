"use strict";
/* The explorer: two sliders choose a setting of the evaluated grid, one switch the model.
   All numbers come from the page's JSON; names are only ever set as text. */
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const MARKS = {
    o: "M-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z",
    s: "M-2.7 -2.7h5.4v5.4h-5.4z",
    "^": "M0 -3.4L3.3 2.6H-3.3z",
    v: "M0 3.4L3.3 -2.6H-3.3z",
    D: "M0 -3.7L3.7 0L0 3.7L-3.7 0z",
    P: "M-1.2 -3.5h2.4v2.3h2.3v2.4h-2.3v2.3h-2.4v-2.3h-2.3v-2.4h2.3z",
  };
  const COUNTS = 150;
  const LEFT = 46, RIGHT = 10, TOP = 34, STEP = 120, GAP = 30, ERROR = 170, BOTTOM = 40;

  function shape(parent, name, attributes, text) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return parent.appendChild(made);
  }

  function hint(element, text) {
    shape(element, "title", {}, text);
  }

  function element(parent, name, text, kind) {
    const made = document.createElement(name);
    if (kind) made.className = kind;
    made.textContent = text;
    return parent.appendChild(made);
  }

  const fixed = (value, digits) => {
    const text = Math.abs(value).toFixed(digits);
    return (value < 0 && Number(text) !== 0 ? "\u2212" : "") + text;
  };

  /* Round values between two limits, at most so many. */
  function ticks(low, high, most) {
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
    const found = [];
    for (let at = Math.ceil(low / step - 1e-9); at * step <= high + 1e-9; at += 1) found.push(at * step);
    return { values: found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
  }

  const scale = (low, high, from, to) => (value) => from + ((value - low) / (high - low)) * (to - from);

  function extent(values) {
    return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)],
      [Infinity, -Infinity]);
  }

  /* The correction in force at each drawn pair: that of the last event up to its time. */
  function inForce(phase, schedule) {
    let event = -1;
    return phase.time.map((time) => {
      while (event + 1 < schedule.time.length && schedule.time[event + 1] <= time) event += 1;
      return event < 0 ? 0 : schedule.step[event];
    });
  }

  /* Predicted minus smoothed friction, with the temperature parameter T = Tm + correction. */
  function errors(phase, corrections) {
    return corrections.map(
      (step, at) => phase.error[at] + phase.term[at] * (Math.exp(-phase.delta * step) - 1),
    );
  }

  const runsOf = (phases) => [...new Set(phases.map((phase) => phase.run))];

  function explore(box, data) {
    const part = (name) => box.querySelector(`[data-part="${name}"]`);
    const models = Object.values(data.models);
    const steps = models.flat().flatMap((phase) => phase.schedules.flatMap((one) => one.step));
    const [least, most] = extent([...steps, 0]);
    const room = 0.08 * Math.max(most - least, 0.1);
    const reach = 1.05 * Math.max(...models.flat().flatMap((phase) => phase.error.map(Math.abs)));
    const limits = { step: [least - room, most + room], error: [-reach, reach] };

    function chosen() {
      const extended = part("extended");
      return {
        k: Number(part("k").value),
        tmax: Number(part("tmax").value),
        model: extended && extended.checked ? "extended" : "base",
      };
    }

    function state(setting) {
      const place = setting.k * data.tmax.length + setting.tmax;
      return data.models[setting.model].map((phase) => {
        const schedule = phase.schedules[phase.settings[place]];
        return { ...phase, schedule, now: phase.epsilon[place] };
      });
    }

    const value = (text) => Number(text.replace("\u2212", "-"));
    const settingText = (place) =>
      `k = ${data.k[Math.floor(place / data.tmax.length)]}, tmax = ${data.tmax[place % data.tmax.length]} min`;

    /* What is recommended for a model, and which phases the setting makes worse. */
    function advise(setting, phases) {
      const place = data.recommended[setting.model];
      const targets = [...new Set(phases.map((phase) => fixed(phase.target, 2)))];
      const limit = targets.length === 1 ? `${Number(targets[0])} ${data.unit}` : "the target";
      const all = place === null ? [] : phases.map((phase) => value(phase.epsilon[place]) <= phase.target);
      part("recommended").textContent = place === null
        ? (phases.every((phase) => value(phase.none) <= phase.target)
          ? `Recommended: no correction. ε is at most ${limit} without any.`
          : "Recommended: no correction. No setting is better.")
        : `Recommended: ${settingText(place)}, ` + (all.every(Boolean)
          ? `the fewest corrections with ε at most ${limit} in every phase.`
          : `the smallest ε; no setting reaches ${limit} in every phase.`);
      part("use").hidden = place === null;
      const worse = phases.filter((phase) => value(phase.now) > value(phase.none));
      part("worse").hidden = !worse.length;
      part("worse").textContent = "With this setting, corrections make the prediction worse: " +
        worse.map((one) => `${one.run}, ${one.word}: ε ${one.now} instead of ${one.none} ${data.unit}`).join("; ") + ".";
    }

    function use() {
      const place = data.recommended[chosen().model];
      part("k").value = Math.floor(place / data.tmax.length);
      part("tmax").value = place % data.tmax.length;
      redraw();
    }

    function counted(phase) {
      const lost = phase.schedule.failed.length;
      return `${phase.schedule.time.length}` + (lost ? `, ${lost} failed` : "");
    }

    function told(phase) {
      return `corrections ${counted(phase)}, error ${phase.now} ${data.unit}`;
    }

    function redraw() {
      const setting = chosen();
      const phases = state(setting);
      const k = `${data.k[setting.k]}`;
      const tmax = `${data.tmax[setting.tmax]} min`;
      part("k-now").textContent = k;
      part("tmax-now").textContent = tmax;
      part("k").setAttribute("aria-valuetext", `k = ${k}`);
      part("tmax").setAttribute("aria-valuetext", `tmax = ${tmax}`);
      part("told").textContent =
        `k = ${k}, tmax = ${tmax}, ${setting.model} model. ` +
        phases.map((one) => `${one.run}, ${one.word}: ${told(one)}`).join("; ") + ".";
      advise(setting, phases);
      const rows = part("errors");
      rows.replaceChildren();
      for (const phase of phases) {
        const row = element(rows, "tr", "");
        element(row, "td", `${phase.run}, ${phase.word}`);
        element(row, "td", counted(phase), "number");
        element(row, "td", phase.now, "number now");
        element(row, "td", phase.none, "number");
      }
      const charts = part("charts");
      charts.replaceChildren();
      for (const run of runsOf(phases)) {
        const section = element(charts, "section", "", "run");
        element(section, box.dataset.heading, run);
        const own = phases.filter((phase) => phase.run === run);
        tradeoff(section, own, setting);
        draw(section, own);
      }
    }

    /* Error over the number of corrections; equal schedules are one mark. */
    function tradeoff(parent, phases, setting) {
      const width = Math.max(parent.clientWidth, 280);
      const top = 24, bottom = top + COUNTS;
      const svg = shape(parent, "svg", { class: "tradeoff", viewBox: `0 0 ${width} ${bottom + 40}`, role: "img",
        "aria-label": "error over number of corrections" });
      const most = Math.max(...phases.flatMap((phase) => phase.schedules.map((one) => one.time.length)), 1);
      const high = 1.05 * Math.max(...phases.flatMap((one) => [one.target, ...[one.none, ...one.epsilon].map(value)]));
      const x = scale(0, most, LEFT + 8, width - RIGHT - 8);
      const y = scale(0, high, bottom, top);
      axes(svg, { y, top, bottom }, [0, high], width);
      for (const count of ticks(0, most, width < 500 ? 5 : 10).values) {
        shape(svg, "text", { x: x(count), y: bottom + 17, "text-anchor": "middle" }, fixed(count, 0));
      }
      shape(svg, "text", { x: (LEFT + width - RIGHT) / 2, y: bottom + 34, "text-anchor": "middle" },
        "corrections in the phase");
      shape(svg, "text", { class: "name", x: LEFT, y: top - 8 }, `error ε [${data.unit}]`);
      const rule = (kind, at) => shape(svg, "line", { class: kind, x1: LEFT, x2: width - RIGHT, y1: y(at), y2: y(at) });
      const now = setting.k * data.tmax.length + setting.tmax;
      const best = data.recommended[setting.model];
      for (const phase of phases) {
        hint(rule("target", phase.target), `target: ${fixed(phase.target, 2)} ${data.unit}`);
        hint(rule(`none ${phase.phase}`, value(phase.none)), `${phase.word}, no correction: ${phase.none} ${data.unit}`);
        const first = new Map();
        phase.settings.forEach((schedule, place) => { if (!first.has(schedule)) first.set(schedule, place); });
        const mark = (place, kind, r) => {
          const count = phase.schedules[phase.settings[place]].time.length;
          const made = shape(svg, "circle", { class: `${kind} ${phase.phase}`, r,
            cx: x(count).toFixed(1), cy: y(value(phase.epsilon[place])).toFixed(1) });
          hint(made, `${phase.word}, ${settingText(place)}: ${count} corrections, ε ${phase.epsilon[place]} ${data.unit}`);
        };
        for (const place of first.values()) mark(place, "setting", 2.2);
        if (best !== null) mark(best, "best", 7);
        mark(now, "now", 4.5);
      }
    }

    function draw(parent, phases) {
      const width = Math.max(parent.clientWidth, 280);
      const height = TOP + STEP + GAP + ERROR + BOTTOM;
      const svg = shape(parent, "svg", {
        viewBox: `0 0 ${width} ${height}`, role: "img",
        "aria-label": phases.map((one) => `${one.word}: ${told(one)}`).join("; "),
      });
      const [start, end] = extent(phases.flatMap((phase) => phase.time));
      const x = scale(start, end, LEFT, width - RIGHT);
      const upper = { y: scale(...limits.step, TOP + STEP, TOP), top: TOP, bottom: TOP + STEP };
      const from = TOP + STEP + GAP;
      const lower = { y: scale(...limits.error, from + ERROR, from), top: from, bottom: from + ERROR };
      for (const phase of phases) shade(svg, phase, x, upper, lower);
      axes(svg, upper, limits.step, width);
      axes(svg, lower, limits.error, width);
      const marks = ticks(start, end, width < 500 ? 4 : 9);
      for (const time of marks.values) {
        shape(svg, "line", { class: "tick", x1: x(time), x2: x(time), y1: lower.bottom, y2: lower.bottom + 4 });
        shape(svg, "text", { x: x(time), y: lower.bottom + 17, "text-anchor": "middle" },
          fixed(time, marks.digits));
      }
      shape(svg, "text", { x: (LEFT + width - RIGHT) / 2, y: height - 6, "text-anchor": "middle" },
        "time t [min]");
      shape(svg, "text", { class: "name", x: LEFT, y: upper.top - 6 },
        `correction ΔT [°C]`);
      shape(svg, "text", { class: "name", x: LEFT, y: lower.top - 8 },
        `predicted − smoothed friction [${data.unit}]`);
      for (const phase of phases) {
        events(svg, phase, x, upper, lower);
        points(svg, phase, x, lower);
      }
    }

    function shade(svg, phase, x, upper, lower) {
      const [from, to] = [x(phase.time[0]), x(phase.time[phase.time.length - 1])];
      for (const panel of [upper, lower]) {
        shape(svg, "rect", { class: `shade ${phase.phase}`, x: from, y: panel.top,
          width: Math.max(to - from, 0), height: panel.bottom - panel.top });
      }
      shape(svg, "text", { class: `word ${phase.phase}`, x: (from + to) / 2, y: 12,
        "text-anchor": "middle" }, phase.word);
    }

    function axes(svg, panel, limit, width) {
      const marks = ticks(...limit, 5);
      for (const value of marks.values) {
        const at = panel.y(value);
        shape(svg, "line", { class: Math.abs(value) < 1e-9 ? "zero" : "grid", x1: LEFT, x2: width - RIGHT,
          y1: at, y2: at });
        shape(svg, "text", { x: LEFT - 6, y: at + 4, "text-anchor": "end" }, fixed(value, marks.digits));
      }
    }

    function events(svg, phase, x, upper, lower) {
      const { time, step, failed } = phase.schedule;
      const end = phase.time[phase.time.length - 1];
      let path = `M${x(phase.time[0])} ${upper.y(0)}`;
      time.forEach((at, number) => {
        path += `H${x(at)}V${upper.y(step[number])}`;
        const lost = failed.includes(number);
        for (const panel of [upper, lower]) {
          const line = shape(svg, "line", { class: lost ? "event failed" : "event", x1: x(at),
            x2: x(at), y1: panel.top, y2: panel.bottom });
          hint(line, `${phase.word}, ${fixed(at, 1)} min: ` +
            (lost ? "correction failed" : `ΔT = ${fixed(step[number], 1)} °C`));
        }
      });
      shape(svg, "path", { class: "step", d: `${path}H${x(end)}` });
    }

    function points(svg, phase, x, panel) {
      const missed = errors(phase, inForce(phase, phase.schedule));
      const group = shape(svg, "g", { class: "points" });
      const place = (at, error) =>
        `translate(${x(phase.time[at]).toFixed(1)} ${panel.y(error).toFixed(1)})`;
      phase.time.forEach((_, at) => {
        shape(svg, "circle", { class: "ghost", r: 1.3, transform: place(at, phase.error[at]) });
      });
      svg.append(group);
      phase.time.forEach((time, at) => {
        const speed = data.speeds[phase.speed[at]];
        const mark = shape(group, "path", { d: MARKS[speed.marker], transform: place(at, missed[at]) });
        mark.style.setProperty("--series", speed.colour);
        hint(mark, `${speed.text}, ${fixed(time, 0)} min, ${data.symbol} = ` +
          `${fixed(phase.temperature[at], 1)} °C: ${fixed(missed[at], 2)} ${data.unit}`);
      });
    }

    function legend() {
      const used = new Set(models.flat().flatMap((phase) => phase.speed));
      data.speeds.forEach((speed, number) => {
        if (!used.has(number)) return;
        const item = element(part("legend"), "li", "");
        const svg = shape(item, "svg", { viewBox: "-5 -5 10 10", width: 12, height: 12, "aria-hidden": "true" });
        shape(svg, "path", { d: MARKS[speed.marker] }).style.setProperty("--series", speed.colour);
        item.append(` ${speed.text}`);
      });
    }

    part("k").value = data.start[0];
    part("tmax").value = data.start[1];
    if (part("extended")) part("extended").checked = data.evaluated === "extended";
    box.hidden = false;
    legend();
    redraw();
    part("use").addEventListener("click", use);
    for (const name of ["k", "tmax", "extended"]) {
      if (part(name)) part(name).addEventListener("input", redraw);
    }
    let width = part("charts").clientWidth;
    new ResizeObserver(() => {
      if (part("charts").clientWidth === width) return;
      width = part("charts").clientWidth;
      redraw();
    }).observe(part("charts"));
  }

  for (const box of document.querySelectorAll("[data-explorer]")) {
    explore(box, JSON.parse(document.getElementById(box.dataset.explorer).textContent));
  }
})();
