"""Functions of which an empirical term consists, over a problem's rows, and the term they make."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.gravity_document import gravity_document
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.fitted_columns import FittedColumns
from frictioncli.diagnosis.empirical.form import Form
from frictioncli.diagnosis.empirical.form_columns import Shape
from frictioncli.diagnosis.empirical.term import (
    EmpiricalTerm,
    FormFunction,
    SmoothFunction,
    in_coordinates,
    ranges_seen,
)
from frictioncli.diagnosis.fit.columns import RANK, base_rows
from frictioncli.diagnosis.noise.cosine_series import CosineSeries
from frictioncli.diagnosis.noise.discrepancy import Component, weight_of
from frictioncli.diagnosis.noise.discrepancy_functions import FINE, FORM, SPEED_RIPPLE
from frictioncli.effects.base import Basis


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """A random function of the discrepancy, or a form, with its columns over a problem's rows.

    Attributes
    ----------
    what : CosineSeries or (Form, Shape)
        Its cosines, or the form with its shape parameters.
    channel : {"friction", "load"}
        The torque that it adds to.
    scale : ndarray, shape (columns,)
        What columns are multiplied by: those of a random function so that coefficients have
        variance 1. [N·m]
    taken : ndarray, shape (parameters, columns)
        What the base takes of the columns of a random function; what base and causes take of those
        of a form, which are fitted beside it.
    columns : ndarray, shape (2 * rows, columns)
        What it leaves of them, friction above load. [N·m]
    """

    what: CosineSeries | tuple[Form, Shape]
    channel: str
    scale: Array
    taken: Array
    columns: Array

    @property
    def axes(self) -> tuple[str, ...]:
        """The quantities that it depends on."""
        return self.what.axes if isinstance(self.what, CosineSeries) else self.what[0].axes

    @property
    def is_form(self) -> bool:
        """Whether it is a form, whose coefficients have no expected size."""
        return not isinstance(self.what, CosineSeries)


def functions_of(
    problem: Problem, components: Sequence[Component], amplitude: Array
) -> list[Function]:
    """Return the functions of a discrepancy over a problem's rows.

    Errors in the form of the friction model are left out: functions of speed and temperature hold
    them, too. So are what is finer along the angle than a smooth function, inertia of a speed that
    is not constant, and a load that is measured, which nobody simulates.

    Parameters
    ----------
    problem : Problem
        The rows.
    components : sequence of Component
        The functions.
    amplitude : ndarray, shape (components,)
        Logarithm of the amplitude of each.
    """
    ranges = in_coordinates(ranges_seen(problem.table))
    base = np.vstack(base_rows(problem))
    length = np.linalg.norm(base, axis=0)
    length = np.where(length > 0, length, 1.0)
    solution = np.linalg.pinv(base / length, rcond=RANK) / length[:, np.newaxis]
    found = []
    for component, size in zip(components, np.exp(amplitude), strict=True):
        if component.axes in (FORM, FINE, SPEED_RIPPLE):
            continue
        if component.channel == "load" and problem.has_load_channel:
            continue
        series = CosineSeries.of(component.axes, problem.table, ranges)
        values = series.weights * series.columns(problem.table, ranges)
        zeros = np.zeros_like(values)
        both = Basis(values, zeros) if component.channel == "friction" else Basis(zeros, values)
        columns = np.vstack(both)
        taken = solution @ columns
        left = columns - base @ taken
        squares = float(np.sum(np.square(left)))
        if squares <= 0:
            continue
        weight = weight_of(component.axes, component.channel)
        scale = size * weight * np.sqrt(len(values) / squares)
        found.append(
            Function(
                what=series,
                channel=component.channel,
                scale=scale * series.weights,
                taken=scale * taken,
                columns=scale * left,
            )
        )
    return found


def function_of_form(fitted: FittedColumns, form: Form, shape: Shape) -> Function:
    """Return a form over a problem's rows, beside base and causes.

    Parameters
    ----------
    fitted : FittedColumns
        Columns of base and causes.
    form : Form
        The form.
    shape : mapping of str to float
        Its shape parameters.
    """
    taken, left = fitted.taken_and_left(form.columns(fitted.problem.table, shape))
    return Function(
        what=(form, shape),
        channel=form.channel,
        scale=np.ones(left.shape[1]),
        taken=taken,
        columns=left,
    )


def term_of(problem: Problem, functions: Sequence[Function], coefficients: Array) -> EmpiricalTerm:
    """Return the term that coefficients of functions make, less what the base takes of them.

    The base stays as it was fitted without the term, to which all returns where the term fades. A
    form may be much larger than what the base leaves of it: a base refitted beside it would be
    wrong where it is not.

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
    forms, smooth = [], []
    taken = np.zeros(len(problem.names) + len(problem.gravity))
    for one, own in zip(functions, np.split(coefficients, ends), strict=True):
        values = (one.scale * own).tolist()
        # of a form the rows beyond are what causes take
        taken += one.taken[: len(taken)] @ own
        if isinstance(one.what, CosineSeries):
            smooth.append(
                SmoothFunction(
                    axes=one.what.axes,
                    channel=one.channel,
                    orders=one.what.orders,
                    coefficients=tuple(values),
                )
            )
            continue
        form, shape = one.what
        forms.append(
            FormFunction(
                kind=form.kind,
                axes=form.axes,
                channel=form.channel,
                shape=dict(shape),
                coefficients=dict(zip(form.coefficients, values, strict=True)),
                formula=form.formula,
                since=problem.run_names[form.since] if form.since else "",
                sign=form.sign,
            )
        )
    friction, gravity = np.split(-taken, [len(problem.names)])
    return EmpiricalTerm(
        forms=tuple(forms),
        functions=tuple(smooth),
        ranges=ranges_seen(problem.table),
        base_changes=dict(zip(problem.names, friction.tolist(), strict=True)),
        gravity_changes=gravity_document(gravity, problem.gravity_form),
    )
