r"""The gear, where friction arises, has another temperature than the motor sensor.

Gear, motor, housing and surroundings are nodes of a thermal network. The gear exchanges heat with
the others and is warmed by the friction power :math:`P` that the log tells:

.. math:: \theta \dot T_g = a T_m + h T_h + (1 - a - h) T_a - T_g + b\,P/P_0

with shares *a*, *h* and *a + h* from 0 to 1 and :math:`b \ge 0`. With the first-order low-pass
filter *F* of time constant :math:`\theta`, the temperature of friction lies

.. math:: E = a (F(T_m) - T) + h (T_h - T) + h_F (F(T_h) - T) + b\,F(P/P_0)

above the measured temperature *T* of the base model, usually that of the motor. The term without
filter is the part of the friction that sits at the housing itself. The remainder, a loss to
surroundings of constant temperature, depends on the motor temperature alone and is absorbed by
gamma and delta of the base model. The losses of the winding warm the motor, whose temperature is
measured. To first order friction differs by :math:`\partial\tau/\partial T` times that excess: at
fixed :math:`\theta` a sum of known columns; :mod:`frictioncli.diagnosis.thermal` estimates the
temperature itself.

With a lag alone friction is higher while heating than while cooling. The hysteresis loop has the
opposite sense where friction warms the gear more than the motor. At the start of each run the gear
is assumed to be in balance: as warm as the motor and the housing, by their shares, and not heated.
"""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.friction_heat import friction_heat
from frictioncli.effects.pair_series import (
    first_order_lag,
    first_order_response,
    pair_heads,
    starts,
)
from frictioncli.effects.parameter import Parameter


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalInputs:
    """What drives the temperature of the gear, at each pair and at each end of unrecorded motion.

    Attributes
    ----------
    pairs : ndarray of int, shape (pairs,)
        Which of the instants are pairs: all but those at which unrecorded motion ends and a rest
        begins.
    time : ndarray, shape (instants,)
        Time of each instant since its run's first sample. [s]
    restart : ndarray of bool, shape (instants,)
        Where a run begins.
    base : ndarray, shape (pairs,)
        The measured temperature that the base model is given. [°C]
    motor : ndarray, shape (instants,)
        Temperature of the motor. [°C]
    housing : ndarray or None, shape (instants,)
        Temperature of the housing; none unless it is known in every pair. [°C]
    power : ndarray, shape (instants - 1,)
        Mean friction power from each instant to the next, relative to the reference power. [-]
    """

    pairs: Indices
    time: Array
    restart: Flags
    base: Array
    motor: Array
    housing: Array | None
    power: Array

    @classmethod
    def of(cls, table: EffectTable) -> "ThermalInputs":
        """Return the inputs of the pairs of a table."""
        heads = pair_heads(table)
        first = heads.first
        time, restart, rest = table.time[first], starts(table.run[first]), table.rest[first]
        stands = ~restart & (table.order[first] == 0) & (table.moved[first] > 0) & (rest > 0)
        after = np.flatnonzero(stands)
        half = (heads.maximum(table.position) - heads.minimum(table.position)) / table.speed[first]
        ended = time[after] - half[after] - rest[after]
        share = (ended - time[after - 1]) / (time[after] - time[after - 1])
        recorded, unrecorded = friction_heat(table, heads)
        heat = (recorded[1:] + recorded[:-1]) / 2 + unrecorded
        heat[after - 1] -= recorded[after] / 2
        heat = np.insert(heat, after, recorded[after] / 2)
        instants, restarts = np.insert(time, after, ended), np.insert(restart, after, False)
        seconds = np.diff(instants)
        known = ~restarts[1:] & (seconds > 0)
        housing = table.housing_temperature[first]
        meanwhile = housing[after - 1] + share * (housing[after] - housing[after - 1])
        return cls(
            pairs=np.arange(len(first)) + np.cumsum(stands),
            time=instants,
            restart=restarts,
            base=table.measured_temperature[first],
            motor=np.insert(table.motor_temperature[first], after, table.warmed_to[first][after]),
            housing=np.insert(housing, after, meanwhile) if np.isfinite(housing).all() else None,
            power=np.divide(heat, seconds, where=known, out=np.zeros_like(heat)),
        )

    def excess(self, time_constant: float) -> Array:
        """Return by how much each part of the network moves the temperature of friction.

        Parameters
        ----------
        time_constant : float
            Time constant of the gear. [s]

        Returns
        -------
        ndarray, shape (pairs, 4)
            Excess over the base temperature per unit of each coefficient: the filtered motor
            temperature, the filtered friction power, the housing, and the filtered housing
            [°C, -, °C, °C]. The last two are zero where the housing is not known.
        """
        motor = self._above_base(self.motor) + self._lag(self.motor, time_constant)[self.pairs]
        heat = first_order_response(
            time=self.time, level=self.power, restart=self.restart, time_constant=time_constant
        )[self.pairs]
        if self.housing is None:
            return np.column_stack([motor, heat, np.zeros_like(heat), np.zeros_like(heat)])
        housing = self._above_base(self.housing)
        lag = self._lag(self.housing, time_constant)[self.pairs]
        return np.column_stack([motor, heat, housing, housing + lag])

    def inputs_themselves(self) -> Array:
        """Return what the filtered parts follow, shape (pairs, 4); 0 for the power. [°C]."""
        nothing = np.zeros_like(self.base)
        housing = nothing if self.housing is None else self._above_base(self.housing)
        return np.column_stack([self._above_base(self.motor), nothing, housing, housing])

    def with_hidden_housing(self, time_constant: float) -> "ThermalInputs":
        """Return the inputs with a housing that follows the motor, where it is not measured.

        Parameters
        ----------
        time_constant : float
            Time constant of the housing. [s]
        """
        if self.housing is not None:
            return self
        return replace(self, housing=self.motor + self._lag(self.motor, time_constant))

    def _above_base(self, temperature: Array) -> Array:
        return temperature[self.pairs] - self.base

    def _lag(self, value: Array, time_constant: float) -> Array:
        return first_order_lag(
            time=self.time, value=value, restart=self.restart, time_constant=time_constant
        )


