"""One function per command.

A command makes its settings first and imports what works with them last: a wrong option is told at
once.
"""

from pathlib import Path
from typing import Annotated, Any

import typer

from frictioncli.cli import options as o
from frictioncli.cli.compare import compare
from frictioncli.cli.export import export
from frictioncli.cli.fleet import fleet
from frictioncli.cli.plan import plan
from frictioncli.cli.terminal import say
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import OptionError
from frictioncli.model.settings import FitSettings
from frictioncli.pairs.settings import PairingSettings, SteadySettings
from frictioncli.simulator.settings import SynthesisSettings

app = typer.Typer(
    name="frictioncli",
    help="Friction of a robot joint from its torque logs. Units: deg, deg/s, s, N·m, °C.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from frictioncli import __version__

        say(f"frictioncli {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show it.")
    ] = False,
) -> None:
    """Friction of a robot joint from its torque logs. Units: deg, deg/s, s, N·m, °C."""


@app.command()
def inspect(
    logs: o.Logs,
    joints: o.Joints = None,
    map_file: o.Map = None,
    gear_ratio: o.GearRatio = None,
    time_unit: o.TimeUnit = None,
    position_unit: o.PositionUnit = None,
    velocity_unit: o.VelocityUnit = None,
    torque_unit: o.TorqueUnit = None,
    temperature_unit: o.TemperatureUnit = None,
    json: o.Json = False,
    suggest_map: o.SuggestMap = False,
) -> None:
    """Show what logs hold (deg, deg/s, s, N·m, °C), how good they are and what they suffice for."""
    from frictioncli.logs.settings import IngestSettings

    settings = o.chosen(IngestSettings, locals())
    if json and suggest_map:
        raise OptionError("--json and --suggest-map: expected one of them")
    if suggest_map:
        from frictioncli.inspection.map_suggestion.suggest_map import suggested_map

        say(suggested_map(logs, settings))
        return
    from frictioncli.inspection.inspect import inspect as look

    found = look(logs, settings)
    if json:
        from frictioncli.documents import to_json
        from frictioncli.inspection.document import document

        say(to_json(document(found)).rstrip())
        return
    from frictioncli.inspection.text import text

    say(text(found))


@app.command()
def ingest(
    logs: o.Logs,
    work: o.Work = o.WORK,
    joints: o.Joints = None,
    map_file: o.Map = None,
    gear_ratio: o.GearRatio = None,
    time_unit: o.TimeUnit = None,
    position_unit: o.PositionUnit = None,
    velocity_unit: o.VelocityUnit = None,
    torque_unit: o.TorqueUnit = None,
    temperature_unit: o.TemperatureUnit = None,
) -> None:
    """Read logs into samples: deg, deg/s, s, N·m (or A), °C."""
    from frictioncli.logs.settings import IngestSettings

    settings = o.chosen(IngestSettings, locals())
    from frictioncli.stages.ingest import ingest as ingest_stage

    say(ingest_stage(logs, work, settings))


@app.command()
def pair(
    work: o.Work = o.WORK,
    bin_width: o.BinWidth = o.PAIRING.bin_width,
    min_speed: o.MinSpeed = o.STEADY.min_speed,
    speed_tolerance: o.SpeedTolerance = o.STEADY.speed_tolerance,
    settling: o.Settling = o.STEADY.settling,
    min_samples: o.MinSamples = o.STEADY.min_samples,
    same_speed: o.SameSpeed = o.PAIRING.same_speed,
    same_temperature: o.SameTemperature = o.PAIRING.same_temperature,
    longest_pause: o.LongestPause = o.PAIRING.longest_pause,
) -> None:
    """Match counter-directed constant-speed motion by speed [deg/s] and angle bin [deg]."""
    steady = o.chosen(SteadySettings, locals())
    settings = o.chosen(PairingSettings, locals())
    from frictioncli.stages.pair import pair as pair_stage

    say(pair_stage(work, settings))


