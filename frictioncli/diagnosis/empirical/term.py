r"""An empirical term: torque by angle, speed and temperature for which no cause is known.

It is a sum of forms that describe what was found (:mod:`frictioncli.diagnosis.empirical.forms`) and
of series of cosines (:mod:`frictioncli.diagnosis.noise.cosine_series`), less what the base model
takes of both, because its parameters were fitted without them,

.. math::
    r(x) = w(x) \left( \sum_k a_k f_k(x) + \sum_k \gamma_k c_k(x)
    + \frac{\partial u}{\partial p}\, b \right) .

It is valid where the joint was measured: within the ranges of its inputs :math:`w = 1`; beyond an
end it falls smoothly, and a tenth of the range further on it is nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients, stated_gravity
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.form_columns import columns_of
from frictioncli.diagnosis.empirical.forms import forms_of
from frictioncli.diagnosis.noise.cosine_series import AXES, CosineSeries, Range, coordinate
from frictioncli.effects.base import CHANNELS, Basis, EffectTable
from frictioncli.errors import TableError

FADING = 0.1
"""Share of a range within which the term falls to nothing beyond each end."""

INPUTS = ("position", "speed", "temperature", "load")
"""What the term depends on, and has ranges of."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothFunction:
    """A function of one quantity or two, as products of cosines.

    Attributes
    ----------
    axes : tuple of str
        The quantities: ``position``, ``speed``, ``temperature``.
    channel : {"friction", "load"}
        The torque that it adds to.
    orders : tuple of int
        Greatest order of the cosines in each quantity.
    coefficients : tuple of float
        Of the products, the order of the last quantity running fastest. [torque unit]
    """

    axes: tuple[str, ...]
    channel: str
    orders: tuple[int, ...]
    coefficients: tuple[float, ...]

    def values(self, table: EffectTable, ranges: Mapping[str, Range]) -> Array:
        """Return the function at some rows, shape (rows,) [torque unit].

        Parameters
        ----------
        table : EffectTable
            The rows.
        ranges : mapping of str to (float, float)
            Range of each quantity, of the speed that of its logarithm.
        """
        columns = CosineSeries(self.axes, self.orders).columns(table, ranges)
        return np.asarray(columns @ np.array(self.coefficients))


@dataclass(frozen=True, slots=True, kw_only=True)
class FormFunction:
    """A form with its parameters.

    Attributes
    ----------
    kind : str
        The form, one of :mod:`frictioncli.diagnosis.empirical.forms`.
    axes : tuple of str
        What it depends on: ``position``, ``speed``, ``temperature``, amount of the ``load``.
    channel : {"friction", "load"}
        The torque that it adds to.
    shape : mapping of str to float
        Its shape parameters, in the units of these quantities.
    coefficients : mapping of str to float
        Its coefficients, in the order of its columns. [torque unit]
    formula : str
        Its formula: q in deg, v in deg/s, T in °C, L in N·m.
    since : str
        The run from which on it is there; empty where it always is.
    sign : float
        Sign convention of the torques: +1 where forward is load plus friction, else -1.
    """

    kind: str
    axes: tuple[str, ...]
    channel: str
    shape: Mapping[str, float]
    coefficients: Mapping[str, float]
    formula: str
    since: str = ""
    sign: float = 1.0

    def at(self, table: EffectTable) -> Basis:
        """Return the form in both channels at some rows, shape (rows,) each [torque unit].

        Parameters
        ----------
        table : EffectTable
            The rows.
        """
        columns = columns_of(self.kind, self.axes, self.channel, table, self.shape, self.sign)
        coefficients = np.array(list(self.coefficients.values()))
        return Basis(columns.friction @ coefficients, columns.load @ coefficients)

    def check(self) -> None:
        """Raise what makes it no form.

        Raises
        ------
        TableError
            If there is no such form, or not with these parameters.
        """
        ranges = dict.fromkeys(self.axes, (1.0, 2.0))
        known = {}
        if set(self.axes) <= set(INPUTS):
            known = {(one.kind, one.axes, one.channel): one for one in forms_of(ranges)}
        form = known.get((self.kind, self.axes, self.channel))
        if form is None:
            raise TableError(f"empirical: unknown form {self.kind} of {' and '.join(self.axes)}")
        if set(self.shape) != {axis.name for axis in form.shape}:
            raise TableError(f"empirical: {self.kind} has the shape {sorted(self.shape)}")
        if tuple(self.coefficients) != form.coefficients:
            raise TableError(f"empirical: {self.kind} has not {form.coefficients}")


