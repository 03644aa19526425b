"""One function per command: its settings, one call of the library, what is printed.

The options of a command are the fields of its settings, see :mod:`frictioncli.cli.signature`. What
works with the settings is imported last, so that help and wrong options are answered at once.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from frictioncli.challenge.settings import ChallengeSettings
from frictioncli.cli.application import app, command
from frictioncli.cli.terminal import counted, say, say_result, say_stage, working
from frictioncli.comparison.settings import ComparisonSettings
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.deployment.settings import ExportSettings
from frictioncli.design.settings import PlanSettings
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import OptionError
from frictioncli.fleet.settings import FleetSettings
from frictioncli.logs.settings import IngestSettings
from frictioncli.model.settings import FitSettings
from frictioncli.pairs.settings import PairingSettings, SeparationSettings
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.stages.settings import RunSettings

__all__ = ["app"]

Logs = Annotated[
    list[Path], typer.Argument(help="Log files or folders; each folder is one run.", metavar="LOGS")
]
Work = Annotated[
    Path, typer.Option("-w", "--work", metavar="RUN", help="Work folder that holds the tables.")
]
Extended = Annotated[bool, typer.Option("--extended", help="Use extended-model.json.")]

WORK = Path("friction-run")

_FINDING = 3
_INTERRUPTED = 130


@command()
def inspect(
    logs: Logs,
    settings: IngestSettings,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document; units are in its key names.")
    ] = False,
    suggest_map: Annotated[
        bool,
        typer.Option(
            "--suggest-map",
            help="Print a first mapping file (TOML) for --map, with the evidence for it.",
        ),
    ] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="List every file: rows, sampling, faults.")
    ] = False,
) -> None:
    """Show what logs contain and which stages they suffice for. Units: deg, deg/s, s, N·m, °C."""
    if json and suggest_map:
        raise OptionError("--json and --suggest-map: expected one of them")
    if suggest_map:
        from frictioncli.inspection.map_suggestion.suggest_map import suggested_map

        with working("inspect"):
            suggestion = suggested_map(logs, settings)
        say(suggestion)
        return
    from frictioncli.inspection.inspect import inspect as inspect_logs

    with working("inspect"):
        inspection = inspect_logs(logs, settings)
    if json:
        from frictioncli.documents import to_json
        from frictioncli.inspection.document import document

        say(to_json(document(inspection)).rstrip())
    else:
        from frictioncli.inspection.text import text

        say(text(inspection, verbose=verbose))


@command()
def ingest(logs: Logs, *, work: Work = WORK, settings: IngestSettings) -> None:
    """Read logs into samples. Units: deg, deg/s, s, N·m (or A), °C."""
    from frictioncli.stages.ingest import ingest as ingest_stage

    say_result("ingest", lambda: ingest_stage(logs, work, settings))


@command(before={"min_speed": ["bin_width"]})
def pair(*, work: Work = WORK, settings: PairingSettings) -> None:
    """Match constant-speed moves in opposite directions. Speed in deg/s, angle bins in deg."""
    from frictioncli.stages.pair import pair as pair_stage

    say_result("pair", lambda: pair_stage(work, settings))


@command()
def separate(*, work: Work = WORK, settings: SeparationSettings) -> None:
    """Separate friction from load by equation (8). Torques in N·m (or A)."""
    from frictioncli.stages.separate import separate as separate_stage

    say_result("separate", lambda: separate_stage(work, settings))


@command()
def fit(*, work: Work = WORK, settings: FitSettings) -> None:
    """Identify the friction model, equation (16). Load in N·m, speed in deg/s, °C."""
    from frictioncli.stages.fit import fit as fit_stage

    say_result("fit", lambda: fit_stage(work, settings))


@command(before={"criterion": ["k", "tmax"]})
def simulate(
    *,
    work: Work = WORK,
    schedule: ScheduleSettings,
    settings: CorrectionSettings,
    extended: Extended = False,
) -> None:
    """Simulate temperature correction by Algorithm 3. tmax in minutes, epsilon in N·m."""
    from frictioncli.stages.simulate import simulate as simulate_stage

    say_result("simulate", lambda: simulate_stage(work, schedule, settings, extended=extended))


@command()
def evaluate(
    *,
    work: Work = WORK,
    grid: EvaluationGrid,
    settings: CorrectionSettings,
    extended: Extended = False,
) -> None:
    """Evaluate corrections over k, tmax and bound. tmax in minutes, bound and epsilon in N·m."""
    from frictioncli.stages.evaluate import evaluate as evaluate_stage

    say_result("evaluate", lambda: evaluate_stage(work, grid, settings, extended=extended))


@command()
def diagnose(
    *,
    work: Work = WORK,
    settings: DiagnosisSettings,
    fail_on: Annotated[
        str | None, typer.Option(help="Exit with status 3 on this finding: any, named.")
    ] = None,
) -> None:
    """Find what the simulated torque gets wrong, and why. Torques in N·m (or A)."""
    if fail_on not in (None, "any", "named"):
        raise OptionError(f"--fail-on {fail_on}: expected any or named")
    from frictioncli.stages.diagnose import diagnose as diagnose_stage
    from frictioncli.stages.diagnose import has_finding

    say_result("diagnose", lambda: diagnose_stage(work, settings))
    if fail_on and has_finding(work, named_only=fail_on == "named"):
        raise typer.Exit(_FINDING)


@command()
def report(
    work: Work = WORK,
    png: Annotated[
        bool,
        typer.Option("--png", help="Also write each figure as PNG; the page can do so too."),
    ] = False,
) -> None:
    """Draw the figures and write report/index.html. Units: deg, deg/s, s, N·m, °C."""
    from frictioncli.stages.report import report as report_stage

    say_result("report", lambda: report_stage(work, png=png))


@command(before={"min_speed": ["bin_width"]})
def run(logs: Logs, *, work: Work = WORK, settings: RunSettings) -> None:
    """Run the whole chain, from logs to the report. Units: deg, deg/s, s, N·m, °C."""
    from frictioncli.stages.run import run as run_chain

    with working("ingest") as line:
        run_chain(logs, work, settings, progress=partial(say_stage, line))


@command()
def synthesize(
    folder: Annotated[Path, typer.Argument(help="Folder to create.", metavar="FOLDER")],
    settings: SynthesisSettings,
) -> None:
    """Simulate a joint and write its logs, with truth.json. Units: deg, deg/s, N·m, °C, kg."""
    from frictioncli.simulator.synthesize import synthesize as synthesize_traces

    say_result("synthesize", lambda: synthesize_traces(folder, settings))


@command(without=("schedule", "grid", "correction"), before={"min_speed": ["bin_width"]})
def challenge(
    logs: Logs,
    *,
    work: Work = WORK,
    options: ChallengeSettings,
    settings: RunSettings,
) -> None:
    """Plant effects in your own logs and diagnose them. Sizes in N·m (or A)."""
    from frictioncli.challenge.challenge import challenge as run_challenge

    try:
        with working("challenge") as line:
            result = run_challenge(logs, work, settings, options, line.relabel)
    except KeyboardInterrupt:
        say("interrupted; finished work is kept: run the command again to continue", fault=True)
        raise typer.Exit(_INTERRUPTED) from None
    say(result)


@command(before={"low": ["joint", "new", "seed"]})
def plan(
    *,
    work: Work = WORK,
    settings: PlanSettings,
    new: Annotated[
        bool,
        typer.Option("--new", help="Without data: Algorithms 1 and 2 of the paper, for any axis."),
    ] = False,
) -> None:
    """Plan the next experiment and write its program. Units: min, deg, deg/s, °C."""
    from frictioncli.stages.plan import plan as plan_stage
    from frictioncli.stages.plan import plan_new

    say_result("plan", lambda: plan_new(work, settings) if new else plan_stage(work, settings))


@command()
def export(*, work: Work = WORK, settings: ExportSettings) -> None:
    """Export the model as C, URDF, MJCF, JSON or CSV. Units: N·m (or A), deg/s, °C."""
    from frictioncli.stages.export import export as export_stage

    say_result("export", lambda: export_stage(work, settings))


@command()
def compare(
    runs: Annotated[
        list[Path],
        typer.Argument(
            help="Work folders of the same joint on different days; each may hold several runs."
            " Without dates in the logs, they are taken in the order given.",
            metavar="RUN...",
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option(
            "-w",
            "--work",
            metavar="OUT",
            help="Folder for comparison.json, compare.html and the trend figure.",
        ),
    ] = Path("friction-comparison"),
    settings: ComparisonSettings,
) -> None:
    """Report what changed in a joint between runs. Units: N·m (or A) and %, °C, deg/s."""
    from frictioncli.stages.compare import above_threshold
    from frictioncli.stages.compare import compare as compare_stage

    say_result("compare", lambda: compare_stage(runs, out, settings))
    if above_threshold(out):
        raise typer.Exit(_FINDING)


@command(without=("joints", "pairing", "criterion", "bound", "correction"))
def fleet(
    logs: Annotated[
        Path,
        typer.Argument(
            help="Folder with robot=R/joint=J/run=D folders of logs, or a table of runs (CSV,"
            " Parquet) with columns robot, joint, run, path and, optionally, map, gear_ratio.",
            metavar="FLEET",
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option("-w", "--work", metavar="OUT", help="Folder for the table and all joints."),
    ] = Path("friction-fleet"),
    options: FleetSettings,
    diagnosis: Annotated[
        bool, typer.Option("--diagnosis/--no-diagnosis", help="Diagnose each joint.")
    ] = True,
    settings: RunSettings,
    fail_on: Annotated[
        str | None,
        typer.Option(
            help="Exit with status 3 on this finding: failed (any joint failed).", metavar="FINDING"
        ),
    ] = None,
) -> None:
    """Run the chain for many joints, one row each. Units: N·m (or A), °C, deg/s."""
    from frictioncli.fleet.fleet import has_failed, run_fleet

    if fail_on not in (None, "failed"):
        raise OptionError(f"--fail-on {fail_on}: expected failed")
    if not diagnosis:
        settings = replace(settings, diagnosis=None)
    try:
        summary = run_fleet(logs, out, settings, options, counted)
    except KeyboardInterrupt:
        say("interrupted; finished joints are kept: run the command again to continue", fault=True)
        raise typer.Exit(_INTERRUPTED) from None
    say(summary)
    if fail_on and has_failed(summary):
        raise typer.Exit(_FINDING)
