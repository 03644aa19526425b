"""Residuals in bins of an axis: means over pairs, their errors, and a fitted term's means."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.effects.base import EffectTable
from frictioncli.report.style import COOLING, HEATING, MODEL

_BINS = {"speed": 26, "position": 40, "load": 14, "clock": 24}
_OTHER_BINS = 12
_PLACES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)
_SAME_LEVEL = 0.02
_LEAST_SHARE = 0.002
"""A bin with a smaller share of the rows than this says nothing."""

_WARM_AXES = ("temperature", "motor_temperature", "housing_temperature")


@dataclass(frozen=True, slots=True, kw_only=True)
class BinnedSeries:
    """Rows that are binned apart from the others.

    Attributes
    ----------
    name : str
        Their name in the legend; empty where there is only one series.
    colour : str
        Their colour.
    filled : bool
        Whether their markers are filled or hollow.
    rows : ndarray of bool, shape (rows,)
        Which rows.
    """

    name: str
    colour: str
    filled: bool
    rows: Flags


@dataclass(frozen=True, slots=True, kw_only=True)
class BinnedMeans:
    """Means in bins, shape (bins,) each; bins without data are left out.

    Attributes
    ----------
    bin : ndarray of int
        Number of each bin.
    at : ndarray
        Mean of the axis in each bin.
    mean, error : ndarray
        Mean residual and its standard error over pairs; NaN for a single pair. [N·m]
    term : ndarray
        Mean of the fitted term over the same rows. [N·m]
    """

    bin: Indices
    at: Array
    mean: Array
    error: Array
    term: Array


def residual_series(table: EffectTable, axis: str, channel: str) -> list[BinnedSeries]:
    """Return how the rows are split, so that an effect's evidence does not cancel in the mean.

    Parameters
    ----------
    table : EffectTable
        The rows.
    axis : str
        Column that the residuals are drawn against.
    channel : {"friction", "load"}
        Channel of the residuals.
    """
    if channel == "load" and axis in (*_WARM_AXES, "clock") and np.ptp(np.sign(table.load)) > 0:
        return _two(table.load > 0, "load above 0", "load below 0")
    if axis in _WARM_AXES:
        rising = is_warming(table)
        return _two(rising, "warming up", "cooling down")
    if axis == "speed":
        if np.ptp(table.temperature) == 0:
            return _two(np.ones(len(table.speed), bool), "", "")
        middle = float(np.median(table.temperature))
        return _two(table.temperature > middle, f"above {middle:.0f} °C", f"up to {middle:.0f} °C")
    if axis in ("position", "load"):
        middle = float(np.median(np.unique(merge_close_values(table.speed))))
        return _two(table.speed > middle, f"above {middle:.3g} deg/s", f"up to {middle:.3g} deg/s")
    return _two(np.ones(len(table.speed), bool), "", "")


def _two(chosen: Flags, name: str, other: str) -> list[BinnedSeries]:
    if chosen.all() or not chosen.any():
        return [BinnedSeries(name="", colour=MODEL, filled=True, rows=np.ones(len(chosen), bool))]
    return [
        BinnedSeries(name=name, colour=HEATING, filled=True, rows=chosen),
        BinnedSeries(name=other, colour=COOLING, filled=False, rows=~chosen),
    ]


def is_warming(table: EffectTable) -> Flags:
    """Return at which rows the temperature rises, over nine pairs about each row's pair."""
    pairs = pd.DataFrame(
        {"run": table.run, "pair": table.pair, "warm": table.temperature}
    ).drop_duplicates("pair")
    smooth = pairs.groupby("run")["warm"].transform(
        lambda warm: warm.rolling(9, center=True, min_periods=1).mean()
    )
    trend = smooth.groupby(pairs["run"]).transform(
        lambda warm: pd.Series(
            np.gradient(warm.to_numpy()) if len(warm) > 1 else 0.0, index=warm.index
        )
    )
    by_pair = dict(zip(pairs["pair"], trend > 0, strict=True))
    return np.array([by_pair[pair] for pair in table.pair])


def merge_close_values(values: Array) -> Array:
    """Return values with those that lie closer than two per cent made equal."""
    ordered, place = np.unique(values, return_inverse=True)
    new = np.diff(ordered, prepend=ordered[0]) > _SAME_LEVEL * np.maximum(np.abs(ordered), 1e-9)
    group = np.cumsum(new)
    weight = np.bincount(place)
    means = np.bincount(group, ordered * weight) / np.bincount(group, weight)
    return np.asarray(means[group][place])


def bin_numbers(axis: str, values: Array) -> Indices:
    """Return the number of each row's bin along an axis.

    Speeds and angles are levels of their own or, if they are many, a few neighbours together;
    places in a series fall into bins that widen; other axes get bins of equal width.
    """
    if axis == "order":
        return np.searchsorted(_PLACES, values, side="right")
    if axis in ("speed", "position"):
        known = np.unique(merge_close_values(values) if axis == "speed" else values)
        return np.searchsorted(group_boundaries(known, _BINS[axis]), values, side="right")
    edges = np.linspace(values.min(), values.max(), _BINS.get(axis, _OTHER_BINS) + 1)[1:-1]
    return np.searchsorted(edges, values, side="right")


def group_boundaries(known: Array, most: int) -> Array:
    """Return the values that part ascending levels into at most so many groups of even size."""
    groups = np.array_split(known, min(len(known), most))
    return np.array([(one[-1] + other[0]) / 2 for one, other in pairwise(groups)])


def bin_means(rows: pd.DataFrame) -> BinnedMeans:
    """Return means per bin. Rows of a pair share its noise, so errors are taken over pairs.

    Parameters
    ----------
    rows : DataFrame
        ``bin`` and ``pair`` of each row, ``at`` on the axis, and ``mean`` and ``term``, the
        residual and the fitted term. [N·m]
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
