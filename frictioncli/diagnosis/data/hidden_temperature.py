"""The hidden temperature of the gear, about which an extended model with a lag is linear."""

from dataclasses import replace

import msgspec
import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import pair_heads
from frictioncli.effects.thermal_lag import EFFECT, ThermalInputs


class HiddenTemperature(msgspec.Struct, frozen=True, kw_only=True):
    """Parameters of the gear's temperature, as ``extended-model.json`` states them.

    Attributes
    ----------
    time_constant : float
        Time constant of the gear. [s]
    lag_share : float
        Share of the friction at a gear that follows the motor with delay. [1]
    friction_heating : float
        Gear warmer by this after long motion at the reference power. [°C]
    housing_share : float
        Share of the friction at the temperature of the housing. [1]
    housing_lag_share : float
        Share of the friction at a gear that follows the housing with delay. [1]
    housing_time_constant : float or None
        Time constant of a housing that is not measured and follows the motor; none where the
        housing is measured, or no part of the network. [s]
    reference_power : float
        Friction power to which the heating is referred. [torque unit·deg/s]
    """

    time_constant: float
    lag_share: float
    friction_heating: float
    housing_share: float
    housing_lag_share: float
    housing_time_constant: float | None
    reference_power: float

    @classmethod
    def of(
        cls,
        time_constant: float,
        coefficients: Array,
        reference_power: float,
        housing_time_constant: float | None = None,
    ) -> "HiddenTemperature":
        """Return the temperature from coefficients of the effect ``thermal_lag``, in its order."""
        names = (one.name for one in EFFECT.coefficients)
        values = dict(zip(names, map(float, coefficients), strict=True))
        return cls(
            time_constant=time_constant,
            housing_time_constant=housing_time_constant,
            reference_power=reference_power,
            **values,
        )

    @property
    def coefficients(self) -> Array:
        """Coefficients in the order of the effect ``thermal_lag``, shape (4,)."""
        return np.array([getattr(self, one.name) for one in EFFECT.coefficients])

    def inputs(self, table: EffectTable) -> ThermalInputs:
        """Return what drives the gear, with the hidden housing where there is one.

        Parameters
        ----------
        table : EffectTable
            Pairs and angle bins of all runs.
        """
        inputs = table.once(ThermalInputs.of)
        if self.housing_time_constant is None:
            return inputs
        return replace(inputs, housing=None).with_hidden_housing(self.housing_time_constant)

    def applied(self, table: EffectTable) -> EffectTable:
        """Return a table at the temperature of the gear, with the hidden housing as if measured.

        Parameters
        ----------
        table : EffectTable
            Pairs and angle bins of all runs; friction power referred to the same reference.
        """
        inputs, heads = self.inputs(table), pair_heads(table)
        excess = heads.spread(inputs.excess(self.time_constant) @ self.coefficients)
        housing = table.housing_temperature
        if self.housing_time_constant is not None and inputs.housing is not None:
            housing = heads.spread(inputs.housing[inputs.pairs])
        return replace(
            table, temperature=table.measured_temperature + excess, housing_temperature=housing
        )
