"""Torques of an effect in several shapes, to be planted into the data of a joint.

No joint follows the equation of an entry of the catalogue. What is planted is its torque times a
smooth function of angle, speed, temperature, load and time that is about 1.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import main_channel
from frictioncli.diagnosis.fit.hypotheses import physical_bounds
from frictioncli.diagnosis.search.effect_size import FORM
from frictioncli.effects.base import Basis, Effect
from frictioncli.effects.pair_series import measured_share

_FORM = 2 * FORM
"""Error of form of what is planted, relative to its size: a joint that follows an entry badly."""

_CHANGE = (0.2, 0.8)
"""Shares of the time between the first and the last pair between which a change takes place."""

_TRIED = 4
"""How many shapes are tried for each that is wanted: these data may not show one."""

_PRIMES = (2, 3, 5, 7)
"""Bases of the sequences of numbers from which the shape parameters are drawn."""

_SEEN = 1e-6
"""Share of the largest column of an effect below which a column is not there."""

_AXES = ("angle", "speed", "temperature", "load", "clock")
"""Columns of the table on which the form depends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantedTorque:
    """An effect of one shape, at a size of 1.

    Attributes
    ----------
    effect : Effect
        The effect.
    shape : dict of str to float
        Its shape.
    coefficients : ndarray, shape (coefficients,)
        Its coefficients where its RMS in its channel is 1. [unit of the channel]
    columns : Basis
        Its columns.
    torque : Basis
        Its torque with an error of form, RMS of 1 in its channel, shape (rows, 1) each.
    """

    effect: Effect
    shape: dict[str, float]
    coefficients: Array
    columns: Basis
    torque: Basis


def planted_torques(
    problem: Problem, effect: Effect, forms: Sequence[Array], least_size: float
) -> list[PlantedTorque]:
    """Return an effect in different shapes; fewer than asked for where these data show few.

    Shapes and signs are drawn evenly from what the catalogue allows. A change is permanent and
    takes place in the middle of the log.

    Parameters
    ----------
    problem : Problem
        The joint's rows.
    effect : Effect
        The effect.
    forms : sequence of ndarray, shape (rows,)
        An error of form for each of them.
    least_size : float
        Size that is physically possible in each shape that is returned. [unit of its channel]
    """
    found: list[PlantedTorque] = []
    for number, shape in enumerate(_shapes(problem, effect, len(forms))):
        generator = np.random.default_rng(number)
        one = _planted(problem, effect, shape, generator, forms[len(found)], least_size)
        if one is not None:
            found.append(one)
        if len(found) == len(forms):
            break
    return found


def error_forms(problem: Problem, count: int) -> list[Array]:
    """Return smooth functions of what a joint's state is, different ones, shape (rows,) each.

    Parameters
    ----------
    problem : Problem
        The joint's rows.
    count : int
        How many.
    """
    generator = np.random.default_rng(0)
    forms = [np.zeros(len(problem.rows)) for _ in range(count)]
    for name in _AXES:
        values = getattr(problem.table, name)
        low, width = float(np.min(values)), float(np.ptp(values))
        if not (np.isfinite(width) and width > 0):
            continue
        angle = np.pi * (values - low) / width
        for form in forms:
            for order in (1, 2):
                wave, phase = generator.standard_normal(), generator.uniform(0, 2 * np.pi)
                form += wave / order * np.cos(order * angle + phase)
    return forms


def _shapes(problem: Problem, effect: Effect, count: int) -> Iterator[dict[str, float]]:
    """Yield shapes between the bounds of the catalogue, evenly."""
    if effect.moments is not None:
        clock, share = problem.table.clock, measured_share(problem.all_runs)[problem.rows]
        first, last = float(np.min(clock)), float(np.max(clock))
        for place in (np.arange(count) + 0.5) / count:
            wanted = _CHANGE[0] + place * (_CHANGE[1] - _CHANGE[0])
            later = clock >= first + wanted * (last - first)
            yield {"moment": float(np.min(share[later])), "end": 1.0}
        return
    axes = effect.shape
    if not axes:
        yield from ({} for _ in range(count))
        return
    for number in range(1, _TRIED * count + 1):
        yield {
            axis.name: axis.at(_mirrored(number, base))
            for axis, base in zip(axes, _PRIMES, strict=False)
        }


def _mirrored(number: int, base: int) -> float:
    """Return the digits of a number behind the point: those of 1, 2, 3... fill 0 to 1 evenly [1]_.

    Examples
    --------
    >>> [_mirrored(number, 2) for number in (1, 2, 3, 4)]
    [0.5, 0.25, 0.75, 0.125]

    References
    ----------
    .. [1] J. H. Halton, "On the efficiency of certain quasi-random sequences of points in
       evaluating multi-dimensional integrals," Numer. Math. 2, 1960, doi:10.1007/BF01386213.
    """
    value, unit = 0.0, 1.0
    while number:
        number, digit = divmod(number, base)
        unit /= base
        value += digit * unit
    return value


def _planted(
    problem: Problem,
    effect: Effect,
    shape: dict[str, float],
    generator: np.random.Generator,
    form: Array,
    least_size: float,
) -> PlantedTorque | None:
    """Return an effect of one shape; None where these data do not show it in the least size."""
    columns = problem.basis(effect, shape)
    main = _rms(main_channel(columns, effect))
    seen = main > _SEEN * main.max(initial=0.0)
    if not seen.any():
        return None
    lower, upper = physical_bounds(effect, problem)
    drawn = np.where(seen, generator.standard_normal(len(main)) / np.where(seen, main, 1.0), 0.0)
    drawn = np.where(lower >= 0, np.abs(drawn), np.where(upper <= 0, -np.abs(drawn), drawn))
    for number, most in _within(effect).items():
        drawn[number] = generator.uniform(-1.0, 1.0) * abs(drawn[most])
    form = form[:, np.newaxis]
    whole = Basis(*(one @ drawn[:, np.newaxis] for one in columns))
    missed = _FORM * float(_rms(main_channel(whole, effect))[0])
    errors = main_channel(Basis(*(form * one for one in whole)), effect)
    scale = missed / max(float(_rms(errors)[0]), 1e-300)
    torque = Basis(*((1 + scale * form) * one for one in whole))
    size = float(_rms(main_channel(torque, effect))[0])
    least = least_size / size * drawn
    if np.any((least < lower) | (least > upper)):
        return None
    return PlantedTorque(
        effect=effect,
        shape=shape,
        coefficients=drawn / size,
        columns=columns,
        torque=Basis(*(one / size for one in torque)),
    )


def _within(effect: Effect) -> dict[int, int]:
    """Return the coefficients that are no larger than another one, by number, and that one."""
    names = [one.name for one in effect.coefficients]
    return {
        number: names.index(one.within)
        for number, one in enumerate(effect.coefficients)
        if one.within
    }


def _rms(columns: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(np.square(columns), axis=0)))
