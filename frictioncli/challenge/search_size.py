"""Search for the least size of an effect that is found, by bisection."""

import math
from collections.abc import Callable
from dataclasses import dataclass

_STEP = 2.0
"""Factor between two sizes until one is found and one is not."""

_CLOSE = 1.35
"""Ratio of a size that is found to one that is not at which the search ends."""

_MOST_STEPS = 5
"""Greatest number of steps in one direction until one is found and one is not."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeFound:
    """Least size of an effect that is found.

    Attributes
    ----------
    size : float or None
        Geometric mean of the bounds, or the one there is; None where nothing was found.
    low, high : float or None
        Greatest size that was not found, and least size that was; None where there is none.
    """

    size: float | None
    low: float | None
    high: float | None


def search_size(
    found: Callable[[float], bool | None], start: float, *, least: float, most: float
) -> SizeFound:
    """Return the least size that is found, and between which sizes it lies.

    Parameters
    ----------
    found : callable
        Returns whether a size is found, None where that size cannot be tried.
    start : float
        Size to begin with.
    least, most : float
        Range of the sizes to try.

    Returns
    -------
    SizeFound
        The size with its bounds.

    Examples
    --------
    >>> result = search_size(lambda size: size >= 1.3, 1.0, least=0.1, most=10.0)
    >>> round(result.low, 2), round(result.high, 2)
    (1.19, 1.41)
    """
    low, high = _bracket(found, min(max(start, least), most), least, most)
    while low is not None and high is not None and high / low > _CLOSE:
        middle = math.sqrt(low * high)
        answer = found(middle)
        if answer is None:
            break
        low, high = (low, middle) if answer else (middle, high)
    if high is None:
        return SizeFound(size=None, low=low, high=None)
    size = high if low is None else math.sqrt(low * high)
    return SizeFound(size=size, low=low, high=high)


def _bracket(
    found: Callable[[float], bool | None], start: float, least: float, most: float
) -> tuple[float | None, float | None]:
    """Return a size that is not found and a larger one that is; None where there is none."""
    low = high = None
    size = start
    for _ in range(_MOST_STEPS):
        answer = found(size)
        if answer is None:
            break
        if answer:
            high = size
        else:
            low = size
        if low is not None and high is not None:
            break
        following = size / _STEP if answer else size * _STEP
        if not least <= following <= most:
            break
        size = following
    return low, high