@app.command()
def separate(work: o.Work = o.WORK, sign: o.Sign = "auto") -> None:
    """Separate friction torque from load torque [N·m] by equation (8)."""
    number = o.sign_number(sign)
    from frictioncli.stages.separate import separate as separate_stage

    say(separate_stage(work, number))


@app.command()
def fit(
    work: o.Work = o.WORK,
    method: o.Method = o.FIT.method,
    temperature: o.Temperature = o.FIT.temperature,
) -> None:
    """Identify the friction model (16): load [N·m], speed [deg/s], temperature [°C]."""
    settings = FitSettings(method=method, temperature=temperature)
    from frictioncli.stages.fit import fit as fit_stage

    say(fit_stage(work, settings))


@app.command()
def simulate(
    work: o.Work = o.WORK,
    k: o.K = o.SCHEDULE.k,
    tmax: o.TMax = o.SCHEDULE.tmax / 60,
    criterion: o.Criterion = o.SCHEDULE.criterion,
    bound: o.Bound = o.SCHEDULE.bound,
    correction_speed: o.CorrectionSpeed = None,
    smoothing_degree: o.SmoothingDegree = o.CORRECTION.smoothing_degree,
    extended: o.Extended = False,
) -> None:
    """Simulate the temperature correction of Algorithm 3; tmax in minutes, epsilon in N·m."""
    schedule = ScheduleSettings(criterion=criterion, k=k, tmax=tmax * 60, bound=bound)
    correction = o.chosen(CorrectionSettings, locals())
    from frictioncli.stages.simulate import simulate as simulate_stage

    say(simulate_stage(work, schedule, correction, extended=extended))


@app.command()
def evaluate(
    work: o.Work = o.WORK,
    k: o.KGrid = None,
    tmax: o.TMaxGrid = None,
    bound: o.BoundGrid = None,
    correction_speed: o.CorrectionSpeed = None,
    smoothing_degree: o.SmoothingDegree = o.CORRECTION.smoothing_degree,
    extended: o.Extended = False,
) -> None:
    """Evaluate schedules over k, tmax [min] and bound [N·m]: epsilon [N·m] by corrections."""
    grid, correction = _grid(k, tmax, bound), o.chosen(CorrectionSettings, locals())
    from frictioncli.stages.evaluate import evaluate as evaluate_stage

    say(evaluate_stage(work, grid, correction, extended=extended))


@app.command()
def diagnose(
    work: o.Work = o.WORK,
    alpha: o.Alpha = o.DIAGNOSIS.alpha,
    seed: o.DiagnosisSeed = o.DIAGNOSIS.seed,
    most: o.Most = o.DIAGNOSIS.most,
    fail_on: o.FailOn = None,
) -> None:
    """Find what the simulated torque [N·m] gets wrong, name the cause, measure the gain."""
    o.check_fail_on(fail_on)
    settings = o.chosen(DiagnosisSettings, locals())
    from frictioncli.stages.diagnose import diagnose as diagnose_stage
    from frictioncli.stages.diagnose import has_finding

    say(diagnose_stage(work, settings))
    if fail_on and has_finding(work, named_only=fail_on == "named"):
        raise typer.Exit(3)


@app.command()
def report(work: o.Work = o.WORK) -> None:
    """Draw the figures (deg, deg/s, s, N·m, °C) and write report/index.html."""
    from frictioncli.stages.report import report as report_stage

    say(report_stage(work))


