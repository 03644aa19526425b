"""A form of structure without a name: what varies, how, and in which units."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from frictioncli.diagnosis.empirical.form_columns import BUMP, UNEVEN_BUMP, Shape, columns_of
from frictioncli.effects.base import Basis, EffectTable


@dataclass(frozen=True, slots=True)
class ShapeAxis:
    """A shape parameter of a form.

    Attributes
    ----------
    name, unit : str
        Its name and unit.
    values : tuple of float
        Values that are tried first, ascending; it stays between the ends.
    logarithmic : bool
        Whether steps of it are ratios.
    """

    name: str
    unit: str
    values: tuple[float, ...]
    logarithmic: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Form:
    """A form of structure.

    Attributes
    ----------
    kind : str
        Its name, :data:`BUMP` or one of
        :data:`frictioncli.diagnosis.empirical.form_columns.COLUMNS`.
    axes : tuple of str
        What it depends on.
    channel : {"friction", "load"}
        The torque in which it shows.
    shape : tuple of ShapeAxis
        Its shape parameters.
    coefficients : tuple of str
        Names of the coefficients, all in units of torque.
    formula : str
        The formula.
    since : int
        Number of the run from which on it is there.
    sign : float
        Sign convention of the torques: +1 where forward is load plus friction, else -1.
    """

    kind: str
    axes: tuple[str, ...]
    channel: str
    shape: tuple[ShapeAxis, ...]
    coefficients: tuple[str, ...]
    formula: str
    since: int = 0
    sign: float = 1.0

    @property
    def parameters(self) -> int:
        """Number of all parameters."""
        return len(self.shape) + len(self.coefficients) + (self.since > 0)

    def shapes(self) -> list[dict[str, float]]:
        """Return the shapes that are tried first."""
        names = [one.name for one in self.shape]
        return [
            dict(zip(names, values, strict=True))
            for values in product(*(one.values for one in self.shape))
        ]

    def columns(self, table: EffectTable, shape: Shape) -> Basis:
        """Return the columns of both channels at rows, shape (rows, coefficients) each.

        Parameters
        ----------
        table : EffectTable
            The rows.
        shape : mapping of str to float
            The shape parameters.
        """
        there = (table.run >= self.since)[:, np.newaxis]
        both = columns_of(self.kind, self.axes, self.channel, table, shape, self.sign)
        return Basis(*(there * one for one in both)) if self.since else both


def is_special_case(one: Form, other: Form) -> bool:
    """Return whether a form is another one with some of its parameters zero.

    Parameters
    ----------
    one, other : Form
        The forms.
    """
    kinds = one.kind, other.kind
    if kinds == ("peak", "moving_peak"):
        return set(one.axes) <= set(other.axes)
    # the same in both directions, as friction or as load
    return kinds == (BUMP, UNEVEN_BUMP)
