"""Settings of simulated measurements."""

import math
from dataclasses import dataclass, field

from frictioncli.errors import OptionError
from frictioncli.options import option

JOINT_KINDS = ("zones", "plain", "network")
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

_AMBIENT = (16.0, 16.0)
_AMBIENT_DRIFT = (-0.10, -0.35)
_MOTOR_HEAT_SHARE = (0.52, 0.48)


@dataclass(frozen=True, slots=True, kw_only=True)
class SynthesisSettings:
    """What is simulated. Values that differ between runs are repeated where there are more runs.

    Attributes
    ----------
    seed : int
        Seed of all random parts; the same seed gives the same bytes.
    runs : int
        Number of runs, one per day.
    joint : int
        Number of the axis in the channel names.
    sign : int
        Sign of friction in forward motion. 1: torque is load + friction; -1: load - friction, as
        in the paper.
    payload : float
        Mass at the flange. [kg]
    lowest, highest : int
        Lowest and highest motor temperature of the thermal cycle. [°C]
    ambient : tuple of float
        Ambient temperature at the start of each run. [°C]
    ambient_drift : tuple of float
        Rate of change of the ambient temperature in each run. [K/h]
    motor_heat_share : tuple of float
        Share of the dissipated heat that enters at the motor in each run; the rest enters at gear
        and housing. Below about 0.05 friction is lower while heating than while cooling. [-]
    noise_scale : float
        Factor on all noise; 0 gives the physics alone. [-]
    effects : tuple of str
        Effects to add, each ``NAME`` or ``NAME:SIZE``; SIZE is the root mean square of its torque
        at constant speed. A change may be ``NAME@vanishing`` or ``NAME@recurring``. [N·m]
    nuisances : tuple of str
        What joint and log do besides, each ``NAME``, ``NAME:SIZE`` or ``all``.
    blind : bool
        Whether the truth is written beside the folder instead of into it, and not printed.
    joint_kind : str
        ``zones``: three friction zones at three temperatures; ``plain``: friction is equation (16)
        of the true motor temperature; ``network``: of the temperature of the gear, a node of a
        thermal network that no sensor has.
    noise_kind : str
        Kind of noise.
    protocol : str
        ``paper``: Algorithms 1 and 2; ``enriched``: speeds in random order, two thermal cycles with
        different entry of heat, three payloads, pauses.
    thin : int
        Decimation: only every ``thin``-th sample of the controller is logged.
    """

    seed: int = field(default=0, metadata=option("Seed; the same one gives the same bytes."))
    runs: int = field(default=2, metadata=option("Number of runs, one per day."))
    joint: int = field(default=2, metadata=option("Number of the axis in the channel names."))
    sign: int = field(
        default=1,
        metadata=option("Torque in forward motion: 1 load + friction, -1 load - friction."),
    )
    payload: float = field(default=2.0, metadata=option("Mass at the flange [kg]."))
    lowest: int = field(default=25, metadata=option("Lowest motor temperature of the cycle [°C]."))
    highest: int = field(
        default=65, metadata=option("Highest motor temperature of the cycle [°C].")
    )
    ambient: tuple[float, ...] = field(
        default=_AMBIENT,
        metadata=option(f"Ambient at each run's start [°C], repeatable. {_AMBIENT}"),
    )
    ambient_drift: tuple[float, ...] = field(
        default=_AMBIENT_DRIFT,
        metadata=option(f"Change of the ambient temperature in each run [K/h]. {_AMBIENT_DRIFT}"),
    )
    motor_heat_share: tuple[float, ...] = field(
        default=_MOTOR_HEAT_SHARE,
        metadata=option(f"Share of heat entering at the motor. {_MOTOR_HEAT_SHARE}"),
    )
    noise_scale: float = field(default=1.0, metadata=option("Factor on all noise; 0: no noise."))
    effects: tuple[str, ...] = field(
        default=(),
        metadata=option(
            "Effect to hide, repeatable; SIZE is its RMS at constant speed [N·m], 0.5 to 2 if not"
            " given. A change may be NAME@vanishing or NAME@recurring. An unknown name lists all.",
            "--effect",
            metavar="NAME[:SIZE]",
        ),
    )
    nuisances: tuple[str, ...] = field(
        default=(),
        metadata=option(
            "Nuisance of joint or log, repeatable; all: each at an ordinary size. An unknown name"
            " lists all; units are those of truth.json [s, N·m, deg, °C, %].",
            "--nuisance",
            metavar="NAME[:SIZE]",
        ),
    )
    blind: bool = field(
        default=False,
        metadata=option(
            "Write the truth to FOLDER-truth.json beside the folder, and print nothing of it."
        ),
    )
    joint_kind: str = field(
        default="zones",
        metadata=option(
            f"Friction of the joint: {', '.join(JOINT_KINDS)}; plain is equation (16) of the motor"
            " temperature, network of the hidden gear temperature [°C]."
        ),
    )
    noise_kind: str = field(
        default="default", metadata=option(f"Kind of noise [N·m]: {', '.join(NOISE_KINDS)}.")
    )
    protocol: str = field(
        default="paper",
        metadata=option(
            f"Motions: {', '.join(PROTOCOLS)}; enriched has 10 speeds [deg/s] in random order, two"
            " thermal cycles, three payloads [kg], pauses [s]."
        ),
    )
    thin: int = field(default=1, metadata=option("Log only every n-th sample of 0.012 s."))

    def __post_init__(self) -> None:
        demands = (
            (self.seed >= 0, f"seed is {self.seed}, expected 0 or more"),
            (self.runs >= 1, f"runs is {self.runs}, expected 1 or more"),
            (self.joint >= 1, f"joint is {self.joint}, expected 1 or more"),
            (self.sign in (-1, 1), f"sign is {self.sign}, expected 1 or -1"),
            (0.0 <= self.payload <= 1e4, f"payload is {self.payload} kg, expected 0 to 10,000"),
            (
                0.0 <= self.noise_scale <= 1e6,
                f"noise scale is {self.noise_scale}, expected 0 to 1e6",
            ),
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