@app.command()
def run(
    logs: o.Logs,
    work: o.Work = o.WORK,
    joints: o.Joints = None,
    map_file: o.Map = None,
    gear_ratio: o.GearRatio = None,
    time_unit: o.TimeUnit = None,
    position_unit: o.PositionUnit = None,
    velocity_unit: o.VelocityUnit = None,
    torque_unit: o.TorqueUnit = None,
    temperature_unit: o.TemperatureUnit = None,
    bin_width: o.BinWidth = o.PAIRING.bin_width,
    min_speed: o.MinSpeed = o.STEADY.min_speed,
    speed_tolerance: o.SpeedTolerance = o.STEADY.speed_tolerance,
    settling: o.Settling = o.STEADY.settling,
    min_samples: o.MinSamples = o.STEADY.min_samples,
    same_speed: o.SameSpeed = o.PAIRING.same_speed,
    same_temperature: o.SameTemperature = o.PAIRING.same_temperature,
    longest_pause: o.LongestPause = o.PAIRING.longest_pause,
    sign: o.Sign = "auto",
    method: o.Method = o.FIT.method,
    temperature: o.Temperature = o.FIT.temperature,
    criterion: o.Criterion = o.SCHEDULE.criterion,
    k: o.K = o.SCHEDULE.k,
    tmax: o.TMax = o.SCHEDULE.tmax / 60,
    bound: o.Bound = o.SCHEDULE.bound,
    correction_speed: o.CorrectionSpeed = None,
    smoothing_degree: o.SmoothingDegree = o.CORRECTION.smoothing_degree,
) -> None:
    """Run the whole chain, from logs to the report. Units: deg, deg/s, s, N·m, °C."""
    from frictioncli.logs.settings import IngestSettings

    steady = o.chosen(SteadySettings, locals())
    parts: dict[str, Any] = {
        "ingest": o.chosen(IngestSettings, locals()),
        "pairing": o.chosen(PairingSettings, locals()),
        "sign": o.sign_number(sign),
        "fit": o.chosen(FitSettings, locals()),
        "schedule": ScheduleSettings(criterion=criterion, k=k, tmax=tmax * 60, bound=bound),
        "correction": o.chosen(CorrectionSettings, locals()),
    }
    from frictioncli.stages import run as pipeline

    pipeline.run(logs, work, pipeline.RunSettings(**parts), tell=_tell)


@app.command()
def synthesize(
    folder: Annotated[Path, typer.Argument(help="Folder to make.", metavar="FOLDER")],
    seed: o.Seed = o.SYNTHESIS.seed,
    runs: o.Runs = o.SYNTHESIS.runs,
    joint: o.SimulatedJoint = o.SYNTHESIS.joint,
    sign: o.SimulatedSign = o.SYNTHESIS.sign,
    payload: o.Payload = o.SYNTHESIS.payload,
    lowest: o.Lowest = o.SYNTHESIS.lowest,
    highest: o.Highest = o.SYNTHESIS.highest,
    ambient: o.Ambient = None,
    ambient_drift: o.AmbientDrift = None,
    motor_heat_share: o.MotorHeatShare = None,
    noise_scale: o.NoiseScale = o.SYNTHESIS.noise_scale,
    effects: o.Effects = None,
    blind: o.Blind = False,
    joint_kind: o.JointKind = o.SYNTHESIS.joint_kind,
    noise_kind: o.NoiseKind = o.SYNTHESIS.noise_kind,
    protocol: o.Protocol = o.SYNTHESIS.protocol,
    thin: o.Thin = o.SYNTHESIS.thin,
) -> None:
    """Simulate a joint (deg, deg/s, N·m, °C, kg) and write its traces with truth.json."""
    settings = o.chosen(SynthesisSettings, locals())
    from frictioncli.simulator.synthesize import synthesize as make

    say(make(folder, settings))


app.command()(plan)
app.command()(export)
app.command()(compare)
app.command()(fleet)


def _tell(stage: str, text: object) -> None:
    first, *others = str(text).splitlines() or [""]
    say(f"{stage:9s} {first}")
    for line in others:
        say(f"{'':9s} {line}")


def _grid(k: list[str] | None, tmax: list[str] | None, bound: list[str] | None) -> EvaluationGrid:
    return EvaluationGrid(
        k=_numbers("k", k) if k else o.GRID.k,
        tmax=tuple(60 * minutes for minutes in _numbers("tmax", tmax)) if tmax else o.GRID.tmax,
        bound=_numbers("bound", bound) if bound else o.GRID.bound,
    )


def _numbers(name: str, texts: list[str]) -> tuple[float, ...]:
    parts = [part for text in texts for part in text.replace(",", " ").split()]
    try:
        return tuple(float(part) for part in parts)
    except ValueError:
        raise OptionError(f"--{name} {' '.join(texts)}: expected numbers, such as 2,5,10") from None
