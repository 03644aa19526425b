"""Functions of which the discrepancy is the sum, as columns over the rows of a joint."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.noise.cosine_series import CosineSeries, ranges_of
from frictioncli.effects.base import Channel, EffectTable

FORM = ("speed", "temperature", "form")

SPEED_RIPPLE = ("speed ripple",)

FINE = ("fine position",)

_FINE_ORDERS = (17, 32)
"""Least and greatest order of the cosines of a fine function of the angle."""

_LATE = 0.03
"""By how much a torque is typically late. [s]"""

_FRICTION = (
    ("position",),
    ("speed",),
    ("temperature",),
    ("position", "speed"),
    ("position", "temperature"),
    ("speed", "temperature"),
)

_LOAD = (
    ("position",),
    ("speed",),
    ("temperature",),
    ("position", "speed"),
    ("position", "temperature"),
)


def functions_of(table: EffectTable) -> list[tuple[Channel, tuple[str, ...], Array]]:
    """Return the functions of friction, then those of load, whose quantities vary.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.

    Returns
    -------
    list of (str, tuple of str, ndarray)
        Channel of each function, the quantities that it depends on, or :data:`FORM`, :data:`FINE`
        or :data:`SPEED_RIPPLE`, and its columns, shape (rows, columns).
    """
    ripple = _of_speed_ripple(table)
    friction = [
        (FORM, _form(table)),
        *_functions(table, _FRICTION),
        *_of_fine_angle(table),
        *((SPEED_RIPPLE, late) for late, _ in ripple),
    ]
    load = [
        *_functions(table, _LOAD),
        *_of_fine_angle(table),
        *((SPEED_RIPPLE, torque) for _, torque in ripple),
    ]
    return [*(("friction", *one) for one in friction), *(("load", *one) for one in load)]


def _functions(
    table: EffectTable, wanted: tuple[tuple[str, ...], ...]
) -> list[tuple[tuple[str, ...], Array]]:
    """Return the axes and the columns of each function whose quantities vary."""
    ranges = ranges_of(table)
    found = []
    for axes in wanted:
        if all(axis in ranges for axis in axes):
            series = CosineSeries.of(axes, table, ranges)
            found.append((axes, series.weights * series.columns(table, ranges)))
    return found


def _of_fine_angle(table: EffectTable) -> list[tuple[tuple[str, ...], Array]]:
    """Return cosines of high orders over the angle, all with the same weight.

    They are those beyond the smooth function's. Without them, what is as fine, such as a higher
    harmonic of a ripple, would be a ripple of its own beside a smooth function that is the ripple;
    of the load, such as cogging, that of a friction which shows there because the torque is late.
    """
    angles = len(np.unique(table.position))
    order = np.arange(_FINE_ORDERS[0], min(_FINE_ORDERS[1], angles - 1) + 1)
    if not len(order):
        return []
    low, high = ranges_of(table)["position"]
    place = (table.position - low) / (high - low)
    return [(FINE, np.cos(np.pi * order * place[:, np.newaxis]))]


def _of_speed_ripple(table: EffectTable) -> list[tuple[Array, Array]]:
    r"""Return what the inertia of a speed that ripples adds to friction and load, if speeds differ.

    A ripple over the angle that is a share of the speed has the acceleration
    :math:`v\,dv/dq`, which grows with its square. It may have any order: all weigh the same.
    Behind a late torque what stands in the load forward and in reverse differs, by the more the
    faster the ripple passes: half the difference looks like friction.
    """
    ranges = ranges_of(table)
    if not {"position", "speed"} <= set(ranges):
        return []
    squared = np.square(table.speed / np.max(table.speed))[:, np.newaxis]
    load = squared * CosineSeries.of(("position",), table, ranges).columns(table, ranges)
    order = np.arange(1, load.shape[1] + 1)
    low, high = ranges["position"]
    turned = _LATE * np.pi * order * (table.speed / (high - low))[:, np.newaxis]
    friction = turned / np.sqrt(1.0 + np.square(turned)) * load
    return [(friction, load)]


def _form(table: EffectTable) -> Array:
    """Return what small errors in the form of equation (16) add to friction, shape (rows, 3).

    Of the exponent of the speed, of the way in which grease thins with temperature, and of a
    Coulomb friction that does not depend on temperature.
    """
    viscous = table.viscous * np.sqrt(table.speed)
    speed = np.log(np.maximum(table.speed, 1e-9))
    speed = speed if np.ptp(speed) else np.zeros_like(speed)
    away = table.temperature - np.mean(table.temperature)
    # about the mean: the unit of speed must not matter
    return np.column_stack([viscous * (speed - np.mean(speed)), viscous * np.square(away), away])
