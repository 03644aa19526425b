"""Joint motion and torque by formulas of the tests' own: trapezoidal speed, gravity, friction."""

import numpy as np
import pandas as pd
import pyarrow as pa

PERIOD = 0.012
ACCELERATION = 400.0


def trapezoid(start, end, speed, *, acceleration=ACCELERATION, period=PERIOD, rest=0.3):
    """Time, position, velocity and acceleration of one move, with a rest before and after."""
    way = abs(end - start)
    ramp = speed / acceleration
    if way < speed * ramp:
        ramp = np.sqrt(way / acceleration)
        speed = acceleration * ramp
    cruise = way / speed - ramp
    times = np.arange(0, 2 * rest + 2 * ramp + cruise, period)
    knots = np.cumsum([0.0, rest, ramp, cruise, ramp, rest])
    velocity = np.interp(times, knots, [0, 0, speed, speed, 0, 0])
    inside = [
        (times >= knots[1]) & (times < knots[2]),
        (times >= knots[3]) & (times < knots[4]),
    ]
    # exact integral of the trapezoid, piece by piece
    t1 = np.clip(times - knots[1], 0, ramp)
    t2 = np.clip(times - knots[2], 0, cruise)
    t3 = np.clip(times - knots[3], 0, ramp)
    position = acceleration * t1**2 / 2 + speed * t2 + speed * t3 - acceleration * t3**2 / 2
    sign = np.sign(end - start)
    return pd.DataFrame(
        {
            "time": times,
            "position": start + sign * position,
            "velocity": sign * velocity,
            "acceleration": sign * acceleration * (inside[0] * 1.0 - inside[1] * 1.0),
        }
    )


def move_sequence(turns, speeds, **motion):
    """Sequence of moves between the turning angles, at the given speeds."""
    parts, clock = [], 0.0
    for start, end, speed in zip(turns[:-1], turns[1:], speeds, strict=True):
        part = trapezoid(start, end, speed, **motion)
        parts.append(part.assign(time=part["time"] + clock))
        clock = parts[-1]["time"].iloc[-1] + motion.get("period", PERIOD)
    return pd.concat(parts, ignore_index=True)


def samples(motion, friction, *, load=lambda q: 90 * np.cos(np.radians(q)), sign=1, **columns):
    """Rows of the samples table: torque is load + sign * direction * friction + inertia."""
    direction = np.sign(motion["velocity"])
    inertia = 6.0 * np.radians(motion["acceleration"])
    torque = load(motion["position"]) + sign * direction * friction + inertia
    base = {
        "run": "day1",
        "recording": "log",
        "joint": 2,
        "torque": torque,
        "motor_temperature": 40.0,
    }
    return motion.drop(columns="acceleration").assign(**(base | columns))


def batches(frame, rows):
    """Yield the frame as record batches of at most ``rows`` rows."""
    for begin in range(0, len(frame), rows):
        part = pa.Table.from_pandas(frame.iloc[begin : begin + rows], preserve_index=False)
        yield from part.combine_chunks().to_batches()
