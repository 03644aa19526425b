"""Logs for the tests: a joint that moves there and back, written in any dialect."""

import csv
import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

PERIOD = 0.012
REAL = Path(__file__).parents[2].parent / "shared" / "real"


def back_and_forth(seconds=6.0, speed=40.0, start=-50.0, period=PERIOD):
    """Return time [s], position [deg], velocity [deg/s] and torque [N·m] of moves there and back.

    Position is the exact integral of a trapezoid velocity; torque is 20 N·m times the velocity's
    sign plus 5 N·m.
    """
    time = np.arange(0.0, seconds, period)
    half = seconds / 2
    ramp = 0.2
    within = np.where(time < half, time, time - half)
    sign = np.where(time < half, 1.0, -1.0)
    up = np.clip(within / ramp, 0, 1)
    down = np.clip((half - within) / ramp, 0, 1)
    velocity = sign * speed * np.minimum(up, down)

    def travelled(t):
        t = np.clip(t, 0, half)
        begin = np.where(t < ramp, t**2 / (2 * ramp), t - ramp / 2)
        left = half - t
        end = half - ramp - left**2 / (2 * ramp)
        return speed * np.where(left < ramp, end, begin)

    position = start + np.where(time < half, travelled(time), travelled(half) - travelled(within))
    torque = 5.0 + 20.0 * np.sign(velocity)
    return time, position, velocity, torque


def kuka_columns(seconds=6.0, **motion) -> dict[str, np.ndarray]:
    """Return a small KUKA-like log of joint 2: header names to values."""
    time, position, velocity, torque = back_and_forth(seconds, **motion)
    return {
        "Zeit[sec]": time,
        "AxisPos_Act2[°]": position,
        "AxisVel_Act2[°/s]": velocity,
        "GearTorq_Act2[Nm]": torque,
    }


def text_of(
    columns: Mapping[str, np.ndarray], delimiter=";", decimal=".", newline="\n", digits=9
) -> str:
    """Return the text of a log; NaN becomes an empty cell."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, delimiter=delimiter, lineterminator=newline)
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        cells = ["" if np.isnan(value) else f"{value:.{digits}f}" for value in row]
        writer.writerow([cell.replace(".", decimal) for cell in cells])
    return buffer.getvalue()


def write(path: Path, columns: Mapping[str, np.ndarray], encoding="utf-8", **form) -> Path:
    """Write a log and return its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text_of(columns, **form).encode(encoding))
    return path
