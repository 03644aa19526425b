"use strict";
/* The points of the chart: each angle bin of each move, in both directions. */
const frictionPoints = (() => {
  const DIRECTIONS = ["forward", "reverse"];

  function unpacked({ low, step, levels }) {
    const bytes = Uint8Array.from(atob(levels), (letter) => letter.charCodeAt(0));
    return Float32Array.from(new Uint16Array(bytes.buffer), (level) => low + step * level);
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

  /* Whether a point is in a cell of the residual maps: the number of the cell by axis. */
  function inCell(data, points, cell, at) {
    return Object.entries(cell).every(([name, number]) => {
      const { move, edges } = data.cells[name];
      if (move) return move[points.move[at]] === number;
      const angle = points.axes.angle[1][at];
      return angle >= edges[number] && angle < edges[number + 1];
    });
  }

  /* What the cell misses on the average: friction reverses with direction, load does not. */
  function meanInCell(data, points, cell, model, channel) {
    const misses = points.misses[model], { rows } = points;
    let sum = 0, count = 0;
    for (let at = 0; at < rows; at += 1) {
      if (!inCell(data, points, cell, at)) continue;
      sum += channel === "load" ? misses[at] + misses[rows + at] : data.sign * (misses[at] - misses[rows + at]);
      count += 1;
    }
    return { mean: sum / (2 * count), count: 2 * count };
  }

  return { DIRECTIONS, pointsOf, inCell, meanInCell };
})();
