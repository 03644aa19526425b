r"""Friction and load channel of one joint with the simulation of its torque.

The simulated torque along the measured motion is the fitted friction (16) plus the fitted gravity
(:mod:`frictioncli.diagnosis.data.gravity`),

.. math:: u = \sigma \tau(L_g, \dot q, T) + L_g(q, m)

with the direction :math:`\sigma` of the motion. Its misfit has an even part in the direction, the
friction channel, and an odd part, the load channel. The base model takes the fitted gravity as its
load, so that a disturbance of the load channel cannot enter :math:`\alpha L^2`.

Once a hidden temperature :math:`T + E` of the gear has been estimated, friction and its derivatives
are those at that temperature, and the simulation without effects is carried back along the slope,
:math:`\tau(T + E) - E\,\partial\tau/\partial T`. Coefficients of the effect ``thermal_lag`` then
still count from the measured temperature *T*, and a model linear in them is exact to first order
about the hidden one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.diagnosis.data.gravity import GravityForm
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.data.late_torque import EarlierTables, LateTorque, late_basis
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.effects.base import Basis, Effect, EffectTable
from frictioncli.effects.history import LASTING, present
from frictioncli.effects.pair_series import measured_share, rows_of
from frictioncli.model.friction import FrictionParameters


@dataclass(frozen=True, slots=True)
class Misfit:
    """Mean misfit of the simulated torque in one range of an axis at one speed.

    Attributes
    ----------
    channel : {"friction", "load"}
        The channel.
    axis : {"temperature", "angle"}
        The axis.
    low, high : float
        The range. [°C] or [deg]
    speed : float
        Speed of the pairs. [deg/s]
    misfit : float
        Mean of measured minus simulated torque there. [N·m]
    phase : {"heat-up", "cool-down", ""}
        Whether the temperature rises or falls there; empty where it is steady or unknown.
    """

    channel: str
    axis: str
    low: float
    high: float
    speed: float
    misfit: float
    phase: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One joint's measurements and base model, rows by run, time and angle.

    Attributes
    ----------
    table : EffectTable
        The rows, with the base model.
    all_runs : EffectTable
        The rows of all runs; an effect with memory is evaluated on them.
    rows : ndarray of int, shape (rows,)
        Which of those rows the problem has.
    layout : PairLayout
        Division of the rows into pairs.
    friction, load : ndarray, shape (rows,)
        Measured friction and load torque. [N·m]
    friction_base, load_base : ndarray, shape (rows, parameters)
        Derivatives of the simulated friction by its parameters, and of the simulated load by the
        coefficients of gravity.
    names : tuple of str
        Friction parameters that the columns of ``friction_base`` belong to.
    parameters : FrictionParameters
        Parameters of friction, fitted to these data.
    gravity : ndarray, shape (coefficients,)
        Coefficients of cos q, sin q and 1, of the first two per mass of the payload where two
        payloads are known, and of the first two in further poses of the other joints: those of the
        columns of ``load_base``. [N·m], [N·m/kg]
    gravity_form : GravityForm
        What the gravity depends on.
    reference_power : float
        Power to which the friction power of the table is referred. [N·m·deg/s]
    has_load_channel : bool
        Whether the log has a load channel; the base model takes the load from it.
    temperature_error : float
        Standard error of the motor temperature. [°C]
    runs : tuple of str
        Names of the runs, in order.
    hidden : HiddenTemperature or None
        Temperature of the gear about which friction is linear; none where that is the measured one.
    counted : float
        Sign convention of the torques: +1 where forward is load plus friction, else -1.
    late : LateTorque or None
        Response behind which the torque was logged; none where it is not known to be late.
    doubt : str
        Why no cause but those of the measurement can have a name; empty where some can.
    """

    table: EffectTable
    all_runs: EffectTable
    rows: Indices
    layout: PairLayout
    friction: Array
    load: Array
    friction_base: Array
    load_base: Array
    names: tuple[str, ...]
    parameters: FrictionParameters
    gravity: Array
    gravity_form: GravityForm
    reference_power: float
    has_load_channel: bool
    temperature_error: float
    runs: tuple[str, ...]
    hidden: HiddenTemperature | None = None
    counted: float = 1.0
    late: LateTorque | None = None
    doubt: str = ""
    _earlier: EarlierTables = field(default_factory=EarlierTables, init=False, repr=False)
    _lasting: dict[int, tuple[Effect, Array, Basis]] = field(
        default_factory=dict, init=False, repr=False
    )

    def basis(self, effect: Effect, shape: Mapping[str, float]) -> Basis:
        """Return an effect's columns as the log shows them, evaluated on all runs."""
        if effect.moments is None:
            return self._evaluated(effect, shape)
        # a change has the same columns wherever it is there
        if id(effect) not in self._lasting:
            share = measured_share(self.all_runs)[self.rows]
            self._lasting[id(effect)] = effect, share, self._evaluated(effect, LASTING)
        _, share, lasting = self._lasting[id(effect)]
        there = present(share, shape)[:, np.newaxis]
        return Basis(there * lasting.friction, there * lasting.load)

    def _evaluated(self, effect: Effect, shape: Mapping[str, float]) -> Basis:
        """Return an effect's columns, evaluated for its shape."""
        if self.late is None or effect.measurement:
            friction, load = effect.evaluate(self.all_runs, shape)
            return Basis(friction[self._taken], load[self._taken])
        return late_basis(
            effect,
            self.all_runs,
            shape,
            self.late,
            rows=self._taken,
            counted=self.counted,
            alpha=self.parameters.alpha,
            separate_load=self.has_load_channel,
            known=self._earlier,
        )

    @property
    def _taken(self) -> slice | Indices:
        """The rows, as a slice where they stand together: what is taken is not copied then."""
        first, count = (int(self.rows[0]), len(self.rows)) if len(self.rows) else (0, 0)
        together = count and int(self.rows[-1]) == first + count - 1
        return slice(first, first + count) if together else self.rows

    @property
    def run_names(self) -> dict[int, str]:
        """Name of each run by its number in the table."""
        return dict(zip(np.unique(self.layout.run).tolist(), self.runs, strict=True))

    @property
    def temperature_variance(self) -> Array:
        """Variance of pair means from the error of the temperature, shape (pairs,). [(N·m)²]."""
        slope = self.layout.means(self.table.temperature_slope[:, np.newaxis])[:, 0]
        return np.square(self.temperature_error * slope)

    @property
    def friction_by_gravity(self) -> Array:
        """Derivatives of the friction torque by the coefficients of gravity, as of ``load_base``.

        Friction depends on the square of the load: without these columns a cause that changes the
        fitted gravity would show a second time, in friction.
        """
        if self.has_load_channel:
            return np.zeros_like(self.load_base)
        slope = 2 * self.parameters.alpha * self.table.load
        return slope[:, np.newaxis] * self.load_base

    def squared(self, friction: Array, load: Array) -> Array:
        """Return the squared misfit of the simulated torque, shape (rows,). [(N·m)²].

        The misfit is load plus friction forward and load minus friction in reverse; the mean square
        of both is the sum of the squares. Where the log has a load channel, which may have another
        unit, the load is not simulated and only friction counts.

        Parameters
        ----------
        friction, load : ndarray, shape (rows,)
            Misfit in both channels. [N·m]
        """
        return np.square(friction) + (0.0 if self.has_load_channel else np.square(load))

    @property
    def friction_misfit(self) -> Array:
        """Measured minus simulated friction torque without effects, shape (rows,) [N·m]."""
        excess = self.table.temperature - self.table.measured_temperature
        return self.friction - self.table.friction + self.table.temperature_slope * excess

    @property
    def load_misfit(self) -> Array:
        """Measured minus simulated load torque, shape (rows,) [N·m]."""
        return self.load - self.load_base @ self.gravity

    def part(self, chosen: Flags) -> "Problem":
        """Return the problem of some runs.

        Parameters
        ----------
        chosen : ndarray of bool, shape (rows,)
            Rows of these runs.
        """
        table = rows_of(self.table, chosen)
        pairs = np.unique(self.layout.row_pair[chosen])
        row_pair = np.searchsorted(pairs, self.layout.row_pair[chosen])
        layout = PairLayout.of(
            row_pair=row_pair,
            run=self.layout.run[pairs],
            time=self.layout.time[pairs],
            speed=table.speed[np.flatnonzero(np.diff(row_pair, prepend=-1))],
            position=table.position,
            noise=self.layout.noise,
            stretch=self.layout.stretch[pairs],
        )
        return replace(
            self,
            table=table,
            rows=self.rows[chosen],
            layout=layout,
            friction=self.friction[chosen],
            load=self.load[chosen],
            friction_base=self.friction_base[chosen],
            load_base=self.load_base[chosen],
            runs=tuple(self.run_names[number] for number in np.unique(layout.run).tolist()),
        )
