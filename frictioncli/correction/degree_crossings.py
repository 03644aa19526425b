"""When the temperature next changes by a degree, for every instant at once."""

import numpy as np

from frictioncli.arrays import Array, Flags, Indices

DEGREE = 1.0 - 1e-9
"""Change of the motor temperature that the criterion waits for: 1 °C. Readings are whole degrees,
and converting from Kelvin must not turn 1 °C into less. [°C]"""


def next_changes(temperature: Array) -> Indices:
    """Return for each instant the first later one at which the temperature is 1 °C away from it.

    Parameters
    ----------
    temperature : ndarray, shape (instants,)
        Registered temperature. [°C]

    Returns
    -------
    ndarray of int, shape (instants,)
        Indices into ``temperature``; its length where the temperature stays.
    """
    # readings are a staircase: all instants of one step share the answer
    steps = np.flatnonzero(np.append(True, np.diff(temperature) != 0))
    borders = np.append(steps, len(temperature))
    return np.repeat(borders[_first_departures(temperature[steps])], np.diff(borders))


def _first_departures(values: Array) -> Indices:
    """Return for each value the index of the first later one that is a degree away.

    Ranges without a departure are skipped by the extrema of blocks of 1, 2, 4, ... values: through
    growing blocks up to the one that holds the departure, then into its halves.
    """
    levels = _block_extrema(values)

    def clear(at: Indices, level: int) -> Flags:
        highest, lowest = levels[level]
        block = at >> level
        return (highest[block] - values < DEGREE) & (values - lowest[block] < DEGREE)

    at = np.arange(1, len(values) + 1)
    growing = np.ones(len(values), dtype=bool)
    for level in range(len(levels)):
        odd = growing & ((at >> level) & 1 == 1)
        skipped = odd & clear(at, level)
        growing &= skipped | ~odd
        at += skipped << level
    for level in reversed(range(len(levels))):
        aligned = at & ((1 << level) - 1) == 0
        at += (aligned & clear(at, level)) << level
    return at


def _block_extrema(values: Array) -> list[tuple[Array, Array]]:
    """Return highest and lowest values of aligned blocks, level by level.

    After the values stands one that departs from all of them, so that every search ends there.
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
