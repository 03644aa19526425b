"""Friction of each pair without load, as in Figures 5, 6, 9 and 10 of the source paper."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.model.stuck_reading import is_stuck

PAIR_KEY = ["run", "joint", "pair"]
"""What identifies a pair of counter-directed moves."""

_PAIR_COLUMNS = [
    "speed",
    "time",
    "phase",
    "motor_temperature",
    "housing_temperature",
    "motor_temperature_reading",
]


def friction_at_zero_load(torques: pd.DataFrame, alpha: float) -> pd.DataFrame:
    r"""Return one row per pair with its friction torque at zero load.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.
    alpha : float
        Load coefficient of equation (16). [1/(N·m)]

    Returns
    -------
    DataFrame
        Columns ``run, joint, pair, speed, time, phase``, the temperatures, and
        ``friction_torque``, ordered by run, joint and time. [N·m]

    Notes
    -----
    Within one pair, speed and temperature are constant, so equation (9) leaves
    :math:`\tau = \alpha L^2 + G`. G is the mean of :math:`\tau - \alpha L^2` over the pair's angle
    bins, so that it exists also where the load never crosses zero.
    """
    unloaded = torques["friction_torque"] - alpha * np.square(torques["load_torque"])
    grouped = torques.assign(friction_torque=unloaded).groupby(PAIR_KEY, sort=False, observed=True)
    present = [name for name in _PAIR_COLUMNS if name in torques]
    pairs = grouped[present].first().assign(friction_torque=grouped["friction_torque"].mean())
    return pairs.reset_index().sort_values(["run", "joint", "time"], ignore_index=True)


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Pairs that have no temperature to be used with.

    Attributes
    ----------
    without : int
        Pairs without a reading.
    stuck : int
        Pairs whose reading stood still and then jumped.
    """

    without: int = 0
    stuck: int = 0


def with_temperature(rows: pd.DataFrame, kind: str) -> tuple[pd.DataFrame, LeftOut]:
    """Return the rows with a known temperature, and of how many pairs it is not.

    Where no row has one, all are returned: friction is then a function of speed and load alone.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.
    kind : {"motor", "housing", "mean"}
        As of :func:`temperature_of`.
    """
    reading = temperature_of(rows, kind)
    read = reading.notna()
    if not read.any():
        return rows, LeftOut()
    stuck = _with_stuck_reading(rows[[*PAIR_KEY, "time"]].assign(reading=reading))
    usable = read & ~stuck
    if usable.all() or not usable.any():
        return rows, LeftOut()
    return rows[usable], LeftOut(without=_pairs(rows[~read]), stuck=_pairs(rows[stuck]))


def _pairs(rows: pd.DataFrame) -> int:
    return int(rows.groupby(PAIR_KEY, observed=True).ngroups)


def _with_stuck_reading(rows: pd.DataFrame) -> pd.Series:
    """Return which rows have a reading that stood still and then jumped."""
    pairs = rows.groupby(PAIR_KEY, sort=False, observed=True)[["time", "reading"]].first()
    pairs = pairs.sort_values("time").assign(stuck=False)
    for _, run in pairs.groupby(level=["run", "joint"], observed=True):
        pairs.loc[run.index, "stuck"] = is_stuck(run["time"].to_numpy(), run["reading"].to_numpy())
    return rows[PAIR_KEY].join(pairs["stuck"], on=PAIR_KEY)["stuck"].astype(bool)


def temperature_of(pairs: pd.DataFrame, kind: str) -> pd.Series:
    """Return the temperature that the friction function is given: motor, housing or their mean.

    Parameters
    ----------
    pairs : DataFrame
        Rows with ``motor_temperature`` and ``housing_temperature``. [°C]
    kind : {"motor", "housing", "mean"}
        ``mean`` is :math:`T^*` of equation (11).
    """
    motor, housing = pairs["motor_temperature"], pairs["housing_temperature"]
    return {"motor": motor, "housing": housing, "mean": (motor + housing) / 2}[kind]
