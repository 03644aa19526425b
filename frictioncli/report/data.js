"use strict";
/* Look into the data: measured and simulated torque of any move, residuals against any axis.
   Every point is drawn pixel by pixel, so that a million of them follow the pointer. */
(() => {
  const LEFT = 52, RIGHT = 10, TOP = 10, BOTTOM = 36, HEIGHT = 360, FEW = 4000, MOVING = 300000;
  const DIRECTIONS = ["forward", "reverse"];
  const COLOURS = { measured: "--text", base: "--heating", extended: "--accent" };

  const shown = (value, digits = 2) =>
    (value < 0 && Number(value.toFixed(digits)) !== 0 ? "\u2212" : "") + Math.abs(value).toFixed(digits);

  function unpacked({ low, step, levels }) {
    const bytes = Uint8Array.from(atob(levels), (letter) => letter.charCodeAt(0));
    return Float32Array.from(new Uint16Array(bytes.buffer), (level) => low + step * level);
  }

  function ticks(low, high, most) {
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
    const values = [];
    for (let at = Math.ceil(low / step - 1e-9); at * step <= high + step * 1e-9; at += 1) values.push(at * step);
    return { values, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
  }

  /* Both directions of all rows in one series of points: first forward, then reverse. */
  function pointsOf(data) {
    const columns = Object.fromEntries(Object.entries(data.columns).map(([name, one]) => [name, unpacked(one)]));
    const rows = columns.angle.length, count = 2 * rows;
    const move = new Uint32Array(count);
    let row = 0;
    data.length.forEach((length, number) => {
      move.fill(number, row, row + length);
      move.fill(number, rows + row, rows + row + length);
      row += length;
    });
    const both = (name) => {
      const joined = new Float32Array(count);
      DIRECTIONS.forEach((direction, at) => joined.set(columns[`${name}_${direction}`], at * rows));
      return joined;
    };
    const perMove = (values) => Float32Array.from(move, (number) => values[number] ?? NaN);
    const angle = new Float32Array(count);
    angle.set(columns.angle); angle.set(columns.angle, rows);
    const measured = both("u"), misses = { base: both("base") };
    if (data.extended) misses.extended = both("ext");
    const load = Float32Array.from(measured, (_, at) => (measured[at % rows] + measured[rows + (at % rows)]) / 2);
    const axes = {
      angle: ["joint angle φ [deg]", angle],
      time: ["time t in the run [min]", perMove(data.time)],
      speed: ["speed [deg/s]", perMove(data.speed)],
      motor: ["motor temperature Tm [°C]", data.temperatures.motor && perMove(data.temperatures.motor)],
      housing: ["housing temperature [°C]", data.temperatures.housing && perMove(data.temperatures.housing)],
      load: [`load torque [${data.unit}]`, data.load && load],
      torque: [`measured torque [${data.unit}]`, measured],
      move: ["number of the move", perMove(data.number)],
    };
    return { rows, count, move, measured, misses, axes };
  }

  function look(box, data) {
    const part = (name) => box.querySelector(`[data-part="${name}"]`);
    const points = pointsOf(data);
    const canvas = part("canvas"), brush = canvas.getContext("2d", { willReadFrequently: true });
    let view = null, kept = new Uint32Array(0), heights = {}, owners = null;
    let width = 0, ratio = 1, pending = false, rest = 0, cell = null;

    const chosen = () => {
      const move = data.number.indexOf(Number(part("move").value));
      const what = part("what").value;
      const series = Object.keys(COLOURS).filter((name) => part(name) && part(name).checked
        && (name !== "measured" || what === "torque"));
      return { move, what, series, axis: move < 0 ? part("axis").value : "angle" };
    };

    /* Heights of the points of each series: computed once per choice, not per frame. */
    function prepare({ series, what }) {
      const { measured, misses } = points;
      heights = Object.fromEntries(series.map((name) => [name, name === "measured" ? measured
        : what === "residual" ? misses[name] : measured.map((value, at) => value - misses[name][at])]));
    }

    /* Whether a point is in the cell of a map that was clicked. */
    function inCell(at) {
      return Object.entries(cell).every(([name, number]) => {
        const { move, edges } = data.cells[name];
        if (move) return move[points.move[at]] === number;
        const angle = points.axes.angle[1][at];
        return angle >= edges[number] && angle < edges[number + 1];
      });
    }

    function keep() {
      const { move } = chosen();
      const run = Number(part("run").value), trend = Number(part("trend").value);
      const direction = Number(part("direction").value);
      const found = new Uint32Array(points.count);
      let size = 0;
      for (let at = 0; at < points.count; at += 1) {
        const own = points.move[at];
        if (move >= 0 ? own !== move : (run >= 0 && data.run[own] !== run) || (trend && data.trend[own] !== trend)) continue;
        if (direction >= 0 && (at >= points.rows) !== (direction === 1)) continue;
        if (cell && !inCell(at)) continue;
        found[size++] = at;
      }
      kept = found.subarray(0, size);
    }

    function fit() {
      const { axis, series } = chosen();
      const xs = points.axes[axis][1];
      let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
      for (const name of series) {
        const ys = heights[name];
        for (const at of kept) {
          const x = xs[at], y = ys[at];
          if (x < left) left = x;
          if (x > right) right = x;
          if (y < low) low = y;
          if (y > high) high = y;
        }
      }
      if (!(left <= right)) [left, right, low, high] = [0, 1, 0, 1];
      const [wide, tall] = [(right - left) * 0.02 || 0.5, (high - low) * 0.04 || 0.5];
      view = { left: left - wide, right: right + wide, low: low - tall, high: high + tall };
    }

    const toX = (x) => LEFT + ((x - view.left) / (view.right - view.left)) * (width - LEFT - RIGHT);
    const toY = (y) => TOP + ((view.high - y) / (view.high - view.low)) * (HEIGHT - TOP - BOTTOM);

    function draw(moving) {
      pending = false;
      width = Math.max(part("canvas").parentElement.clientWidth, 280);
      ratio = window.devicePixelRatio || 1;
      [canvas.width, canvas.height] = [width * ratio, HEIGHT * ratio].map(Math.round);
      canvas.style.height = `${HEIGHT}px`;
      const style = getComputedStyle(box);
      const colour = (name) => style.getPropertyValue(name).trim();
      const state = chosen();
      brush.setTransform(ratio, 0, 0, ratio, 0, 0);
      grid(state, colour);
      if (kept.length <= FEW) marks(state, colour);
      else pixels(state, colour, moving ? Math.ceil((kept.length * state.series.length) / MOVING) : 1);
    }

    function grid({ axis, what }, colour) {
      brush.font = "12px system-ui, sans-serif";
      brush.lineWidth = 1;
      const label = (text, x, y, align) => {
        brush.textAlign = align;
        brush.fillText(text, x, y);
      };
      brush.strokeStyle = colour("--line");
      brush.fillStyle = colour("--quiet");
      const across = ticks(view.left, view.right, width < 500 ? 4 : 9), up = ticks(view.low, view.high, 6);
      for (const x of across.values) {
        brush.strokeRect(Math.round(toX(x)) + 0.5, TOP, 0, HEIGHT - TOP - BOTTOM);
        label(shown(x, across.digits), toX(x), HEIGHT - BOTTOM + 15, "center");
      }
      for (const y of up.values) {
        brush.strokeStyle = colour(Math.abs(y) < 1e-9 ? "--quiet" : "--line");
        brush.strokeRect(LEFT, Math.round(toY(y)) + 0.5, width - LEFT - RIGHT, 0);
        label(shown(y, up.digits), LEFT - 6, toY(y) + 4, "right");
      }
      label(points.axes[axis][0], (LEFT + width - RIGHT) / 2, HEIGHT - 5, "center");
      brush.save();
      brush.translate(12, (HEIGHT - BOTTOM) / 2);
      brush.rotate(-Math.PI / 2);
      label(`${what === "residual" ? "measured − simulated" : "torque u"} [${data.unit}]`, 0, 0, "center");
      brush.restore();
    }

    /* Few points: circles, and lines through the simulated torque of a single move. */
    function marks({ axis, series, move }, colour) {
      owners = null;
      const xs = points.axes[axis][1], radius = move >= 0 ? 3.2 : 2.2;
      brush.save();
      brush.beginPath();
      brush.rect(LEFT, TOP, width - LEFT - RIGHT, HEIGHT - TOP - BOTTOM);
      brush.clip();
      // of a single move the measured points lie on the lines, else below what they would hide
      const order = move < 0 ? series : [...series].sort((one, other) => (one === "measured") - (other === "measured"));
      for (const name of order) {
        const ys = heights[name];
        brush.fillStyle = brush.strokeStyle = colour(COLOURS[name]);
        brush.lineWidth = 2;
        const lines = move >= 0 && name !== "measured";
        brush.beginPath();
        kept.forEach((at, place) => {
          const x = toX(xs[at]), y = toY(ys[at]);
          if (lines && (place === 0 || (kept[place - 1] < points.rows) !== (at < points.rows))) brush.moveTo(x, y);
          else if (lines) brush.lineTo(x, y);
          else { brush.moveTo(x + radius, y); brush.arc(x, y, radius, 0, 7); }
        });
        if (lines) brush.stroke();
        else brush.fill();
      }
      brush.restore();
    }

    /* Many points: a dot of device pixels each, straight into the picture; each remembers its point. */
    function pixels({ axis, series }, colour, step) {
      const xs = points.axes[axis][1], wide = canvas.width;
      const picture = brush.getImageData(0, 0, wide, canvas.height);
      const dots = new Uint32Array(picture.data.buffer);
      owners = new Int32Array(dots.length).fill(-1);
      const size = Math.round((kept.length < 2e5 ? 2 : 1) * ratio);
      const [left, right] = [Math.ceil(LEFT * ratio), Math.floor((width - RIGHT) * ratio) - size];
      const [top, bottom] = [Math.ceil(TOP * ratio), Math.floor((HEIGHT - BOTTOM) * ratio) - size];
      const perX = (right + size - left) / (view.right - view.left), perY = (bottom + size - top) / (view.high - view.low);
      const { left: first, high } = view;
      for (const name of series) {
        const ys = heights[name];
        const [red, green, blue] = [1, 3, 5].map((at) => parseInt(colour(COLOURS[name]).slice(at, at + 2), 16));
        const paint = (255 << 24) | (blue << 16) | (green << 8) | red;
        for (let place = 0; place < kept.length; place += step) {
          const at = kept[place];
          const x = Math.round(left + (xs[at] - first) * perX), y = Math.round(top + (high - ys[at]) * perY);
          if (!(x >= left && x <= right && y >= top && y <= bottom)) continue;
          for (let down = 0; down < size; down += 1) {
            const from = (y + down) * wide + x;
            for (let over = 0; over < size; over += 1) { dots[from + over] = paint; owners[from + over] = at; }
          }
        }
      }
      brush.putImageData(picture, 0, 0);
    }

    /* The point nearest to a place on the chart, within a dozen pixels. */
    function nearest(x, y) {
      const { axis, series } = chosen();
      let best = 144, found = null;
      const offer = (away, at) => { if (away < best) [best, found] = [away, at]; };
      if (owners) {
        const reach = Math.round(12 * ratio), [column, line] = [x * ratio, y * ratio].map(Math.round);
        for (let down = -reach; down <= reach; down += 1) {
          for (let over = -reach; over <= reach; over += 1) {
            const at = owners[(line + down) * canvas.width + column + over];
            if (at >= 0) offer((down * down + over * over) / (ratio * ratio), at);
          }
        }
        return found;
      }
      const xs = points.axes[axis][1];
      for (const name of series) for (const at of kept) offer((toX(xs[at]) - x) ** 2 + (toY(heights[name][at]) - y) ** 2, at);
      return found;
    }

    /* While the view moves, some of many points are left out; at rest all are drawn. */
    function redraw(moving = false) {
      if (!pending) requestAnimationFrame(() => draw(moving));
      pending = true;
      clearTimeout(rest);
      if (moving) rest = setTimeout(() => redraw(), 200);
    }

    function anew() {
      const { move, what } = chosen();
      for (const name of ["axis", "run", "trend"]) if (part(name)) part(name).disabled = move >= 0;
      part("measured").disabled = what === "residual";
      part("told").textContent = move < 0
        ? `${data.moves} moves${data.step > 1 ? `, every ${data.step}th of them here` : ""}.`
        : `Move ${data.number[move]}: ${data.runs[data.run[move]]}, ${shown(data.time[move], 1)} min, ${shown(data.speed[move], 1)} deg/s`
          + Object.entries(data.temperatures).map(([name, all]) => all[move] === null ? "" : `, ${name} ${shown(all[move], 1)} °C`).join("") + ".";
      prepare(chosen());
      keep();
      if (cell) {
        const limits = Object.entries(cell).map(([name, number]) => data.cells[name].texts[number]);
        part("told").textContent = `Cell of the map, ${limits.join(", ")}: ${kept.length} points. “all” shows all points again.`;
      }
      fit();
      redraw();
    }

    function zoom(factor, atX = (view.left + view.right) / 2, atY = (view.low + view.high) / 2) {
      view = {
        left: atX - (atX - view.left) * factor, right: atX + (view.right - atX) * factor,
        low: atY - (atY - view.low) * factor, high: atY + (view.high - atY) * factor,
      };
      redraw(true);
    }

    function pan(right, up) {
      const [dx, dy] = [right * (view.right - view.left), up * (view.high - view.low)];
      view = { left: view.left + dx, right: view.right + dx, low: view.low + dy, high: view.high + dy };
      redraw(true);
    }

    const place = (event) => {
      const [x, y] = [event.offsetX, event.offsetY];
      return [view.left + ((x - LEFT) / (width - LEFT - RIGHT)) * (view.right - view.left),
        view.high - ((y - TOP) / (HEIGHT - TOP - BOTTOM)) * (view.high - view.low)];
    };

    function tell(event) {
      const found = nearest(event.offsetX, event.offsetY);
      if (found === null) { part("under").textContent = ""; return; }
      const own = points.move[found], { measured, misses } = points;
      part("under").textContent = `move ${data.number[own]}, ${data.runs[data.run[own]]}, ${DIRECTIONS[Number(found >= points.rows)]}, `
        + `${shown(points.axes.angle[1][found], 1)} deg, ${shown(data.speed[own], 1)} deg/s: measured ${shown(measured[found])} ${data.unit}; `
        + Object.entries(misses).map(([name, all]) => `${name} ${shown(measured[found] - all[found])} (missed by ${shown(all[found])})`).join("; ");
    }

    /* The residual maps: a click on a cell shows its points, over what the map has across. */
    function linkMaps() {
      const figure = document.getElementById(box.dataset.maps);
      if (!figure) return;
      const maps = [...figure.querySelectorAll('[id*="-cells-"]')];
      const under = (event) => {
        for (const map of maps) {
          const { left, top, width: wide, height: tall } = map.getBoundingClientRect();
          const [x, y] = [(event.clientX - left) / wide, 1 - (event.clientY - top) / tall];
          if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) continue;
          const [across, up] = map.id.split("-cells-")[1].split("-");
          return { across, cell: { [across]: cellAt(across, x), [up]: cellAt(up, y) } };
        }
        return null;
      };
      figure.addEventListener("pointermove", (event) => { figure.style.cursor = under(event) ? "pointer" : ""; });
      figure.addEventListener("click", (event) => {
        const found = under(event);
        if (!found) return;
        cell = found.cell;
        part("what").value = "residual";
        part("move").value = "";
        const motor = points.axes.motor[1] ? "motor" : "housing";
        part("axis").value = { clock: "time", temperature: motor, position: "angle" }[found.across];
        for (const name of ["run", "direction"]) part(name).value = "-1";
        part("trend").value = "0";
        anew();
        box.scrollIntoView({ block: "nearest" });
        canvas.focus({ preventScroll: true });
      });
    }

    /* The number of the cell at a share of an axis of a map. */
    function cellAt(name, share) {
      const { texts, edges } = data.cells[name];
      if (!edges) return Math.floor(share * texts.length);
      const at = edges[0] + share * (edges[texts.length] - edges[0]);
      return Math.max(edges.findLastIndex((edge) => edge <= at), 0);
    }

    const held = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      held.set(event.pointerId, [event.offsetX, event.offsetY]);
      canvas.setPointerCapture(event.pointerId);
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => held.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const before = held.get(event.pointerId);
      if (!before) { if (!pending) tell(event); return; }
      const now = [event.offsetX, event.offsetY];
      const other = [...held].find(([pointer]) => pointer !== event.pointerId);
      held.set(event.pointerId, now);
      if (other) {
        const away = ([x, y]) => Math.hypot(x - other[1][0], y - other[1][1]);
        zoom(Math.max(away(before), 1) / Math.max(away(now), 1), ...place({ offsetX: other[1][0], offsetY: other[1][1] }));
      } else pan((before[0] - now[0]) / (width - LEFT - RIGHT), (now[1] - before[1]) / (HEIGHT - TOP - BOTTOM));
    });
    canvas.addEventListener("wheel", (event) => {
      // the page scrolls on, unless the chart was chosen before
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      zoom(1.0015 ** event.deltaY, ...place(event));
    }, { passive: false });
    const keys = { ArrowLeft: () => pan(-0.1, 0), ArrowRight: () => pan(0.1, 0), ArrowUp: () => pan(0, 0.1),
      ArrowDown: () => pan(0, -0.1), "+": () => zoom(0.8), "-": () => zoom(1.25), 0: () => whole() };
    canvas.addEventListener("keydown", (event) => {
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    const whole = () => { cell = null; anew(); };
    for (const [name, act] of [["in", () => zoom(0.7)], ["out", () => zoom(1 / 0.7)], ["whole", whole]]) {
      part(name).addEventListener("click", act);
    }
    for (const option of [...part("axis").options]) if (!points.axes[option.value][1]) option.remove();
    for (const name of ["what", "axis", "run", "trend", "direction", "move", ...Object.keys(COLOURS)]) {
      if (part(name)) part(name).addEventListener("input", anew);
    }
    linkMaps();
    box.hidden = false;
    anew();
    new ResizeObserver(() => redraw()).observe(canvas.parentElement);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redraw());
  }

  for (const box of document.querySelectorAll("[data-look]")) {
    look(box, JSON.parse(document.getElementById(box.dataset.look).textContent));
  }
})();
