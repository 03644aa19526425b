"use strict";
/* Look into the data: measured and simulated torque of any move, residuals against any axis.
   Here are the controls; the points, the chart and the residual maps have scripts of their own. */
(() => {
  const { shown } = frictionNumbers;
  const { DIRECTIONS, pointsOf, inCell } = frictionPoints;
  const SERIES = Object.keys(frictionChart.COLOURS);

  function look(box, data) {
    const part = (name) => box.querySelector(`[data-part="${name}"]`);
    const points = pointsOf(data), canvas = part("canvas");
    const chart = frictionChart.chart(canvas, points, data.unit);
    let cell = null;

    const chosen = () => {
      const move = data.number.indexOf(Number(part("move").value));
      const what = part("what").value;
      const series = SERIES.filter((name) => part(name) && part(name).checked
        && (name !== "measured" || what === "torque"));
      return { move, what, series, axis: move < 0 ? part("axis").value : "angle" };
    };

    /* Heights of the points of each series: computed once per choice, not per frame. */
    function heightsOf({ series, what }) {
      const { measured, misses } = points;
      return Object.fromEntries(series.map((name) => [name, name === "measured" ? measured
        : what === "residual" ? misses[name] : measured.map((value, at) => value - misses[name][at])]));
    }

    function kept({ move }) {
      const run = Number(part("run").value), trend = Number(part("trend").value);
      const direction = Number(part("direction").value);
      const found = new Uint32Array(points.count);
      let size = 0;
      for (let at = 0; at < points.count; at += 1) {
        const own = points.move[at];
        if (move >= 0 ? own !== move : (run >= 0 && data.run[own] !== run) || (trend && data.trend[own] !== trend)) continue;
        if (direction >= 0 && (at >= points.rows) !== (direction === 1)) continue;
        if (cell && !inCell(data, points, cell, at)) continue;
        found[size++] = at;
      }
      return found.subarray(0, size);
    }

    const moveText = (move) => `Move ${data.number[move]}: ${data.runs[data.run[move]]}, ${shown(data.time[move], 1)} min, ${shown(data.speed[move], 1)} deg/s`
      + Object.entries(data.temperatures).map(([name, all]) => all[move] === null ? "" : `, ${name} ${shown(all[move], 1)} °C`).join("") + ".";

    function anew() {
      const state = chosen(), { move, what } = state;
      for (const name of ["axis", "run", "trend"]) if (part(name)) part(name).disabled = move >= 0;
      part("measured").disabled = what === "residual";
      const scene = { ...state, heights: heightsOf(state), kept: kept(state) };
      if (cell) {
        const limits = Object.entries(cell).map(([name, number]) => data.cells[name].texts[number]);
        part("told").textContent = `Cell of the map, ${limits.join(", ")}: ${scene.kept.length} points. “all” shows all points again.`;
      } else if (move >= 0) part("told").textContent = moveText(move);
      else part("told").textContent = `${data.moves} moves${data.step > 1 ? `, one in ${data.step} of them here` : ""}.`;
      chart.show(scene);
    }

    function showCell(wanted, across) {
      cell = wanted;
      part("what").value = "residual";
      part("move").value = "";
      const motor = points.axes.motor[1] ? "motor" : "housing";
      part("axis").value = { clock: "time", temperature: motor, position: "angle" }[across];
      for (const name of ["run", "direction"]) part(name).value = "-1";
      part("trend").value = "0";
      anew();
      box.scrollIntoView({ block: "nearest" });
      canvas.focus({ preventScroll: true });
    }

    function tell(event) {
      const found = chart.nearest(event.offsetX, event.offsetY);
      if (found === null) { part("under").textContent = ""; return; }
      const own = points.move[found], { measured, misses } = points;
      part("under").textContent = `move ${data.number[own]}, ${data.runs[data.run[own]]}, ${DIRECTIONS[Number(found >= points.rows)]}, `
        + `${shown(points.axes.angle[1][found], 1)} deg, ${shown(data.speed[own], 1)} deg/s: measured ${shown(measured[found])} ${data.unit}; `
        + Object.entries(misses).map(([name, all]) => `${name} ${shown(measured[found] - all[found])} (missed by ${shown(all[found])})`).join("; ");
    }

    const held = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      held.set(event.pointerId, [event.offsetX, event.offsetY]);
      canvas.setPointerCapture(event.pointerId);
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => held.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const before = held.get(event.pointerId);
      if (!before) { if (!chart.busy()) tell(event); return; }
      const now = [event.offsetX, event.offsetY];
      const other = [...held].find(([pointer]) => pointer !== event.pointerId);
      held.set(event.pointerId, now);
      if (other) {
        const away = ([x, y]) => Math.hypot(x - other[1][0], y - other[1][1]);
        chart.zoom(Math.max(away(before), 1) / Math.max(away(now), 1), ...chart.place(...other[1]));
      } else chart.drag(now[0] - before[0], now[1] - before[1]);
    });
    canvas.addEventListener("wheel", (event) => {
      // the page scrolls on, unless the chart was chosen before
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      chart.zoom(1.0015 ** event.deltaY, ...chart.place(event.offsetX, event.offsetY));
    }, { passive: false });
    const whole = () => { cell = null; anew(); };
    const keys = { ArrowLeft: () => chart.pan(-0.1, 0), ArrowRight: () => chart.pan(0.1, 0), ArrowUp: () => chart.pan(0, 0.1),
      ArrowDown: () => chart.pan(0, -0.1), "+": () => chart.zoom(0.8), "-": () => chart.zoom(1.25), 0: whole };
    canvas.addEventListener("keydown", (event) => {
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    for (const [name, act] of [["in", () => chart.zoom(0.7)], ["out", () => chart.zoom(1 / 0.7)], ["whole", whole]]) {
      part(name).addEventListener("click", act);
    }
    for (const option of [...part("axis").options]) if (!points.axes[option.value][1]) option.remove();
    for (const name of ["what", "axis", "run", "trend", "direction", "move", ...SERIES]) {
      if (part(name)) part(name).addEventListener("input", anew);
    }
    const maps = document.getElementById(box.dataset.maps);
    if (maps) frictionMaps(maps, data, points, showCell);
    box.hidden = false;
    anew();
    new ResizeObserver(() => chart.redraw()).observe(canvas.parentElement);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => chart.redraw());
  }

  for (const box of document.querySelectorAll("[data-look]")) {
    look(box, JSON.parse(document.getElementById(box.dataset.look).textContent));
  }
})();
