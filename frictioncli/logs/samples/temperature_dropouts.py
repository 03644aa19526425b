"""Readings of a temperature that fall out for a moment, as of a sensor that is reset."""

from itertools import pairwise

import numpy as np

from frictioncli.arrays import Array

_JUMP = 10.0
"""A reading that changes by as much between two samples is no temperature of a joint. [°C]"""

_NEIGHBOURS = 2.0
"""Greatest time between two such samples: in a pause a joint may cool down. [s]"""

_RETURNS = 2.0
"""Greatest difference between the readings before and after. [°C]"""

_LONGEST = 60.0
"""Longest time without a reading that is found. [s]"""


def without_dropouts(time: Array, temperature: Array) -> Array:
    """Return temperatures in which readings that fall out for a moment are replaced by NaN.

    They jump away by 10 °C or more from one sample to the next, and within a minute back to where
    they were: a drive that is restarted reads 0 °C.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Time of the samples. [s]
    temperature : ndarray, shape (n,)
        Readings; NaN where there is none. [°C]

    Returns
    -------
    ndarray, shape (n,)
        Readings. [°C]

    Examples
    --------
    >>> import numpy as np
    >>> without_dropouts(np.arange(5.0), np.array([40.0, 40.0, 0.0, 0.0, 40.0]))
    array([40., 40., nan, nan, 40.])
    """
    if len(temperature) < 3 or np.ptp(temperature) < _JUMP:
        return temperature
    there = np.flatnonzero(np.isfinite(temperature))
    reading, moment = temperature[there], time[there]
    change, apart = np.diff(reading), np.diff(moment)
    jumps = np.flatnonzero((np.abs(change) >= _JUMP) & (apart >= 0) & (apart <= _NEIGHBOURS))
    found = temperature
    last = -1
    for first, back in pairwise(jumps.tolist()):
        returned = abs(reading[back + 1] - reading[first]) <= _RETURNS
        short = moment[back + 1] - moment[first] <= _LONGEST
        if first > last and returned and short:
            found = found.copy() if found is temperature else found
            found[there[first + 1] : there[back] + 1] = np.nan
            last = back
    return found
