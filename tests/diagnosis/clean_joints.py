"""Joints that obey equation (16) exactly, in logs that delay, filter and shift the torque.

The torque along a move is computed on a fine grid of angles at constant velocity and passed through
the response of the log, an exponential filter behind a delay, by convolution over time.
"""

from functools import partial

import numpy as np
import pandas as pd

from tests.equation_16 import SPEEDS, TRUTH, cycle_temperatures, friction

STEP = 0.02
"""Step of the fine grid. [deg]"""

LOW, HIGH, BIN = 5.0, 175.0, 5.0
"""Ends of the angles that are passed at constant velocity, and width of a bin. [deg]"""


def logged(torque, speed, way, delay, filtering):
    """Return the torque that a log shows over the angles of a move.

    Parameters
    ----------
    torque : callable
        True torque at angles [deg], shape (angles,). [N·m]
    speed : float
        Speed. [deg/s]
    way : {1, -1}
        Direction.
    delay, filtering : float
        Delay, and time constant of the filter. [s]

    Returns
    -------
    ndarray, shape (bins,)
        Means over the bins. [N·m]
    """
    angle = np.arange(LOW, HIGH, STEP) + STEP / 2
    if filtering:
        # twelve time constants of the response hold all but 6e-6 of it
        ago = np.arange(0.0, 12 * filtering, filtering / 20) + filtering / 40
        weight = np.exp(-ago / filtering)
        weight /= weight.sum()
    else:
        ago, weight = np.zeros(1), np.ones(1)
    seen = sum(
        w * torque(angle - way * speed * (delay + t)) for t, w in zip(ago, weight, strict=True)
    )
    return seen.reshape(-1, int(BIN / STEP)).mean(axis=1)


def clean_days(
    seed,
    *,
    days=2,
    constant=0.0,
    offset=0.0,
    delay=0.0,
    filtering=0.0,
    every=2,
    noise=0.3,
    pair=0.2,
    drift=0.2,
    gravity=(90.0, 12.0),
):
    """Return the torques of days on which nothing is hidden but what the log does.

    Parameters
    ----------
    constant : float
        Constant of gravity that the gear carries. [N·m]
    offset : float
        Offset of the torque sensor, which no gear carries. [N·m]
    delay, filtering : float
        Of the logged torque. [s]
    every : int
        Every how many degrees of the motor there are pairs, two series each.
    noise, pair, drift : float
        Noise of a bin, of a pair, and a drift of 20 min. [N·m]
    """
    generator = np.random.default_rng(seed)
    temperature, time, phase = (values[::every] for values in cycle_temperatures())
    position = np.arange(LOW, HIGH, BIN) + BIN / 2

    def load(angle):
        radians = np.radians(angle)
        return gravity[0] * np.cos(radians) + gravity[1] * np.sin(radians) + constant

    def still(angle, speed, way):
        cold = {**TRUTH, "gamma": 0.0}
        return load(angle) + way * friction(cold, load=load(angle), speed=speed, temperature=0.0)

    # only the viscous part goes with temperature: the rest is the same in every pair of every day
    cold = {
        way: [logged(partial(still, speed=v, way=way), v, way, delay, filtering) for v in SPEEDS]
        for way in (1, -1)
    }
    tables = []
    for day in range(days):
        clock = np.repeat(time, len(SPEEDS)) + np.tile(10.0 * np.arange(len(SPEEDS)), len(time))
        speed, warm = np.tile(SPEEDS, len(time)), np.repeat(temperature, len(SPEEDS))
        away = np.zeros((2, len(clock)))
        for i in range(1, len(clock)):
            keep = np.exp(-(clock[i] - clock[i - 1]) / 1200.0)
            away[:, i] = keep * away[:, i - 1] + drift * np.sqrt(1 - keep**2) * generator.normal(
                size=2
            )
        away += pair * generator.normal(size=away.shape)
        ways = []
        for way, rows in cold.items():
            viscous = TRUTH["gamma"] * np.exp(-TRUTH["delta"] * warm) * np.sqrt(speed)
            ways.append(np.tile(rows, (len(time), 1)) + way * viscous[:, None] + offset)
        mean, half = (ways[0] + ways[1]) / 2, (ways[0] - ways[1]) / 2
        half = half + away[0][:, None] + noise * generator.normal(size=half.shape)
        mean = mean + 0.3 * away[1][:, None] + noise * generator.normal(size=mean.shape)
        count, bins = half.shape
        tables.append(
            pd.DataFrame(
                {
                    "run": f"day{day + 1}",
                    "joint": 2,
                    "pair": np.repeat(np.arange(count), bins),
                    "speed": np.repeat(speed, bins),
                    "time": np.repeat(clock + 5.0, bins),
                    "phase": np.repeat(np.repeat(phase, len(SPEEDS)), bins),
                    "motor_temperature": np.repeat(warm, bins),
                    "housing_temperature": np.repeat(16 + 0.75 * (warm - 16), bins),
                    # off the registered one: no error of a whole step is assumed
                    "motor_temperature_reading": np.repeat(warm, bins) + 0.4,
                    "position": np.tile(position, count),
                    "torque_forward": (mean + half).ravel(),
                    "torque_reverse": (mean - half).ravel(),
                    "friction_torque": half.ravel(),
                    "load_torque": mean.ravel(),
                    "load": np.nan,
                    "payload": np.nan,
                }
            )
        )
    return pd.concat(tables, ignore_index=True)
