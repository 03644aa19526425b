"use strict";
/* A chart of many points: every point is drawn pixel by pixel, so that a million of them follow the
   pointer. It shows a scene: the axis, the series with their heights, and the points that are kept. */
const frictionChart = (() => {
  const LEFT = 52, RIGHT = 10, TOP = 10, BOTTOM = 36, HEIGHT = 360, FEW = 4000, MOVING = 300000;
  const COLOURS = { measured: "--text", base: "--heating", extended: "--accent" };
  const { shown, ticks } = frictionNumbers;

  function chart(canvas, points, unit) {
    const brush = canvas.getContext("2d", { willReadFrequently: true });
    let scene = null, view = null, owners = null;
    let width = 0, ratio = 1, pending = false, rest = 0;

    /* Show a scene whole. */
    function show(wanted) {
      scene = wanted;
      fit();
      redraw();
    }

    function fit() {
      const { axis, series, heights, kept } = scene;
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
      width = Math.max(canvas.parentElement.clientWidth, 280);
      ratio = window.devicePixelRatio || 1;
      [canvas.width, canvas.height] = [width * ratio, HEIGHT * ratio].map(Math.round);
      canvas.style.height = `${HEIGHT}px`;
      const style = getComputedStyle(canvas);
      const colour = (name) => style.getPropertyValue(name).trim();
      brush.setTransform(ratio, 0, 0, ratio, 0, 0);
      grid(scene, colour);
      if (scene.kept.length <= FEW) marks(scene, colour);
      else pixels(scene, colour, moving ? Math.ceil((scene.kept.length * scene.series.length) / MOVING) : 1);
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
      label(`${what === "residual" ? "measured − simulated" : "torque u"} [${unit}]`, 0, 0, "center");
      brush.restore();
    }

    /* Few points: circles, and lines through the simulated torque of a single move. */
    function marks({ axis, series, heights, kept, move }, colour) {
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
    function pixels({ axis, series, heights, kept }, colour, step) {
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
      const { axis, series, heights, kept } = scene;
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

    /* The values at a place on the chart, in pixels. */
    const place = (x, y) => {
      return [view.left + ((x - LEFT) / (width - LEFT - RIGHT)) * (view.right - view.left),
        view.high - ((y - TOP) / (HEIGHT - TOP - BOTTOM)) * (view.high - view.low)];
    };

    /* Pan by so many pixels. */
    const drag = (right, down) => pan(-right / (width - LEFT - RIGHT), down / (HEIGHT - TOP - BOTTOM));

    return { show, redraw, zoom, pan, drag, place, nearest, busy: () => pending };
  }

  return { chart, COLOURS };
})();
