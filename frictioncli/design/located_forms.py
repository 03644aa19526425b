r"""What rows tell of structure that a form describes: its size, its place, and what changes it.

A form is a law of one quantity or two. What it is shows by where it stays and by what it changes
with: damage at one angle stays there at all speeds, a resonance at its speed in a warm joint, and
what the load does grows with the load. Beside the base the torque therefore gets columns of the
form *f*, of its derivatives by its shape parameters, and of *f* and of the derivative by its place
times every quantity on which it does not depend. In units in which each coefficient has variance 1
beforehand, rows with the information *M* on base, causes and these columns tell

.. math:: \tfrac{1}{2} \ln \frac{\det (M + P)}{\det (M_b + P_b)}

nats about them, with the precision *P* beforehand and the part :math:`M_b` of base and causes
(Bayesian D-optimality [1]_).

References
----------
.. [1] K. Chaloner and I. Verdinelli, "Bayesian experimental design: a review," Stat. Sci. 10(3),
   1995, doi:10.1214/ss/1177009939.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.empirical.form import ShapeAxis
from frictioncli.diagnosis.empirical.forms import forms_of
from frictioncli.diagnosis.empirical.term import INPUTS, FormFunction, in_coordinates
from frictioncli.diagnosis.noise.cosine_series import Range, coordinate
from frictioncli.effects.base import Basis, EffectTable


def form_basis(
    forms: Sequence[FormFunction], table: EffectTable, ranges: Mapping[str, Range]
) -> Basis:
    """Return the columns that tell what forms are, shape (rows, columns) per channel [N·m].

    Parameters
    ----------
    forms : sequence of FormFunction
        The forms.
    table : EffectTable
        The rows.
    ranges : mapping of str to (float, float)
        Ranges of the quantities in which the forms were found.
    """
    parts = [part for form in forms for part in _of_form(form, table, ranges)]
    return Basis(
        np.column_stack([one.friction for one in parts]),
        np.column_stack([one.load for one in parts]),
    )


def _of_form(form: FormFunction, table: EffectTable, ranges: Mapping[str, Range]) -> list[Basis]:
    torque = form.at(table)
    known = forms_of({axis: ends for axis, ends in ranges.items() if ends[0] < ends[1]})
    alike = [one for one in known if (one.kind, one.axes) == (form.kind, form.axes)]
    shape = alike[0].shape if alike else ()
    derivatives = {
        axis.name: _difference(form, table, axis) for axis in shape if axis.name != "order"
    }
    changed = [torque, *(derivatives[name] for name in ("centre",) if name in derivatives)]
    others = [
        axis for axis in INPUTS if axis not in form.axes and ranges[axis][0] < ranges[axis][1]
    ]
    return [
        torque,
        *derivatives.values(),
        *(_times(one, _unit(axis, table, ranges)) for one in changed for axis in others),
    ]


def _difference(form: FormFunction, table: EffectTable, axis: ShapeAxis) -> Basis:
    """Return what a step of the search's grid in one shape parameter changes."""
    value = form.shape[axis.name]
    count = max(len(axis.values) - 1, 1)
    if axis.logarithmic:
        factor = float(np.log(axis.values[-1] / axis.values[0])) / count
        ends = [value * np.exp(way * factor / 2) for way in (-1, 1)]
    else:
        step = (axis.values[-1] - axis.values[0]) / count
        ends = [value + way * step / 2 for way in (-1, 1)]
    low, high = (
        replace(form, shape={**form.shape, axis.name: float(end)}).at(table) for end in ends
    )
    return Basis(high.friction - low.friction, high.load - low.load)


def _times(torque: Basis, factor: Array) -> Basis:
    return Basis(torque.friction * factor, torque.load * factor)


def _unit(axis: str, table: EffectTable, ranges: Mapping[str, Range]) -> Array:
    """Return a quantity from -1 to 1 over its range, the speed by its logarithm."""
    low, high = in_coordinates(ranges)[axis]
    values = np.abs(table.load) if axis == "load" else coordinate(axis, table)
    return np.asarray(2 * (values - low) / (high - low) - 1)
