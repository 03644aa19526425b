"""A gear whose hidden temperature, not the motor's, sets the friction."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from scipy.signal import lfilter

from frictioncli.arrays import Array
from frictioncli.simulator.planted.effect import PlantedEffect, log_uniform
from frictioncli.simulator.planted.journey import GRID, Journey
from frictioncli.simulator.planted.state import Extra, State


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalLag(PlantedEffect):
    r"""Friction at a hidden gear temperature in place of the temperatures that the joint has.

    Attributes
    ----------
    magnitude : float
        Time constant tau of conduction from the motor. [min]
    heating : float
        Warming of the gear by the power dissipated in the joint, which is a share of it over the
        gear's heat capacity; 0: the gear only lags. [K/kJ]
    loss : float
        Time constant of the gear's own loss to ambient. [min]

    Notes
    -----
    .. math:: \dot T_g = (T_m - T_g)/\tau - (T_g - T_a)/\tau_a + k P, \quad f(T_g) - f(T_m)

    Every temperature of the friction law is shifted by the difference of gear and motor. Ranges:
    heating 0 or 0.08 to 0.22 K/kJ with equal probability, own loss 600 to 3000 min. A heated gear
    is warmer than the motor while heating, so the loop between heating and cooling has the other
    sign. A textbook column has one time constant and no heat. What other effects dissipate does not
    heat the gear.
    """

    name: ClassVar[str] = "thermal_lag"
    equation: ClassVar[str] = (
        "f(Tgear) - f(Tmotor), dTgear/dt = (Tmotor - Tgear) / tau - (Tgear - Tambient) / ta + k P"
    )

    heating: float
    loss: float

    @classmethod
    def draw(cls, generator: np.random.Generator) -> Self:
        """Return the effect with random shape parameters."""
        return cls(
            heating=float(generator.integers(2)) * log_uniform(generator, 0.08, 0.22),
            loss=log_uniform(generator, 600.0, 3000.0),
        )

    def torque(self, state: State) -> Extra:
        """Return the torque that the effect adds [N·m]."""
        shift = state.journey.on_grid(self.difference(state.journey), state.time)
        shifted = {name: value + shift for name, value in state.temperatures.items()}
        joint, speed = state.joint, state.speed
        hidden = joint.friction(load=state.load, speed=speed, temperatures=shifted)
        shown = joint.friction(load=state.load, speed=speed, temperatures=state.temperatures)
        return Extra(friction=hidden - shown)

    def difference(self, journey: Journey) -> Array:
        """Return gear minus motor temperature on the journey's grid [K]."""
        motor = journey.temperatures.get("motor", journey.temperatures["motor sensor"])
        inward, outward = 1.0 / (60.0 * self.magnitude), 1.0 / (60.0 * self.loss)
        heating = self.heating / 1000.0
        rate = inward + outward
        target = (inward * motor + outward * journey.ambient + heating * journey.heat) / rate
        memory = np.exp(-rate * GRID)
        # The grid's last step is shorter; the gear hardly moves in it.
        driven = (1.0 - memory) * (target[1:] + target[:-1]) / 2.0
        rest, _ = lfilter([1.0], [1.0, -memory], driven, zi=[memory * motor[0]])
        return np.concatenate([[motor[0]], rest]) - motor
