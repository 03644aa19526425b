"use strict";
/* The explorer: two sliders choose a setting of the evaluated grid, one switch the model.
   All numbers come from the page's JSON; names are only ever set as text. */
(() => {
  const COUNTS = 150;
  const LEFT = 46, RIGHT = 10, TOP = 34, STEP = 120, GAP = 30, ERROR = 170, BOTTOM = 40;

  const { shown: fixed, ticks } = frictionNumbers;
  const { MARKS, GHOST, element, shape, hint, outline, scale, extent } = frictionShapes;

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

    let drawn = "", moves = [];

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
      const wanted = `${setting.model} ${charts.clientWidth}`;
      if (wanted !== drawn) {
        drawn = wanted;
        charts.replaceChildren();
        moves = runsOf(phases).map((run) => {
          const section = element(charts, "section", "", "run");
          element(section, box.dataset.heading, run);
          const own = phases.filter((phase) => phase.run === run);
          const moved = [tradeoff(section, own, setting.model), draw(section, own)];
          return (all, place) => {
            const now = all.filter((phase) => phase.run === run);
            for (const move of moved) move(now, place);
          };
        });
      }
      for (const move of moves) move(phases, setting.k * data.tmax.length + setting.tmax);
    }

    /* Error over the number of corrections; equal schedules are one mark. What depends on the
       setting is drawn by the function returned. */
    function tradeoff(parent, phases, model) {
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
      const best = data.recommended[model];
      const put = (made, phase, place) => {
        const count = phase.schedules[phase.settings[place]].time.length;
        made.setAttribute("cx", x(count).toFixed(1));
        made.setAttribute("cy", y(value(phase.epsilon[place])).toFixed(1));
        hint(made, `${phase.word}, ${settingText(place)}: ${count} corrections, ε ${phase.epsilon[place]} ${data.unit}`);
      };
      const current = phases.map((phase) => {
        hint(rule("target", phase.target), `target: ${fixed(phase.target, 2)} ${data.unit}`);
        hint(rule(`none ${phase.phase}`, value(phase.none)), `${phase.word}, no correction: ${phase.none} ${data.unit}`);
        const first = new Map();
        phase.settings.forEach((schedule, place) => { if (!first.has(schedule)) first.set(schedule, place); });
        const mark = (kind, r) => shape(svg, "circle", { class: `${kind} ${phase.phase}`, r });
        for (const place of first.values()) put(mark("setting", 2.2), phase, place);
        if (best !== null) put(mark("best", 7), phase, best);
        return mark("now", 4.5);
      });
      return (now, place) => now.forEach((phase, number) => put(current[number], phase, place));
    }

    /* Corrections and errors over time. What depends on the setting is drawn by the function returned. */
    function draw(parent, phases) {
      const width = Math.max(parent.clientWidth, 280);
      const height = TOP + STEP + GAP + ERROR + BOTTOM;
      const svg = shape(parent, "svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
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
      const moved = phases.map((phase) => {
        const group = shape(svg, "g", {});
        const moving = points(svg, phase, x, lower);
        return (now) => {
          group.replaceChildren();
          events(group, now, x, upper, lower);
          moving(now);
        };
      });
      return (now) => {
        svg.setAttribute("aria-label", now.map((phase) => `${phase.word}: ${told(phase)}`).join("; "));
        now.forEach((phase, number) => moved[number](phase));
      };
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

    /* Errors without correction, and those with the schedule given to the function returned. */
    function points(svg, phase, x, panel) {
      const xs = phase.time.map(x);
      shape(svg, "path", { class: "ghost", d: outline(GHOST, xs, phase.error.map(panel.y)) });
      const group = shape(svg, "g", { class: "points" });
      const speeds = [...new Set(phase.speed)].map((number) => {
        const path = shape(group, "path", {});
        path.style.setProperty("--series", data.speeds[number].colour);
        const own = phase.speed.flatMap((speed, at) => (speed === number ? [at] : []));
        return { path, own, mark: MARKS[data.speeds[number].marker] };
      });
      let missed = [], ys = [];
      /* the values of the mark next to the pointer */
      group.addEventListener("pointermove", (event) => {
        const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
        let near = 0;
        xs.forEach((_, one) => {
          if (Math.hypot(xs[one] - at.x, ys[one] - at.y) < Math.hypot(xs[near] - at.x, ys[near] - at.y)) near = one;
        });
        hint(group, `${data.speeds[phase.speed[near]].text}, ${fixed(phase.time[near], 0)} min, ${data.symbol} = ` +
          `${fixed(phase.temperature[near], 1)} °C: ${fixed(missed[near], 2)} ${data.unit}`);
      });
      return (now) => {
        missed = errors(now, inForce(now, now.schedule));
        ys = missed.map(panel.y);
        for (const { path, own, mark } of speeds) {
          path.setAttribute("d", outline(mark, own.map((at) => xs[at]), own.map((at) => ys[at])));
        }
      };
    }

    function legend() {
      const used = new Set(models.flat().flatMap((phase) => phase.speed));
      data.speeds.forEach((speed, number) => {
        if (!used.has(number)) return;
        const item = element(part("legend"), "li", "");
        const svg = shape(item, "svg", { viewBox: "-5 -5 10 10", width: 12, height: 12, "aria-hidden": "true" });
        shape(svg, "path", { d: `M0 0${MARKS[speed.marker]}` }).style.setProperty("--series", speed.colour);
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
