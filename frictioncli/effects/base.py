"""Record of an effect in the catalogue, and the table on which effects are evaluated.

An effect adds a linear combination of the columns of its basis to the friction or the load torque.
Shape parameters change the columns; coefficients multiply them.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.effects.parameter import Parameter

Channel = Literal["friction", "load"]
CHANNELS: tuple[Channel, Channel] = ("friction", "load")

Kind = Literal["friction", "load", "measurement"]

_Found = TypeVar("_Found")

REFERENCE_TEMPERATURE = 25.0
"""Reference temperature of effects. [°C]"""


@dataclass(frozen=True, slots=True)
class Signature:
    """What the residuals show where the effect is present.

    Attributes
    ----------
    axis : str
        Column of :class:`EffectTable` against which residuals are drawn.
    claim : str
        What is seen, in one sentence.
    """

    axis: str
    claim: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectTable:
    """Angle bins of the pairs of one joint, ordered by run and time, with the fitted base model.

    Attributes
    ----------
    run : ndarray of int, shape (rows,)
        Number of the run; rows of a run stand together.
    pair : ndarray of int, shape (rows,)
        Number of the pair over all runs, growing; rows of a pair stand together.
    time : ndarray, shape (rows,)
        Middle of the pair since the run's first sample. [s]
    clock : ndarray, shape (rows,)
        Time on one clock for all runs, which follow each other without a pause. [s]
    speed, position : ndarray, shape (rows,)
        Speed of the pair and centre of the angle bin. [deg/s], [deg]
    angle : ndarray, shape (rows,)
        Angle at which the logged torque acted: the position, unless the torque is late. [deg]
    load : ndarray, shape (rows,)
        Load torque of the base model at that angle. [N·m]
    load_gradient, load_curvature : ndarray, shape (rows,)
        First and second derivative of the fitted gravity by the angle; the first with the opposite
        sign where the log counts torque the other way than motion. [N·m/deg], [N·m/deg²]
    temperature, measured_temperature : ndarray, shape (rows,)
        Temperature input of the base model, perhaps the hidden one of the gear; as measured. [°C]
    motor_temperature, housing_temperature : ndarray, shape (rows,)
        As measured; NaN where unknown. [°C]
    friction : ndarray, shape (rows,)
        Friction of the base model. [N·m]
    viscous : ndarray, shape (rows,)
        Its viscous coefficient beta + gamma exp(-delta T). [N·m/(deg/s)^0.5]
    temperature_slope : ndarray, shape (rows,)
        Its derivative by temperature at fixed speed, <= 0. [N·m/°C]
    load_slope : ndarray, shape (rows,)
        Its derivative by load torque. [1]
    friction_power : ndarray, shape (rows,)
        Measured friction torque times speed, relative to a reference power. [-]
    moved, warmed_to : ndarray, shape (rows,)
        Estimates of the time of unrecorded motion since the pair before [s], and of the motor
        temperature at its end, after which the joint stands [°C].
    travel : ndarray, shape (rows,)
        Distance travelled in the run before the pair; that of unrecorded moves is estimated. [deg]
    rest, order : ndarray, shape (rows,)
        Rest before the measuring series of the pair [s], and its number in that from 0. [-]
    """

    run: Indices
    pair: Indices
    time: Array
    clock: Array
    speed: Array
    position: Array
    angle: Array
    load: Array
    load_gradient: Array
    load_curvature: Array
    temperature: Array
    measured_temperature: Array
    motor_temperature: Array
    housing_temperature: Array
    friction: Array
    viscous: Array
    temperature_slope: Array
    load_slope: Array
    friction_power: Array
    moved: Array
    warmed_to: Array
    travel: Array
    rest: Array
    order: Array
    _found: dict[Callable[["EffectTable"], Any], Any] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @property
    def angles(self) -> Array:
        """Centres of the angle bins, each once, in order. [deg]."""
        return self.once(_angles)

    def once(self, function: Callable[["EffectTable"], _Found]) -> _Found:
        """Return what a function makes of the table, worked out when it is first asked for.

        Parameters
        ----------
        function : callable
            A function of a module or a class, of the table alone.
        """
        if function not in self._found:
            self._found[function] = function(self)
        found: _Found = self._found[function]
        return found


class Basis(NamedTuple):
    """Columns that the coefficients of an effect multiply.

    Attributes
    ----------
    friction, load : ndarray, shape (rows, coefficients)
        Columns in both channels; zeros in a channel that the effect does not change. [N·m per unit
        of the coefficient]
    """

    friction: Array
    load: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """A cause of model error, linear in its coefficients, with a few bounded shape parameters.

    A basis may depend on the whole table (its start, its mean speed, its angle range). Training and
    hold-out rows are therefore taken from one basis of all runs.

    Attributes
    ----------
    name : str
        Name in commands and documents.
    summary : str
        The cause in a short sentence.
    equation : str
        What it adds to the torque, in symbols.
    source : str
        Reference.
    channel : {"friction", "load"}
        Channel where it shows most.
    shape : tuple of Parameter
        Nonlinear parameters; searched between their bounds.
    coefficients : tuple of Parameter
        Linear parameters; a fit beyond their bounds is rejected as unphysical.
    basis : callable
        ``basis(table, **shape) -> Basis``.
    measurement : bool
        Whether it is a property of the measurement and not of the joint: what it explains is
        corrected, and no friction cause may explain it instead.
    recurs : bool
        Whether it comes back by itself, as after every rest: a run that lacks it contradicts it,
        where another effect may have gone.
    moments : callable or None
        For an effect that comes and goes: the histories to try, from the table
        (:mod:`frictioncli.effects.history`). Such a shape may have further stretches; the columns
        are the same wherever it is there, and zero elsewhere.
    orders : callable or None
        For an effect whose columns are sines and cosines of multiples of the angle, in turn: these
        multiples, from the shape. [1/turn]
    needs : tuple of str
        Columns of the table that must be known and vary for the effect to be tested.
    uses : tuple of str
        Further columns that the basis reads, beside ``run`` and ``pair``; they may be constant.
    signature : Signature
        What the residuals show.
    confounders : tuple of str
        Names of the effects with which it is most easily confused.
    experiment : str
        The experiment that isolates it from them.
    mirror : str
        What must hold in the other channel; may be empty.
    statement : str
        What is said where it is found: a sentence with names of its parameters in braces, which
        stand for their values. Where it is empty, the summary is said.
    """

    name: str
    summary: str
    equation: str
    source: str
    channel: Channel
    shape: tuple[Parameter, ...]
    coefficients: tuple[Parameter, ...]
    basis: Callable[..., Basis]
    needs: tuple[str, ...]
    signature: Signature
    confounders: tuple[str, ...]
    experiment: str
    mirror: str = ""
    statement: str = ""
    uses: tuple[str, ...] = ()
    measurement: bool = False
    recurs: bool = False
    moments: Callable[[EffectTable], list[dict[str, float]]] | None = None
    orders: Callable[..., tuple[float, ...]] | None = None

    @property
    def kind(self) -> Kind:
        """What the effect is a property of: the joint's friction, its load, or the measurement."""
        return "measurement" if self.measurement else self.channel

    def shapes(self, table: EffectTable) -> list[dict[str, float]]:
        """Return the shapes to try: the grid of the shape parameters, or histories of a table."""
        if self.moments is not None:
            return self.moments(table)
        axes = [[(axis.name, float(value)) for value in axis.grid()] for axis in self.shape]
        return [dict(values) for values in product(*axes)]

    def has_shape(self, names: Iterable[str]) -> bool:
        """Return whether names are those of its shape parameters.

        A history may have further stretches, as ``moment_2`` and ``end_2``.

        Parameters
        ----------
        names : iterable of str
            Names of shape parameters.
        """
        given, known = set(names), {axis.name for axis in self.shape}
        if self.moments is not None:
            numbers = range(2, len(given) // len(known) + 1)
            known |= {f"{name}_{number}" for number in numbers for name in known}
        return given == known

    def evaluate(self, table: EffectTable, shape: Mapping[str, float]) -> Basis:
        """Return the basis for given values of the shape parameters."""
        return self.basis(table, **shape)


def friction_only(*columns: Array) -> Basis:
    """Return a basis of columns in friction, shape (rows,) each, and zeros in load."""
    stacked = np.column_stack(columns)
    return Basis(stacked, np.zeros_like(stacked))


def load_only(*columns: Array) -> Basis:
    """Return a basis of columns in load, shape (rows,) each, and zeros in friction."""
    stacked = np.column_stack(columns)
    return Basis(np.zeros_like(stacked), stacked)


def missing_columns(effect: Effect, table: EffectTable) -> tuple[str, ...]:
    """Return the columns that an effect needs and a table lacks.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    table : EffectTable
        Pairs and angle bins.

    Returns
    -------
    tuple of str
        Needed columns that are constant or not known in every row; empty where none is.
    """
    return tuple(name for name in effect.needs if not _varies(getattr(table, name)))


def applicable(effects: Iterable[Effect], table: EffectTable) -> tuple[Effect, ...]:
    """Return the effects whose needed columns a table has, in the same order.

    Parameters
    ----------
    effects : iterable of Effect
        The catalogue.
    table : EffectTable
        Pairs and angle bins.
    """
    return tuple(effect for effect in effects if not missing_columns(effect, table))


def _angles(table: EffectTable) -> Array:
    """Return the centres of the angle bins, each once, in order. [deg]."""
    return np.unique(table.position)


def _varies(column: np.ndarray) -> bool:
    """Return whether a column is known in every row and not constant."""
    return bool(len(column) and np.all(np.isfinite(column)) and np.ptp(column) > 0)
