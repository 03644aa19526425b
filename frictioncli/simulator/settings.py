"""What a synthesis is asked for."""

import math
from dataclasses import dataclass

from frictioncli.errors import OptionError


@dataclass(frozen=True, slots=True, kw_only=True)
class SynthesisSettings:
    """What to simulate. Where a field has one value per run, further runs take them in turn.

    Attributes
    ----------
    seed : int
        Seed of all random parts; the same seed gives the same bytes.
    runs : int
        Number of runs, one per day.
    joint : int
        Number of the axis in the traces' channel names.
    sign : int
        +1: torque is load + friction in forward motion; -1: load - friction, as in the paper.
    payload : float
        Mass at the flange. [kg]
    lowest, highest : int
        Motor temperatures between which the thermal cycle runs. [°C]
    ambient : tuple of float
        Ambient temperature at the start of each run. [°C]
    ambient_drift : tuple of float
        Its change during each run. [K/h]
    motor_heat_share : tuple of float
        Share of the dissipated heat that enters at the motor, for each run; the rest enters at gear
        and housing. From about 0.1 down, friction is lower while heating than while cooling. [-]
    noise_scale : float
        Factor on all random parts; 0 gives the bare physics. [-]
    """

    seed: int = 0
    runs: int = 2
    joint: int = 2
    sign: int = 1
    payload: float = 2.0
    lowest: int = 25
    highest: int = 65
    ambient: tuple[float, ...] = (17.9, 16.7)
    ambient_drift: tuple[float, ...] = (-0.21, -0.21)
    motor_heat_share: tuple[float, ...] = (0.62, 0.45)
    noise_scale: float = 1.0

    def check(self) -> None:
        """Raise OptionError for a value that makes no sense."""
        demands = (
            (self.seed >= 0, f"seed is {self.seed}, expected 0 or more"),
            (self.runs >= 1, f"runs is {self.runs}, expected 1 or more"),
            (self.joint >= 1, f"joint is {self.joint}, expected 1 or more"),
            (self.sign in (-1, 1), f"sign is {self.sign}, expected 1 or -1"),
            (self.payload >= 0.0, f"payload is {self.payload} kg, expected 0 or more"),
            (self.noise_scale >= 0.0, f"noise scale is {self.noise_scale}, expected 0 or more"),
            (
                self.lowest < self.highest,
                f"temperatures from {self.lowest} to {self.highest} °C, expected a rise",
            ),
            (
                all(map(math.isfinite, (*self.ambient, *self.ambient_drift))),
                f"ambient is {self.ambient} °C with drift {self.ambient_drift} K/h, "
                "expected numbers",
            ),
            (
                bool(self.ambient and self.ambient_drift and self.motor_heat_share),
                "ambient, its drift and the motor's heat share need one value at least",
            ),
            (
                all(0.0 <= share <= 1.0 for share in self.motor_heat_share),
                f"motor heat share is {self.motor_heat_share}, expected values from 0 to 1",
            ),
        )
        for met, fault in demands:
            if not met:
                raise OptionError(fault)
