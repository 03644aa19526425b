r"""Inner products of forms from the distinct values of their inputs, instead of all rows.

A form of a few inputs has one value *u* for each distinct set of these, and its column is
:math:`E u` with the indicators *E* of the sets. All its weighted inner products follow from those
of the indicators, which are worked out once for all shapes,

.. math:: X^\mathsf{T} V^{-1} X = u^\mathsf{T} (E^\mathsf{T} V^{-1} E) u .
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.diagnosis.empirical.form import Form
from frictioncli.diagnosis.empirical.form_columns import LATE_BUMPS
from frictioncli.diagnosis.fit.weighted_fit import Weights
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import rows_of

_MOST = 0.1
"""Greatest number of distinct inputs per row with which their inner products cost less."""


def input_names(form: Form) -> tuple[str, ...]:
    """Return the columns of a table that a form is worked out from.

    Parameters
    ----------
    form : Form
        The form.
    """
    moved = ("speed",) if form.kind in LATE_BUMPS else ()
    return (*form.axes, *moved, *(("run",) if form.since else ()))


@dataclass(frozen=True, slots=True)
class Inputs:
    """The distinct inputs of some rows.

    Attributes
    ----------
    table : EffectTable
        One row of each.
    number : ndarray of int, shape (rows,)
        The input of each row.
    """

    table: EffectTable
    number: Indices

    @classmethod
    def of(cls, table: EffectTable, names: Sequence[str]) -> "Inputs | None":
        """Return the distinct inputs of rows; None where they are too many to be of use.

        Parameters
        ----------
        table : EffectTable
            The rows.
        names : sequence of str
            Columns of the table.
        """
        number = np.zeros(len(table.speed), np.intp)
        for name in names:
            values, own = np.unique(getattr(table, name), return_inverse=True)
            number = np.unique(number * len(values) + own, return_inverse=True)[1]
        first = np.unique(number, return_index=True)[1]
        if len(first) > _MOST * len(number):
            return None
        return cls(rows_of(table, first), number)

    def weighted(self, weights: Weights) -> Array:
        """Return weighted indicators of which input a row has, shape (weighted rows, inputs).

        Where all rows of a pair have the same one, these are those of the pair means alone, behind
        deviations that are zero.

        Parameters
        ----------
        weights : Weights
            Weights of the channel.
        """
        indicators, row_pair = np.eye(len(self.table.speed)), weights.layout.row_pair
        of_pair = self.number[np.flatnonzero(np.diff(row_pair, prepend=-1))]
        if np.array_equal(of_pair[row_pair], self.number):
            return indicators[of_pair] / weights.deviation[:, np.newaxis]
        return weights.weighted(indicators[self.number])


@dataclass(frozen=True, slots=True)
class InputProducts:
    """Weighted inner products of the indicators of distinct inputs in a channel.

    Attributes
    ----------
    misfit : ndarray, shape (inputs,)
        With the misfit.
    known : ndarray, shape (columns, inputs)
        With orthonormal columns that are known.
    own : ndarray, shape (inputs, inputs)
        With each other.
    """

    misfit: Array
    known: Array
    own: Array

    @classmethod
    def of(cls, weighted: Array, misfit: Array, known: Array) -> "InputProducts":
        """Return the products of weighted indicators.

        Parameters
        ----------
        weighted : ndarray, shape (weighted rows, inputs)
            The weighted indicators.
        misfit, known : ndarray, shape (weighted rows,) and (columns, weighted rows)
            The weighted misfit, and the columns that are known.
        """
        return cls(misfit @ weighted, known @ weighted, weighted.T @ weighted)
