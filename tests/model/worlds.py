"""Torques of a joint that is exactly equation (16), with noise of known size."""

import numpy as np
import pandas as pd

TRUTH = {"tau_c": 10.57, "alpha": 0.0014, "beta": 3.48, "gamma": 15.66, "delta": 0.056}
SPEEDS = (19.1, 39.4, 67.5, 101.2)


def cycle_temperatures():
    """Motor temperature and time of the paper's cycle: 25 to 65 °C in 100 min, back in 300 min."""
    heating, cooling = np.arange(25.0, 65.0), np.arange(65.0, 25.0, -1.0)
    slowing = np.cumsum(np.linspace(0.4, 1.6, len(cooling)))
    return (
        np.concatenate([heating, cooling]),
        60 * np.concatenate([np.linspace(0, 98, 40), 100 + 300 * slowing / slowing[-1]]),
        np.repeat(["heat-up", "cool-down"], [len(heating), len(cooling)]),
    )


def torques(
    seed,
    *,
    point=0.3,
    pair=0.25,
    drift=0.2,
    drift_time=20 * 60.0,
    speeds=SPEEDS,
    load=95.0,
    temperatures=None,
    truth=TRUTH,
):
    """Rows of the torques table of one run."""
    generator = np.random.default_rng(seed)
    temperature, time, phase = temperatures or cycle_temperatures()
    position = np.arange(7.5, 175, 5.0)
    level = np.tile(speeds, len(temperature))
    clock = np.repeat(time, len(speeds)) + np.tile(10.0 * np.arange(len(speeds)), len(temperature))
    wander = np.zeros(len(clock))
    wander[0] = drift * generator.normal()
    for i in range(1, len(clock)):
        keep = np.exp(-(clock[i] - clock[i - 1]) / drift_time)
        wander[i] = keep * wander[i - 1] + drift * np.sqrt(1 - keep**2) * generator.normal()
    common = wander + pair * generator.normal(size=len(clock))
    gravity = load * np.cos(np.radians(position))
    warm = np.repeat(temperature, len(speeds))
    viscous = truth["beta"] + truth["gamma"] * np.exp(-truth["delta"] * warm)
    base = truth["tau_c"] + viscous * np.sqrt(level) + common
    friction = base[:, None] + truth["alpha"] * gravity[None, :] ** 2
    friction = friction + point * generator.normal(size=friction.shape)
    shape = friction.shape
    spread = {
        "pair": np.arange(len(clock)),
        "speed": level,
        "time": clock,
        "phase": np.repeat(phase, len(speeds)),
        "motor_temperature": warm,
        "housing_temperature": warm,
        "motor_temperature_reading": np.round(warm),
    }
    rows = {name: np.repeat(values, shape[1]) for name, values in spread.items()}
    return pd.DataFrame(
        rows
        | {
            "run": "day1",
            "joint": 2,
            "position": np.tile(position, shape[0]),
            "friction_torque": friction.ravel(),
            "load_torque": np.tile(gravity, shape[0]),
        }
    )