def basis(table: EffectTable, *, time_constant: float) -> Basis:
    """Return the change of friction by lag, friction heat, housing and filtered housing.

    All columns are torques [N·m], but the second: torque per degree [N·m/°C].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    time_constant : float
        Time constant of the gear. [s]
    """
    inputs = table.once(ThermalInputs.of)
    excess = inputs.excess(time_constant)[pair_heads(table).of_row]
    return friction_only(*(table.temperature_slope * column for column in excess.T))


EFFECT = Effect(
    name="thermal_lag",
    summary="The gear warms and cools at a different rate than the sensor.",
    equation=(
        "dtau = tau(T + E) - tau(T), E = a*(F(Tm) - T) + b*F(P/P0) + h*(Tc - T)"
        " + hF*(F(Tc) - T), F: first-order filter with theta*dF(u)/dt = u - F(u),"
        " P0 = mean friction times 100 deg/s"
    ),
    source=(
        "Lumped heat balance of motor and gear; the loop is figures 5 and 6 of Nevmerzhitskiy"
        " et al. 2019, doi:10.1155/2019/6931563; hidden joint temperature: Simoni et al. 2017,"
        " doi:10.1017/S0263574717000509"
    ),
    channel="friction",
    shape=(
        Parameter(
            name="time_constant",
            symbol="theta",
            unit="s",
            lower=120.0,
            upper=14_400.0,
            description="Time in which the gear closes 63 % of the difference to the motor",
            search="logarithmic",
        ),
    ),
    coefficients=(
        Parameter(
            name="lag_share",
            symbol="a",
            unit="1",
            lower=0.0,
            upper=1.0,
            description="Share of the friction at a gear that follows the motor with delay",
        ),
        Parameter(
            name="friction_heating",
            symbol="b",
            unit="°C",
            lower=0.0,
            upper=60.0,
            description="Gear warmer by this after long motion at 100 deg/s and mean friction",
        ),
        Parameter(
            name="housing_share",
            symbol="h",
            unit="1",
            lower=0.0,
            upper=1.0,
            description="Share of the friction at the temperature of the housing",
        ),
        Parameter(
            name="housing_lag_share",
            symbol="hF",
            unit="1",
            lower=0.0,
            upper=1.0,
            description="Share of the friction at a gear that follows the housing with delay",
        ),
    ),
    basis=basis,
    needs=("time", "motor_temperature", "temperature_slope"),
    uses=(
        *("measured_temperature", "friction_power", "speed", "position", "housing_temperature"),
        *("moved", "warmed_to", "rest", "order"),
    ),
    signature=Signature(
        axis="motor_temperature",
        claim=(
            "At the same motor temperature friction differs between heating and cooling,"
            " more at high speed, and the difference fades at rest."
        ),
    ),
    confounders=("run_in", "drift", "rest_recovery", "coulomb_temperature"),
    experiment=(
        "Add a second cycle of heating and cooling with another heat source: slow moves under"
        " load instead"
        " of fast ones without. Pause during cooling and measure a pair every few minutes."
    ),
    mirror="The load torque must not change with temperature.",
)
