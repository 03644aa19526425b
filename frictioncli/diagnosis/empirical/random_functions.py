"""The random functions of a discrepancy over a problem's rows, and the term they add up to."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.gravity_document import gravity_document
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.term import (
    EmpiricalTerm,
    SmoothFunction,
    in_coordinates,
    ranges_seen,
)
from frictioncli.diagnosis.fit.columns import RANK, base_rows
from frictioncli.diagnosis.noise.cosine_series import CosineSeries
from frictioncli.diagnosis.noise.discrepancy import FORM, Component, weight_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """A random function of the discrepancy with its columns over a problem's rows.

    Attributes
    ----------
    component : Component
        Its axes and its channel.
    series : CosineSeries
        Its cosines.
    scale : ndarray, shape (columns,)
        What they are multiplied by, so that coefficients have variance 1. [N·m]
    by_base : ndarray, shape (base parameters, columns)
        What the base takes of these columns.
    columns : ndarray, shape (2 * rows, columns)
        What it leaves of them, friction above load. [N·m]
    """

    component: Component
    series: CosineSeries
    scale: Array
    by_base: Array
    columns: Array


def functions_of(
    problem: Problem, components: Sequence[Component], amplitude: Array
) -> list[Function]:
    """Return the functions of a discrepancy over a problem's rows.

    Errors in the form of the friction model are left out: functions of speed and temperature hold
    them, too.

    Parameters
    ----------
    problem : Problem
        The rows.
    components : sequence of Component
        The functions.
    amplitude : ndarray, shape (components,)
        Logarithm of the amplitude of each.
    """
    base = np.vstack(base_rows(problem))
    length = np.linalg.norm(base, axis=0)
    length = np.where(length > 0, length, 1.0)
    ranges = in_coordinates(ranges_seen(problem.table))
    found = []
    for component, size in zip(components, np.exp(amplitude), strict=True):
        if component.axes == FORM:
            continue
        series = CosineSeries.of(component.axes, problem.table, ranges)
        values = series.weights * series.columns(problem.table, ranges)
        zeros = np.zeros_like(values)
        columns = np.vstack([values, zeros] if component.channel == "friction" else [zeros, values])
        by_base = np.linalg.lstsq(base / length, columns, rcond=RANK)[0] / length[:, np.newaxis]
        left = columns - base @ by_base
        squares = float(np.sum(np.square(left)))
        if squares <= 0:
            continue
        weight = weight_of(component.axes, component.channel)
        scale = size * weight * np.sqrt(len(values) / squares)
        found.append(
            Function(
                component=component,
                series=series,
                scale=scale * series.weights,
                by_base=scale * by_base,
                columns=scale * left,
            )
        )
    return found


def term_of(problem: Problem, functions: Sequence[Function], coefficients: Array) -> EmpiricalTerm:
    """Return the term that coefficients of functions make.

    Parameters
    ----------
    problem : Problem
        The rows that they were estimated from.
    functions : sequence of Function
        The functions.
    coefficients : ndarray, shape (columns,)
        Their coefficients.
    """
    ends = np.cumsum([len(one.scale) for one in functions])[:-1]
    each = np.split(coefficients, ends)
    taken = np.hstack([one.by_base for one in functions]) @ coefficients
    friction, gravity = np.split(-taken, [len(problem.names)])
    return EmpiricalTerm(
        functions=tuple(
            SmoothFunction(
                axes=one.component.axes,
                channel=one.component.channel,
                orders=one.series.orders,
                coefficients=tuple((one.scale * own).tolist()),
            )
            for one, own in zip(functions, each, strict=True)
        ),
        ranges=ranges_seen(problem.table),
        base_changes=dict(zip(problem.names, friction.tolist(), strict=True)),
        gravity_changes=gravity_document(gravity, problem.gravity_form),
    )
