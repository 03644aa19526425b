"""What a synthesis is asked for."""

import math
from dataclasses import dataclass

from frictioncli.errors import OptionError

JOINT_KINDS = ("zones", "plain")
NOISE_KINDS = (
    "default",
    "white",
    "pair",
    "drift90",
    "drift97",
    "drift99",
    "outliers",
    "heteroscedastic",
)
PROTOCOLS = ("paper", "enriched")


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
        and housing. From about 0.05 down, friction is lower while heating than while cooling. [-]
    noise_scale : float
        Factor on all random parts; 0 gives the bare physics. [-]
    effects : tuple of str
        Effects to hide, each ``NAME`` or ``NAME:SIZE``; SIZE is the root mean square of its torque
        at constant velocity. [N·m]
    blind : bool
        Write the truth beside the folder instead of into it, and do not tell it.
    joint_kind : str
        ``zones``: three friction zones at three temperatures; ``plain``: friction is equation (16)
        of the true motor temperature.
    noise_kind : str
        Kind of the random parts.
    protocol : str
        ``paper``: Algorithms 1 and 2; ``enriched``: speeds in random order, two thermal cycles with
        different entry of heat, three payloads, pauses.
    thin : int
        Log each so many-th sample of the controller only.
    """

    seed: int = 0
    runs: int = 2
    joint: int = 2
    sign: int = 1
    payload: float = 2.0
    lowest: int = 25
    highest: int = 65
    ambient: tuple[float, ...] = (16.0, 16.0)
    ambient_drift: tuple[float, ...] = (-0.10, -0.35)
    motor_heat_share: tuple[float, ...] = (0.52, 0.48)
    noise_scale: float = 1.0
    effects: tuple[str, ...] = ()
    blind: bool = False
    joint_kind: str = "zones"
    noise_kind: str = "default"
    protocol: str = "paper"
    thin: int = 1

    def __post_init__(self) -> None:
        demands = (
            (self.seed >= 0, f"seed is {self.seed}, expected 0 or more"),
            (self.runs >= 1, f"runs is {self.runs}, expected 1 or more"),
            (self.joint >= 1, f"joint is {self.joint}, expected 1 or more"),
            (self.sign in (-1, 1), f"sign is {self.sign}, expected 1 or -1"),
            (self.payload >= 0.0, f"payload is {self.payload} kg, expected 0 or more"),
            (self.noise_scale >= 0.0, f"noise scale is {self.noise_scale}, expected 0 or more"),
            (1 <= self.thin <= 20, f"thin is {self.thin}, expected 1 to 20"),
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
        kinds = (
            ("joint kind", self.joint_kind, JOINT_KINDS),
            ("noise kind", self.noise_kind, NOISE_KINDS),
            ("protocol", self.protocol, PROTOCOLS),
        )
        choices = tuple(
            (value in known, f"{what} is {value!r}, expected one of {', '.join(known)}")
            for what, value, known in kinds
        )
        for met, fault in (*demands, *choices):
            if not met:
                raise OptionError(fault)
