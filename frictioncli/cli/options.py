"""Every option once, with its unit; defaults come from the settings of the stages."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from frictioncli.correction.settings import (
    CRITERIA,
    CorrectionSettings,
    EvaluationGrid,
    ScheduleSettings,
)
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import OptionError
from frictioncli.model.settings import METHODS, TEMPERATURES, FitSettings
from frictioncli.pairs.settings import PairingSettings, SteadySettings
from frictioncli.simulator.settings import (
    JOINT_KINDS,
    NOISE_KINDS,
    PROTOCOLS,
    SynthesisSettings,
)

PAIRING = PairingSettings()
STEADY = SteadySettings()
FIT = FitSettings()
SCHEDULE = ScheduleSettings()
GRID = EvaluationGrid()
CORRECTION = CorrectionSettings()
WORK = Path("friction-run")

DIAGNOSIS = DiagnosisSettings()
SYNTHESIS = SynthesisSettings()

_READ, _PAIR, _FIT, _CORRECT = "Reading", "Pairing", "Model", "Correction"

Logs = Annotated[
    list[Path], typer.Argument(help="Log files or folders; each folder is one run.", metavar="LOGS")
]
Work = Annotated[
    Path, typer.Option("-w", "--work", metavar="RUN", help="Work folder that holds the tables.")
]
Joints = Annotated[
    list[int] | None,
    typer.Option(
        "--joint", help="Joint to read, from 1; repeatable. All with torque.", rich_help_panel=_READ
    ),
]
Map = Annotated[
    Path | None,
    typer.Option("--map", help="TOML file that names channels and units.", rich_help_panel=_READ),
]
GearRatio = Annotated[
    float | None,
    typer.Option(
        help="Motor turns per joint turn, for motor-side channels.", rich_help_panel=_READ
    ),
]
TimeUnit = Annotated[
    str | None, typer.Option(help="Force the unit: s, ms, us.", rich_help_panel=_READ)
]
PositionUnit = Annotated[
    str | None, typer.Option(help="Force the unit: deg, rad, udeg.", rich_help_panel=_READ)
]
VelocityUnit = Annotated[
    str | None, typer.Option(help="Force the unit: deg/s, rad/s, rpm.", rich_help_panel=_READ)
]
TorqueUnit = Annotated[
    str | None, typer.Option(help="Force the unit: N·m (or Nm), mNm, A, mA.", rich_help_panel=_READ)
]
TemperatureUnit = Annotated[
    str | None, typer.Option(help="Force the unit: degC, K, degF.", rich_help_panel=_READ)
]
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON document; units are in its key names.")
]
SuggestMap = Annotated[
    bool,
    typer.Option(
        "--suggest-map", help="Print a first mapping file (TOML) for --map, with its reasons."
    ),
]
BinWidth = Annotated[
    float, typer.Option(help="Width of the angle bins [deg].", rich_help_panel=_PAIR)
]
MinSpeed = Annotated[
    float, typer.Option(help="Below this the joint stands [deg/s].", rich_help_panel=_PAIR)
]
SpeedTolerance = Annotated[
    float,
    typer.Option(help="Departure from constant speed [share of it].", rich_help_panel=_PAIR),
]
Settling = Annotated[
    float, typer.Option(help="Time dropped after acceleration [s].", rich_help_panel=_PAIR)
]
MinSamples = Annotated[
    int, typer.Option(help="Least samples of a constant-speed part.", rich_help_panel=_PAIR)
]
SameSpeed = Annotated[
    float, typer.Option(help="Greatest difference of speed [share].", rich_help_panel=_PAIR)
]
SameTemperature = Annotated[
    float, typer.Option(help="Greatest difference of temperature [°C].", rich_help_panel=_PAIR)
]
LongestPause = Annotated[
    float, typer.Option(help="Longest pause between partners [s].", rich_help_panel=_PAIR)
]
Sign = Annotated[
    str,
    typer.Option(
        help="Torque in forward motion: +1 load + friction, -1 load - friction, auto.",
        rich_help_panel=_PAIR,
    ),
]
Method = Annotated[
    str, typer.Option(help=f"Identification: {', '.join(METHODS)}.", rich_help_panel=_FIT)
]
Temperature = Annotated[
    str,
    typer.Option(
        help=f"Temperature in the model: auto, {', '.join(TEMPERATURES)}.", rich_help_panel=_FIT
    ),
]
Criterion = Annotated[
    str, typer.Option(help=f"When to correct: {', '.join(CRITERIA)}.", rich_help_panel=_CORRECT)
]
K = Annotated[
    float, typer.Option("--k", help="Scale k of criterion (20).", rich_help_panel=_CORRECT)
]
TMax = Annotated[
    float,
    typer.Option("--tmax", help="Time that forces a correction [min].", rich_help_panel=_CORRECT),
]
KGrid = Annotated[
    list[str] | None,
    typer.Option("--k", help="Scales k to evaluate, repeated or 1,2,5.", rich_help_panel=_CORRECT),
]
TMaxGrid = Annotated[
    list[str] | None,
    typer.Option(
        "--tmax", help="Forcing times to evaluate [min], as --k.", rich_help_panel=_CORRECT
    ),
]
Bound = Annotated[
    float,
    typer.Option(
        help="Criterion uncertainty: greatest standard deviation (1 sigma, as epsilon is an RMS) of"
        " friction predicted for the highest speed [torque unit].",
        rich_help_panel=_CORRECT,
    ),
]
BoundGrid = Annotated[
    list[str] | None,
    typer.Option(
        "--bound",
        help="Bounds of criterion uncertainty to evaluate [torque unit], as --k.",
        rich_help_panel=_CORRECT,
    ),
]
CorrectionSpeed = Annotated[
    float | None,
    typer.Option(
        help="Speed of correction pairs [deg/s]; 2/3 of the highest.", rich_help_panel=_CORRECT
    ),
]
SmoothingDegree = Annotated[
    int,
    typer.Option(help="Degree of the polynomial that smooths (21).", rich_help_panel=_CORRECT),
]
Extended = Annotated[
    bool, typer.Option("--extended", help="Use extended-model.json.", rich_help_panel=_CORRECT)
]
Alpha = Annotated[float, typer.Option(help="Chance of finding a cause where there is none.")]
DiagnosisSeed = Annotated[int, typer.Option("--seed", help="Seed of the simulated noise.")]
Most = Annotated[int, typer.Option(help="Greatest number of causes, up to 4.")]
FailOn = Annotated[
    str | None, typer.Option(help="Exit with 3 if there is such a finding: any, named.")
]

Seed = Annotated[int, typer.Option(help="Seed; the same one gives the same bytes.")]
Runs = Annotated[int, typer.Option(help="Number of runs, one per day.")]
SimulatedJoint = Annotated[int, typer.Option(help="Number of the axis in the channel names.")]
SimulatedSign = Annotated[
    int, typer.Option(help="Torque in forward motion: 1 load + friction, -1 load - friction.")
]
Payload = Annotated[float, typer.Option(help="Mass at the flange [kg].")]
Lowest = Annotated[int, typer.Option(help="Lowest motor temperature of the cycle [°C].")]
Highest = Annotated[int, typer.Option(help="Highest motor temperature of the cycle [°C].")]
Ambient = Annotated[
    list[float] | None,
    typer.Option(help=f"Ambient at each run's start [°C], repeatable. {SYNTHESIS.ambient}"),
]
AmbientDrift = Annotated[
    list[float] | None,
    typer.Option(help=f"Its change in each run [K/h]. {SYNTHESIS.ambient_drift}"),
]
MotorHeatShare = Annotated[
    list[float] | None,
    typer.Option(help=f"Share of heat entering at the motor. {SYNTHESIS.motor_heat_share}"),
]
NoiseScale = Annotated[float, typer.Option(help="Factor on all noise; 0 is bare physics.")]
Effects = Annotated[
    list[str] | None,
    typer.Option(
        "--effect",
        metavar="NAME[:SIZE]",
        help="Effect to hide, repeatable; SIZE is its RMS at constant speed [N·m], 0.5 to 2 if "
        "not given. A wrong name lists all.",
    ),
]
Blind = Annotated[
    bool,
    typer.Option(
        "--blind", help="Write the truth to FOLDER-truth.json beside the folder, and tell nothing."
    ),
]
JointKind = Annotated[
    str,
    typer.Option(
        help=f"Friction of the joint: {', '.join(JOINT_KINDS)}; plain is equation (16) of the "
        "motor temperature [°C]."
    ),
]
NoiseKind = Annotated[str, typer.Option(help=f"Kind of noise [N·m]: {', '.join(NOISE_KINDS)}.")]
Protocol = Annotated[
    str,
    typer.Option(
        help=f"Motions: {', '.join(PROTOCOLS)}; enriched has 10 speeds [deg/s] in random order, "
        "two thermal cycles, three payloads [kg], pauses [s]."
    ),
]
Thin = Annotated[int, typer.Option(help="Log every so many-th sample of 0.012 s only.")]

Settings = TypeVar("Settings")


def chosen(kind: type[Settings], given: Mapping[str, Any]) -> Settings:
    """Return settings of a stage from a command's arguments of the same names."""
    names = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    named = {name: given[name] for name in names if given.get(name) is not None}
    lists = {name: tuple(value) for name, value in named.items() if isinstance(value, list)}
    return kind(**named | lists)


def check_fail_on(value: str | None) -> None:
    """Raise OptionError if ``--fail-on`` is given something that it does not know."""
    if value not in (None, "any", "named"):
        raise OptionError(f"--fail-on {value}: expected any or named")


def sign_number(text: str) -> int | None:
    """Return the sign that ``--sign`` names, none for ``auto``.

    Raises
    ------
    OptionError
        If it is none of these.
    """
    signs = {"auto": None, "+1": 1, "1": 1, "+": 1, "-1": -1, "-": -1}
    if text not in signs:
        raise OptionError(f"--sign {text}: expected auto, +1 or -1")
    return signs[text]