@dataclass(frozen=True, slots=True, kw_only=True)
class EmpiricalTerm:
    """Torque without a known cause, with the ranges in which it is valid.

    Attributes
    ----------
    forms : tuple of FormFunction
        Forms that describe what was found, if any does.
    functions : tuple of SmoothFunction
        What it consists of besides.
    ranges : mapping of str to (float, float)
        Least and greatest angle ``position`` [deg], ``speed`` [deg/s], ``temperature`` at which
        friction is evaluated [°C] and amount of the ``load`` [N·m] that were measured.
    base_changes : mapping of str to float
        What it adds to the base's parameters of friction, in their units.
    gravity_changes : GravityCoefficients
        What it adds to gravity.
    """

    forms: tuple[FormFunction, ...] = ()
    functions: tuple[SmoothFunction, ...]
    ranges: Mapping[str, Range]
    base_changes: Mapping[str, float]
    gravity_changes: GravityCoefficients

    def check(self) -> None:
        """Raise what makes the term no function of its inputs.

        Raises
        ------
        TableError
            If ranges, orders and coefficients do not belong together.
        """
        for axis in INPUTS:
            low, high = self.ranges.get(axis, (1.0, 0.0))
            if not low <= high or (axis == "speed" and low <= 0):
                raise TableError(f"empirical: expected a range of {axis} from low to high")
        for form in self.forms:
            form.check()
        for one in self.functions:
            if not set(one.axes) <= {axis for axis in AXES if np.ptp(self.ranges[axis]) > 0}:
                raise TableError(f"empirical: function of {one.axes}, expected some of {AXES}")
            if one.channel not in CHANNELS:
                raise TableError(f"empirical: channel {one.channel!r}, expected one of {CHANNELS}")
            orders = len(one.axes) == len(one.orders)
            if not orders or np.prod(one.orders) != len(one.coefficients):
                raise TableError(
                    f"empirical: {len(one.coefficients)} coefficients of {' and '.join(one.axes)},"
                    f" expected one for each product of the orders {one.orders}"
                )

    def at(self, problem: Problem) -> Basis:
        """Return what the term adds to both channels of a problem's rows, shape (rows,) each.

        Parameters
        ----------
        problem : Problem
            Rows with the base model that the term was fitted beside.

        Returns
        -------
        Basis
            Friction and load torque. [torque unit]
        """
        added = self.functions_at(problem.table)
        changes = np.array([self.base_changes.get(name, 0.0) for name in problem.names])
        gravity = stated_gravity(self.gravity_changes, problem.gravity_form)
        friction = problem.friction_base @ changes + problem.friction_by_gravity @ gravity
        valid = validity(problem.table, self.ranges)
        return Basis(
            valid * (added.friction + friction),
            valid * (added.load + problem.load_base @ gravity),
        )

    def functions_at(self, table: EffectTable) -> Basis:
        """Return the sum of forms and functions alone, shape (rows,) each [torque unit].

        Parameters
        ----------
        table : EffectTable
            The rows.
        """
        within, nothing = in_coordinates(self.ranges), np.zeros_like(table.speed)
        added = {"friction": nothing, "load": nothing}
        for form in self.forms:
            both = form.at(table)
            added = {
                "friction": added["friction"] + both.friction,
                "load": added["load"] + both.load,
            }
        for one in self.functions:
            added[one.channel] = added[one.channel] + one.values(table, within)
        return Basis(added["friction"], added["load"])


def in_coordinates(ranges: Mapping[str, Range]) -> dict[str, Range]:
    """Return ranges as series count them: of the speed that of its logarithm.

    Parameters
    ----------
    ranges : mapping of str to (float, float)
        Ranges in units.
    """
    return {
        axis: (float(np.log(low)), float(np.log(high))) if axis == "speed" else (low, high)
        for axis, (low, high) in ranges.items()
    }


def ranges_seen(table: EffectTable) -> dict[str, Range]:
    """Return the least and greatest value of each input over some rows, in units.

    Parameters
    ----------
    table : EffectTable
        The rows.
    """
    found = {}
    for axis in INPUTS:
        values = getattr(table, axis)
        values = np.abs(values) if axis == "load" else values
        found[axis] = (float(np.min(values)), float(np.max(values)))
    return found


def validity(table: EffectTable, ranges: Mapping[str, Range]) -> Array:
    r"""Return the share of an empirical term that counts, 1 where its inputs were measured.

    Beyond an end the share is :math:`1 - 3 s^2 + 2 s^3`, with the distance *s* from it as a share
    of a tenth of the range.

    Parameters
    ----------
    table : EffectTable
        The rows.
    ranges : mapping of str to (float, float)
        Ranges that were measured.

    Returns
    -------
    ndarray, shape (rows,)
        The share. [1]
    """
    found = np.ones(len(table.speed))
    for axis, (low, high) in in_coordinates(ranges).items():
        values = np.abs(table.load) if axis == "load" else coordinate(axis, table)
        reach = FADING * (high - low) or FADING * max(abs(high), 1.0)
        away = np.clip(np.maximum(low - values, values - high) / reach, 0.0, 1.0)
        found = found * (1 - np.square(away) * (3 - 2 * away))
    return found
