"""Joints that obey equation (16) exactly: the formula by hand, tables of torques, log files.

All test data of equation (16) is made here, by formulas that share no code with the package.
"""

import numpy as np
import pandas as pd

TRUTH = {"tau_c": 10.57, "alpha": 0.0014, "beta": 3.48, "gamma": 15.66, "delta": 0.056}
"""The published parameters: N·m, 1/(N·m), N·m/(deg/s)^0.5 twice, 1/°C."""

SPEEDS = (19.1, 39.4, 67.5, 101.2)
"""Speeds of the paper's thermal cycle. [deg/s]"""


def friction(parameters, *, load, speed, temperature):
    """Return friction of equation (16), term by term. [N·m]."""
    p = parameters
    falling = p["gamma"] * np.exp(-p["delta"] * temperature)
    return p["tau_c"] + p["alpha"] * load**2 + (p["beta"] + falling) * np.sqrt(speed)


def table(pairs, *, position, friction_torque, load_torque, run="day1"):
    """Return rows of the table of torques.

    Parameters
    ----------
    pairs : dict of str to array, shape (pairs,)
        Columns that are constant within a pair: speed, time, phase, temperatures.
    position : array, shape (bins,)
        Centres of the angle bins. [deg]
    friction_torque : array, shape (pairs, bins)
        Friction torque. [N·m]
    load_torque : array, shape (bins,)
        Load torque. [N·m]
    """
    count, bins = friction_torque.shape
    columns = {"pair": np.arange(count)} | pairs
    return pd.DataFrame(
        {name: np.repeat(values, bins) for name, values in columns.items()}
        | {
            "run": run,
            "joint": 2,
            "position": np.tile(position, count),
            "friction_torque": friction_torque.ravel(),
            "load_torque": np.tile(load_torque, count),
        }
    )


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
    """Torques of one run through the paper's thermal cycle, with noise of known size.

    Noise has a part per point and per pair, and an Ornstein-Uhlenbeck drift. [N·m]
    """
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
    exact = friction(truth, load=gravity[None, :], speed=level[:, None], temperature=warm[:, None])
    noisy = exact + common[:, None]
    return table(
        {
            "speed": level,
            "time": clock,
            "phase": np.repeat(phase, len(speeds)),
            "motor_temperature": warm,
            "housing_temperature": warm,
            "motor_temperature_reading": np.round(warm),
        },
        position=position,
        friction_torque=noisy + point * generator.normal(size=noisy.shape),
        load_torque=gravity,
    )


DAILY_TRUTH = {"tau_c": 10.0, "alpha": 0.0014, "beta": 3.0, "gamma": 15.0, "delta": 0.05}
DAILY_LOAD = 80.0
DAILY_SPEEDS = (20.0, 45.0, 90.0)
DAILY_ANGLES = np.array([-60.0, -30.0, 0.0, 30.0, 60.0])


def daily_torques(
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
    """Torques of so many runs of one joint, one list entry per run for what changes.

    ``offset`` [N·m] and ``share`` change friction, ``carried`` the load, ``logged`` all torques;
    ``warmth`` are the temperatures of a run's series [°C]; ``day_to_day`` is a scatter [N·m].
    """
    generator = np.random.default_rng(seed)
    offset, share, carried, logged = (
        np.zeros(runs) if change is None else np.asarray(change, dtype=float)
        for change in (offset, share, carried, logged)
    )
    frames = []
    for run in range(runs):
        series = np.linspace(22, 48, 8) if warmth is None else np.asarray(warmth[run])
        speed = np.tile(DAILY_SPEEDS, len(series))
        warm = np.repeat(series, len(DAILY_SPEEDS))
        load = DAILY_LOAD * (1 + carried[run]) * np.cos(np.radians(DAILY_ANGLES))
        rows = friction(
            DAILY_TRUTH, load=load[None, :], speed=speed[:, None], temperature=warm[:, None]
        )
        rows = rows * (1 + share[run]) + offset[run] + day_to_day * generator.standard_normal()
        rows = rows + noise * generator.standard_normal((len(speed), 1))
        rows = rows + noise * generator.standard_normal(rows.shape)
        time = 600.0 * np.repeat(np.arange(len(series)), len(DAILY_SPEEDS))
        time = time + 20.0 * np.tile(np.arange(len(DAILY_SPEEDS)), len(series))
        own = table(
            {
                "speed": speed,
                "time": time,
                "phase": np.full(len(speed), "heat-up"),
                "motor_temperature": warm,
                "housing_temperature": np.full(len(speed), np.nan),
                "motor_temperature_reading": warm,
            },
            position=DAILY_ANGLES,
            friction_torque=rows * (1 + logged[run]),
            load_torque=load * (1 + logged[run]),
            run=f"d{run + 1:02d}",
        )
        frames.append(own.assign(load=np.nan, payload=np.nan))
    return pd.concat(frames, ignore_index=True)


def write_recording(path, motion, torque, *, axis=2, decimals=3, **columns):
    """Write a KUKA-style trace of one axis.

    Parameters
    ----------
    path : Path
        The file.
    motion : DataFrame
        Columns ``time`` [s] and ``position`` [deg].
    torque : array, shape (samples,)
        Torque at the joint. [N·m]
    **columns
        Further columns, constant or one value per sample.
    """
    frame = pd.DataFrame(
        {
            "Zeit[sec]": motion["time"].round(3),
            f"AxisPos_Act{axis}[°]": motion["position"].round(4),
            f"GearTorq_Act{axis}[Nm]": np.asarray(torque).round(decimals),
        }
        | {name: np.broadcast_to(value, len(motion)) for name, value in columns.items()}
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    frame.to_csv(path, sep=";", index=False, encoding="cp1252")
    return path
