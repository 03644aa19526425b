"""Runs of a joint that is exactly equation (16), by a formula of the tests' own."""

import numpy as np
import pandas as pd

ANGLES = np.array([-60.0, -30.0, 0.0, 30.0, 60.0])
SPEEDS = (20.0, 45.0, 90.0)
LOAD = 80.0


def friction(load, speed, temperature):
    """Friction of equation (16), term by term. [N·m]."""
    return 10 + 0.0014 * load**2 + (3 + 15 * np.exp(-0.05 * temperature)) * np.sqrt(speed)


def torques(
    runs,
    *,
    offset=None,
    share=None,
    carried=None,
    logged=None,
    day_to_day=0.0,
    warmth=None,
    noise=0.1,
    seed=0,
):
    """Rows of torques of so many runs, one list entry per run for what changes.

    ``offset`` [N·m] and ``share`` change friction, ``carried`` the load, ``logged`` all torques;
    ``warmth`` are the temperatures of a run's series [°C]; ``day_to_day`` is a scatter [N·m].
    """
    generator = np.random.default_rng(seed)
    none = np.zeros(runs)
    offset = none if offset is None else np.asarray(offset, dtype=float)
    share = none if share is None else np.asarray(share, dtype=float)
    carried = none if carried is None else np.asarray(carried, dtype=float)
    logged = none if logged is None else np.asarray(logged, dtype=float)
    frames = []
    for run in range(runs):
        series = np.linspace(22, 48, 8) if warmth is None else np.asarray(warmth[run])
        pair_speed = np.tile(SPEEDS, len(series))
        pair_warmth = np.repeat(series, len(SPEEDS))
        load = LOAD * (1 + carried[run]) * np.cos(np.radians(ANGLES))
        rows = friction(load[None, :], pair_speed[:, None], pair_warmth[:, None])
        rows = rows * (1 + share[run]) + offset[run] + day_to_day * generator.standard_normal()
        rows = rows + noise * generator.standard_normal((len(pair_speed), 1))
        rows = rows + noise * generator.standard_normal(rows.shape)
        count = len(ANGLES)
        time = 600.0 * np.repeat(np.arange(len(series)), len(SPEEDS))
        time = time + 20.0 * np.tile(np.arange(len(SPEEDS)), len(series))
        frames.append(
            pd.DataFrame(
                {
                    "run": f"d{run + 1:02d}",
                    "joint": 2,
                    "pair": np.repeat(np.arange(len(pair_speed)), count),
                    "speed": np.repeat(pair_speed, count),
                    "time": np.repeat(time, count),
                    "phase": "heat-up",
                    "motor_temperature": np.repeat(pair_warmth, count),
                    "housing_temperature": np.nan,
                    "motor_temperature_reading": np.repeat(pair_warmth, count),
                    "position": np.tile(ANGLES, len(pair_speed)),
                    "friction_torque": rows.ravel() * (1 + logged[run]),
                    "load_torque": np.tile(load, len(pair_speed)) * (1 + logged[run]),
                    "load": np.nan,
                    "payload": np.nan,
                }
            )
        )
    return pd.concat(frames, ignore_index=True)
