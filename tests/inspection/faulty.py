"""Logs of a joint that moves there and back at several speeds, noisy as a real one, with faults."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

COLUMNS = ("t [s]", "q_2 [deg]", "qd_2 [deg/s]", "torque_2 [Nm]", "motortemp_2 [°C]")
PERIOD = 0.01


def clean_log(
    seed: int = 0,
    *,
    speeds: Sequence[float] = (20.0, 40.0, 60.0, 20.0, 40.0, 60.0),
    reach: float = 60.0,
    pause: float = 0.5,
    period: float = PERIOD,
    jitter: float = 0.0,
    noise: float = 0.3,
) -> pd.DataFrame:
    """Return a log with friction 5 + 2 sqrt(v), gravity 30 cos q, and white noise of torque.

    ``speeds`` [deg/s] are moved there and back over ``reach`` [deg] with ramps of 0.3 s and pauses
    [s] between. Temperature rises from 25 °C by 2 °C in steps of 1 °C.
    """
    rng = np.random.default_rng(seed)
    parts = [np.zeros(round(pause / period))]
    for speed in speeds:
        ramp = 0.3
        n = round((reach / speed + ramp) / period)
        t = (np.arange(n) + 0.5) * period
        shape = np.clip(np.minimum(t, n * period - t) / ramp, 0, 1) * speed
        parts += [shape, np.zeros(round(pause / period)), -shape, np.zeros(round(pause / period))]
    velocity = np.concatenate(parts)
    n = len(velocity)
    position = -30 + np.concatenate(([0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2 * period)))
    friction = np.tanh(velocity / 0.5) * (5 + 2 * np.sqrt(np.abs(velocity)))
    torque = 30 * np.cos(np.radians(position)) + friction + rng.normal(0, noise, n)
    time = np.arange(n) * period + (rng.normal(0, jitter, n) if jitter else 0.0)
    warm = 25.0 + np.floor(3 * np.arange(n) / n)
    measured = velocity + rng.normal(0, 0.02, n)
    return pd.DataFrame(
        dict(
            zip(
                COLUMNS,
                (time, position + rng.normal(0, 2e-4, n), measured, torque, warm),
                strict=True,
            )
        )
    )


def write(log: pd.DataFrame, path: Path, digits: int = 6) -> Path:
    """Write a log as CSV and return its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    log.to_csv(path, sep=";", index=False, float_format=f"%.{digits}f")
    return path


def moving(log: pd.DataFrame) -> np.ndarray:
    """Return the rows inside constant-speed moves, away from their ends."""
    speed = log[COLUMNS[2]].abs().to_numpy()
    steady = np.abs(np.gradient(log[COLUMNS[2]].to_numpy())) < 0.2
    fast = (speed > 15) & steady
    inner = np.convolve(fast, np.ones(21), "same") > 20.5
    return np.flatnonzero(inner)
