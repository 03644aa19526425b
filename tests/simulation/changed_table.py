"""Changes that come, go and recur, added to a table of torques."""

import numpy as np
import pandas as pd

from frictioncli.model.friction import PUBLISHED


def hours(table: pd.DataFrame) -> np.ndarray:
    """Return the time of each row since its run's start [h]."""
    return table["time"].to_numpy(float) / 3600.0


def middle(table: pd.DataFrame) -> np.ndarray:
    """Return where a row is in the later half of its run's duration."""
    longest = table.groupby("run", observed=True)["time"].transform("max")
    return (table["time"] > longest / 2).to_numpy()


def with_friction_step(table: pd.DataFrame, there: np.ndarray, size: float) -> pd.DataFrame:
    """Return the table with more friction where a change is there [N·m]."""
    return _with(table, np.where(there, size, 0.0), np.zeros(len(table)))


def with_payload(table: pd.DataFrame, there: np.ndarray, cosine: float, sine: float = 0.0):
    """Return the table with more gravity where a payload is there, and its friction [N·m]."""
    angle = np.radians(table["position"].to_numpy(float))
    added = np.where(there, cosine * np.cos(angle) + sine * np.sin(angle), 0.0)
    load = table["load_torque"].to_numpy(float)
    friction = PUBLISHED.alpha * (np.square(load + added) - np.square(load))
    return _with(table, friction, added)


def _with(table: pd.DataFrame, friction: np.ndarray, load: np.ndarray) -> pd.DataFrame:
    return table.assign(
        friction_torque=table["friction_torque"] + friction,
        load_torque=table["load_torque"] + load,
        torque_forward=table["torque_forward"] + load + friction,
        torque_reverse=table["torque_reverse"] + load - friction,
    )
