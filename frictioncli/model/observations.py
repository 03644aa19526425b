"""Friction torques of a joint as means of pairs and deviations within them.

Speed and temperature are constant within a pair, so that only the load term of equation (16) varies
there. All other terms are determined by one mean per pair. The split is exact and makes the cost of
a fit independent of the number of angle bins.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Indices
from frictioncli.model.zero_load import PAIR_KEY, temperature_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Observations:
    """Friction of one joint by pair, ordered by run and time.

    Attributes
    ----------
    run : ndarray of int, shape (pairs,)
        Number of the run that each pair belongs to.
    time, speed, temperature : ndarray, shape (pairs,)
        Time, speed and temperature of each pair; NaN without temperature. [s], [deg/s], [°C]
    friction, squared_load : ndarray, shape (pairs,)
        Means over the pair's angle bins. [N·m], [(N·m)²]
    bins : ndarray of int, shape (pairs,)
        Number of angle bins.
    friction_within, squared_load_within : ndarray, shape (rows,)
        Deviations of the bins from their pair's means. [N·m], [(N·m)²]
    row_pair, row_position : ndarray, shape (rows,)
        The pair and the angle of each row. [-], [deg]
    """

    run: Indices
    time: Array
    speed: Array
    temperature: Array
    friction: Array
    squared_load: Array
    bins: Array
    friction_within: Array
    squared_load_within: Array
    row_pair: Indices
    row_position: Array

    @property
    def load_contrast(self) -> float:
        """Sum of squares, in (N·m)⁴, of the squared load about its pair means."""
        return float(self.squared_load_within @ self.squared_load_within)


def observations(torques: pd.DataFrame, temperature: str) -> Observations:
    """Return the observations of one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    """
    columns = [*PAIR_KEY, "time", "speed", "position", "friction_torque"]
    ordered = (
        torques[columns]
        .assign(
            squared_load=np.square(torques["load_torque"]),
            temperature=temperature_of(torques, temperature),
        )
        .sort_values(["run", "time", "pair", "position"])
    )
    grouped = ordered.groupby(PAIR_KEY, sort=False, observed=True)
    means = (
        grouped[["time", "speed", "temperature", "friction_torque", "squared_load"]]
        .mean()
        .reset_index()
    )
    row_pair = grouped.ngroup().to_numpy()
    return Observations(
        run=pd.factorize(means["run"])[0],
        time=means["time"].to_numpy(float),
        speed=means["speed"].to_numpy(float),
        temperature=means["temperature"].to_numpy(float),
        friction=means["friction_torque"].to_numpy(float),
        squared_load=means["squared_load"].to_numpy(float),
        bins=grouped.size().to_numpy(float),
        friction_within=ordered["friction_torque"].to_numpy(float)
        - means["friction_torque"].to_numpy(float)[row_pair],
        squared_load_within=ordered["squared_load"].to_numpy(float)
        - means["squared_load"].to_numpy(float)[row_pair],
        row_pair=row_pair,
        row_position=ordered["position"].to_numpy(float),
    )
