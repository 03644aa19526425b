"""Columns of the forms of structure, in both channels."""

from collections.abc import Callable, Mapping

import numpy as np
from scipy.special import ndtr

from frictioncli.arrays import Array
from frictioncli.effects.base import Basis, EffectTable

Shape = Mapping[str, float]

BUMP = "bump"
"""Form that shows in both channels, because the torque is logged late."""

UNEVEN_BUMP = "uneven_bump"
"""Form of the same that is not as high in both directions, which shows in both channels, too."""

LATE_BUMPS = (BUMP, UNEVEN_BUMP)
"""Forms that are seen later forward and earlier in reverse, the more the faster the move is."""

MIDDLE_TEMPERATURE = 40.0
"""Temperature from which linear forms count. [°C]"""


def columns_of(
    kind: str,
    axes: tuple[str, ...],
    channel: str,
    table: EffectTable,
    shape: Shape,
    sign: float = 1.0,
) -> Basis:
    """Return the columns of a form in both channels at rows, shape (rows, coefficients) each.

    Parameters
    ----------
    kind : str
        The form.
    axes : tuple of str
        What it depends on.
    channel : {"friction", "load"}
        The torque in which it shows.
    table : EffectTable
        The rows.
    shape : mapping of str to float
        The shape parameters.
    sign : float, optional
        Sign convention of the torques: +1 where forward is load plus friction, else -1.
    """
    if kind in LATE_BUMPS:
        of_directions = _of_directions(table, shape, sign)
        if kind == UNEVEN_BUMP:
            return of_directions
        height = np.array([[1.0], [1.0]] if channel == "friction" else [[sign], [-sign]])
        return Basis(*(one @ height for one in of_directions))
    own = COLUMNS[kind](axes, table, shape)
    zeros = np.zeros_like(own)
    return Basis(own, zeros) if channel == "friction" else Basis(zeros, own)


def _peak_columns(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    return np.exp(-np.square(_away(axes, table, shape)) / 2)[:, np.newaxis]


def _of_directions(table: EffectTable, shape: Shape, sign: float) -> Basis:
    """Return a peak at one angle, forward and in reverse, shape (rows, 2) per channel.

    The log shows it late: forward later, in reverse earlier. Friction is half the difference of
    the torques of both directions, load half their sum.
    """
    moved = table.speed * shape["lag"]
    forward, reverse = (
        np.exp(-np.square((table.position - way * moved - shape["centre"]) / shape["width"]) / 2)
        for way in (1, -1)
    )
    return Basis(
        np.column_stack([forward, reverse]) / 2,
        sign * np.column_stack([forward, -reverse]) / 2,
    )


def _above(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    return np.maximum(_amount(axes[0], table) - shape["start"], 0.0)[:, np.newaxis] / 10.0


def _below(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    return np.maximum(shape["start"] - _amount(axes[0], table), 0.0)[:, np.newaxis] / 10.0


def _step(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    return np.asarray(ndtr(_away(axes, table, shape))[:, np.newaxis])


def _lifting(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    power = np.sign(table.load) * np.abs(table.load / 50.0) ** shape["exponent"]
    return np.asarray(power[:, np.newaxis])


def _moving_peak_columns(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    moved = np.log(np.maximum(table.speed, 1e-9) / shape["centre"])
    moved = moved - shape["shift"] * (table.temperature - MIDDLE_TEMPERATURE)
    return np.exp(-np.square(moved / shape["width"]) / 2)[:, np.newaxis]


def _warm_wave(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    waves = _waves(table, shape["order"])
    return np.hstack([waves, waves * (table.temperature - MIDDLE_TEMPERATURE)[:, np.newaxis] / 10])


def _turning_wave(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    ratio = np.square(np.maximum(table.speed, 1e-9) / shape["turn"])
    return _waves(table, shape["order"]) * ((ratio - 1) / (ratio + 1))[:, np.newaxis]


def _waves(table: EffectTable, order: float) -> Array:
    angle = order * np.radians(table.position)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _away(axes: tuple[str, ...], table: EffectTable, shape: Shape) -> Array:
    """Return distances from a centre in widths, of the speed in its logarithm."""
    (axis,) = axes
    if axis == "speed":
        away = np.log(np.maximum(table.speed, 1e-9) / shape["centre"])
    else:
        away = _amount(axis, table) - shape["centre"]
    return np.asarray(away / shape["width"])


def _amount(axis: str, table: EffectTable) -> Array:
    values = getattr(table, axis)
    return np.abs(values) if axis == "load" else np.asarray(values)


COLUMNS: Mapping[str, Callable[[tuple[str, ...], EffectTable, Shape], Array]] = {
    "peak": _peak_columns,
    "bend_above": _above,
    "bend_below": _below,
    "step": _step,
    "lifting": _lifting,
    "moving_peak": _moving_peak_columns,
    "warm_wave": _warm_wave,
    "turning_wave": _turning_wave,
}
"""Columns of each kind of form."""
