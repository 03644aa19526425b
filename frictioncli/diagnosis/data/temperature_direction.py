"""Whether the joint was warming up or cooling down at each row."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import EffectTable

_HALF_WINDOW = 300.0
"""Time before and after a row over which the change of temperature is taken. [s]"""

_LEAST_CHANGE = 0.2
"""Least change of temperature over that time that is no noise. [°C]"""


def temperature_direction(table: EffectTable) -> Array:
    """Return 1 where the measured temperature rises, -1 where it falls, 0 where it is steady.

    Parameters
    ----------
    table : EffectTable
        The rows.

    Returns
    -------
    ndarray, shape (rows,)
        Direction of each row, from the change of temperature over ten minutes.
    """
    direction = np.zeros(len(table.time))
    known = np.isfinite(table.measured_temperature)
    for run in np.unique(table.run):
        own = (table.run == run) & known
        if not own.any():
            continue
        time, first = np.unique(table.time[own], return_index=True)
        temperature = table.measured_temperature[own][first]
        at = table.time[own]
        after, before = (
            np.interp(at + shift, time, temperature) for shift in (_HALF_WINDOW, -_HALF_WINDOW)
        )
        change = after - before
        direction[own] = np.where(np.abs(change) > _LEAST_CHANGE, np.sign(change), 0.0)
    return direction
