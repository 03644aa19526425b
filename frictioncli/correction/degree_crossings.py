"""Next change of the temperature by one degree, for all instants at once."""

import numpy as np

from frictioncli.arrays import Array, Flags, Indices

DEGREE = 1.0 - 1e-9
"""Change of the motor temperature in criterion (20): 1 °C, with a tolerance for rounding when
readings in whole kelvins are converted. [°C]"""


def next_degree_changes(temperature: Array) -> Indices:
    """Return for each instant the first later one at which the temperature differs by 1 °C.

    Parameters
    ----------
    temperature : ndarray, shape (instants,)
        Registered temperature. [°C]

    Returns
    -------
    ndarray of int, shape (instants,)
        Indices into ``temperature``; its length where there is no such change.

    Examples
    --------
    >>> next_degree_changes(np.array([20.0, 20.0, 21.0, 20.0]))
    array([2, 2, 3, 4])
    """
    # readings are piecewise constant: all instants of one step have the same result
    steps = np.flatnonzero(np.append(True, np.diff(temperature) != 0))
    borders = np.append(steps, len(temperature))
    return np.repeat(borders[_first_departures(temperature[steps])], np.diff(borders))


def _first_departures(values: Array) -> Indices:
    """Return for each value the index of the first later one that differs by a degree.

    The search uses the extrema of aligned blocks of 1, 2, 4, ... values: it skips blocks of growing
    size up to the one that contains the departure, then descends into its halves.
    """
    levels = _block_extrema(values)

    def is_near(at: Indices, level: int) -> Flags:
        """Return whether all values of the blocks at some indices are within a degree."""
        highest, lowest = levels[level]
        block = at >> level
        return (highest[block] - values < DEGREE) & (values - lowest[block] < DEGREE)

    at = np.arange(1, len(values) + 1)
    growing = np.ones(len(values), dtype=bool)
    for level in range(len(levels)):
        odd = growing & ((at >> level) & 1 == 1)
        skipped = odd & is_near(at, level)
        growing &= skipped | ~odd
        at += skipped << level
    for level in reversed(range(len(levels))):
        aligned = at & ((1 << level) - 1) == 0
        at += (aligned & is_near(at, level)) << level
    return at


def _block_extrema(values: Array) -> list[tuple[Array, Array]]:
    """Return the highest and the lowest value of aligned blocks, level by level.

    The values are padded with infinity, so that every search ends there.
    """
    size = 1 << len(values).bit_length()
    highest = np.full(size, np.inf)
    highest[: len(values)] = values
    levels = [(highest, highest)]
    while len(levels[-1][0]) > 1:
        highest, lowest = levels[-1]
        levels.append(
            (np.maximum(highest[::2], highest[1::2]), np.minimum(lowest[::2], lowest[1::2]))
        )
    return levels
