"""Residuals in bins of a variable: means over pairs, their standard errors, fitted term."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.effects.base import EffectTable
from frictioncli.report.style import COOLING, HEATING, MODEL

_BIN_COUNTS = {"speed": 26, "position": 40, "load": 14, "clock": 24}
_DEFAULT_BIN_COUNT = 12
_ORDER_EDGES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)
_EQUAL_WITHIN = 0.02
"""Relative difference below which two speeds are counted as equal."""

_LEAST_SHARE = 0.002
"""Least share of the rows for a bin to be used."""

_TEMPERATURES = ("temperature", "motor_temperature", "housing_temperature")


@dataclass(frozen=True, slots=True, kw_only=True)
class BinnedSeries:
    """Rows that are drawn as a series of their own.

    Attributes
    ----------
    name : str
        Name in the legend; empty if there is only one series.
    colour : str
        Colour.
    filled : bool
        Whether the markers are filled or hollow.
    rows : ndarray of bool, shape (rows,)
        Rows of this series.
    """

    name: str
    colour: str
    filled: bool
    rows: Flags


@dataclass(frozen=True, slots=True, kw_only=True)
class BinnedMeans:
    """Means in bins; bins without data are left out.

    Attributes
    ----------
    bin : ndarray of int, shape (bins,)
        Number of each bin.
    at : ndarray, shape (bins,)
        Mean of the variable in each bin.
    mean, error : ndarray, shape (bins,)
        Mean residual and its standard error over pairs, NaN for a single pair. [N·m]
    term : ndarray, shape (bins,)
        Mean of the fitted term over the same rows. [N·m]
    """

    bin: Indices
    at: Array
    mean: Array
    error: Array
    term: Array


def residual_series(table: EffectTable, axis: str, channel: str) -> list[BinnedSeries]:
    """Return the rows split into series whose residuals would cancel in a common mean.

    Parameters
    ----------
    table : EffectTable
        Rows of the diagnosis.
    axis : str
        Variable against which the residuals are drawn.
    channel : {"friction", "load"}
        Channel of the residuals.
    """
    if channel == "load" and axis in (*_TEMPERATURES, "clock") and np.ptp(np.sign(table.load)) > 0:
        return _split(table.load > 0, "load above 0", "load below 0")
    if axis in _TEMPERATURES:
        return _split(is_warming(table), "warming up", "cooling down")
    if axis == "speed":
        if np.ptp(table.temperature) == 0:
            return _split(np.ones(len(table.speed), bool), "", "")
        middle = float(np.median(table.temperature))
        return _split(
            table.temperature > middle, f"above {middle:.0f} °C", f"up to {middle:.0f} °C"
        )
    if axis in ("position", "load"):
        middle = float(np.median(np.unique(merge_close_values(table.speed))))
        return _split(
            table.speed > middle, f"above {middle:.3g} deg/s", f"up to {middle:.3g} deg/s"
        )
    return _split(np.ones(len(table.speed), bool), "", "")


def _split(first: Flags, name: str, other_name: str) -> list[BinnedSeries]:
    if first.all() or not first.any():
        return [BinnedSeries(name="", colour=MODEL, filled=True, rows=np.ones(len(first), bool))]
    return [
        BinnedSeries(name=name, colour=HEATING, filled=True, rows=first),
        BinnedSeries(name=other_name, colour=COOLING, filled=False, rows=~first),
    ]


def is_warming(table: EffectTable) -> Flags:
    """Return the rows at which the temperature rises, smoothed over nine pairs.

    Parameters
    ----------
    table : EffectTable
        Rows of the diagnosis.
    """
    pairs = pd.DataFrame(
        {"run": table.run, "pair": table.pair, "temperature": table.temperature}
    ).drop_duplicates("pair")
    smooth = pairs.groupby("run")["temperature"].transform(
        lambda values: values.rolling(9, center=True, min_periods=1).mean()
    )
    trend = smooth.groupby(pairs["run"]).transform(
        lambda values: pd.Series(
            np.gradient(values.to_numpy()) if len(values) > 1 else 0.0, index=values.index
        )
    )
    by_pair = dict(zip(pairs["pair"], trend > 0, strict=True))
    return np.array([by_pair[pair] for pair in table.pair])


def merge_close_values(values: Array) -> Array:
    """Return values in which neighbours that differ by less than 2 % are replaced by their mean.

    Parameters
    ----------
    values : ndarray, shape (rows,)
        Values, such as speeds.

    Examples
    --------
    >>> merge_close_values(np.array([10.0, 10.1, 50.0])).tolist()
    [10.05, 10.05, 50.0]
    """
    ordered, index = np.unique(values, return_inverse=True)
    new = np.diff(ordered, prepend=ordered[0]) > _EQUAL_WITHIN * np.maximum(np.abs(ordered), 1e-9)
    group = np.cumsum(new)
    weight = np.bincount(index)
    means = np.bincount(group, ordered * weight) / np.bincount(group, weight)
    return np.asarray(means[group][index])


def bin_numbers(axis: str, values: Array) -> Indices:
    """Return the bin number of each row along a variable.

    Each speed and each angle has its own bin, or a few neighbours share one if there are many. Bins
    of the order after a rest grow geometrically. Other variables have bins of equal width.

    Parameters
    ----------
    axis : str
        Name of the variable.
    values : ndarray, shape (rows,)
        Its values.
    """
    if axis == "order":
        return np.searchsorted(_ORDER_EDGES, values, side="right")
    if axis in ("speed", "position"):
        known = np.unique(merge_close_values(values) if axis == "speed" else values)
        return np.searchsorted(group_boundaries(known, _BIN_COUNTS[axis]), values, side="right")
    edges = np.linspace(values.min(), values.max(), _BIN_COUNTS.get(axis, _DEFAULT_BIN_COUNT) + 1)[
        1:-1
    ]
    return np.searchsorted(edges, values, side="right")


def group_boundaries(known: Array, most: int) -> Array:
    """Return the boundaries that divide ascending values into groups of equal size.

    Parameters
    ----------
    known : ndarray, shape (values,)
        Distinct values, ascending.
    most : int
        Greatest number of groups.

    Examples
    --------
    >>> group_boundaries(np.arange(5.0), 2).tolist()
    [2.5]
    """
    groups = np.array_split(known, min(len(known), most))
    return np.array([(lower[-1] + upper[0]) / 2 for lower, upper in pairwise(groups)])


def bin_means(rows: pd.DataFrame) -> BinnedMeans:
    """Return means per bin, with standard errors over pairs, since rows of a pair share noise.

    Parameters
    ----------
    rows : DataFrame
        Per row ``bin``, ``pair``, ``at``, the variable, and ``mean`` and ``term``, the residual and
        the fitted term. [N·m]
    """
    sizes = rows.groupby("bin").size()
    rows = rows[rows["bin"].isin(sizes.index[sizes >= _LEAST_SHARE * len(rows)])]
    of_pairs = rows.groupby(["bin", "pair"])[["at", "mean", "term"]].mean().groupby("bin")
    means = of_pairs.mean()
    return BinnedMeans(
        bin=means.index.to_numpy(),
        at=means["at"].to_numpy(),
        mean=means["mean"].to_numpy(),
        error=of_pairs["mean"].sem().to_numpy(),
        term=means["term"].to_numpy(),
    )
