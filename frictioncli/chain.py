"""The stages on a work folder: each reads the tables of the one before and writes its own.

Every function here is a command of the same name; what it returns prints as that command's output.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.correction import stage as correction
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel, read_models, write_models
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.motion.pairing import pair_spans
from frictioncli.motion.phases import add_phases
from frictioncli.motion.separation import separate as separate_pairs
from frictioncli.motion.settings import PairingSettings
from frictioncli.motion.spans import find_spans
from frictioncli.provenance import Provenance, hashes
from frictioncli.reading.ingest import ingest as ingest_logs
from frictioncli.reading.settings import IngestSettings

SAMPLES = "samples.parquet"
RECORDINGS = "recordings.parquet"
PAIRS = "pairs.parquet"
TORQUES = "torques.parquet"
MODEL = "model.json"
SCHEDULE = "schedule.parquet"
EVALUATION = "evaluation.parquet"


@dataclass(frozen=True, slots=True)
class Done:
    """What a stage made, and what it has to say about it."""

    path: Path
    text: str

    def __str__(self) -> str:
        return self.text


def ingest(logs: Sequence[Path], work: Path, settings: IngestSettings | None = None) -> Done:
    """Read logs into ``samples.parquet``; what cannot be used goes to ``rejected.parquet``."""
    summary = ingest_logs(logs, work, settings or IngestSettings())
    return Done(work / SAMPLES, str(summary))


def pair(work: Path, settings: PairingSettings | None = None) -> Done:
    """Find constant-velocity parts and match counter-directed ones: ``pairs.parquet``."""
    settings = settings or PairingSettings()
    source = work / SAMPLES
    facts = tables.facts(source)
    found = find_spans(tables.batches(source, schemas.SAMPLES), settings.steady, settings.bin_width)
    paired = pair_spans(found, settings)
    pairs = add_phases(paired.pairs, _given_phases(work / RECORDINGS, paired.pairs))
    facts |= {
        "samples": paired.samples,
        "dropped": paired.dropped,
        "bin_width": paired.bin_width,
    }
    _write(work / PAIRS, pairs, schemas.PAIRS, "pair", settings, [source], facts)
    return Done(work / PAIRS, _pair_text(pairs, facts, settings))


def separate(work: Path, sign: int | None = None) -> Done:
    """Separate friction torque from load torque by equation (8): ``torques.parquet``."""
    source = work / PAIRS
    facts = tables.facts(source)
    torques, signs = separate_pairs(tables.read(source, schemas.PAIRS), sign)
    facts["sign"] = {str(joint): value for joint, value in signs.items()}
    if torques["load"].notna().any():
        facts["load_unit"] = "N·m"
    _write(work / TORQUES, torques, schemas.TORQUES, "separate", {"sign": sign}, [source], facts)
    unit = facts.get("torque_unit", "N·m")
    lines = []
    for joint, group in torques.groupby("joint"):
        convention = "load + friction" if signs[joint] > 0 else "load - friction"
        origin = "inferred" if sign is None else "as told"
        lines.append(
            f"joint {joint}: forward torque is {convention} (sign {signs[joint]:+d}, {origin}),"
            f" friction {_span(group['friction_torque'])} {unit},"
            f" load {_span(group['load_torque'])} {facts.get('load_unit', unit)}"
        )
    return Done(work / TORQUES, "\n".join(lines))


def fit(work: Path, settings: FitSettings | None = None) -> Done:
    """Identify equation (16) for every joint: ``model.json``."""
    settings = settings or FitSettings()
    source = work / TORQUES
    facts = tables.facts(source)
    torques = tables.read(source, schemas.TORQUES)
    models, faults = _each_joint(torques, lambda group: fit_joint(group, facts, settings))
    write_models(work / MODEL, models, Provenance("fit", asdict(settings), hashes([source])))
    return Done(work / MODEL, "\n".join([*(model.table() for model in models), *faults]))


def simulate(
    work: Path,
    schedule: ScheduleSettings | None = None,
    settings: CorrectionSettings | None = None,
) -> Done:
    """Simulate Algorithm 3 with one criterion: ``schedule.parquet``."""
    schedule = schedule or ScheduleSettings()
    settings = settings or CorrectionSettings()

    def simulated(torques: pd.DataFrame, model: FrictionModel) -> pd.DataFrame:
        return correction.simulate(torques, model, settings, schedule)

    rows, faults, facts = _each_model(work, simulated)
    _write(
        work / SCHEDULE,
        rows,
        schemas.SCHEDULE,
        "simulate",
        asdict(schedule) | asdict(settings),
        [work / TORQUES, work / MODEL],
        facts,
    )
    unit = facts.get("torque_unit", "N·m")
    lines = [
        f"{run}, joint {joint}, {phase}: {int(group['corrected'].sum())} corrections"
        f" ({int(group['failed'].sum())} failed), epsilon"
        f" {correction.epsilon(group, 'friction_smoothed'):.3g} {unit}"
        f" ({correction.epsilon(group, 'friction_torque'):.3g} unsmoothed)"
        for (run, joint, phase), group in rows.groupby(["run", "joint", "phase"], sort=False)
    ]
    return Done(work / SCHEDULE, "\n".join([schedule.told(), *lines, *faults]))


def evaluate(
    work: Path, grid: EvaluationGrid | None = None, settings: CorrectionSettings | None = None
) -> Done:
    """Evaluate all criteria over a grid of k and tmax: ``evaluation.parquet``."""
    grid = grid or EvaluationGrid()
    settings = settings or CorrectionSettings()

    def evaluated(torques: pd.DataFrame, model: FrictionModel) -> pd.DataFrame:
        return correction.evaluate(torques, model, settings, grid)

    rows, faults, facts = _each_model(work, evaluated)
    _write(
        work / EVALUATION,
        rows,
        schemas.EVALUATION,
        "evaluate",
        asdict(grid) | asdict(settings),
        [work / TORQUES, work / MODEL],
        facts,
    )
    text = correction.evaluation_text(rows, facts.get("torque_unit", "N·m"))
    return Done(work / EVALUATION, "\n".join([text, *faults]))


def report(work: Path) -> Done:
    """Draw the figures and write the page: ``report/index.html``."""
    from frictioncli.report.page import write_report

    page = write_report(work)
    return Done(page, str(page))


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """The settings of every stage of a run."""

    ingest: IngestSettings = field(default_factory=IngestSettings)
    pairing: PairingSettings = field(default_factory=PairingSettings)
    sign: int | None = None
    fit: FitSettings = field(default_factory=FitSettings)
    schedule: ScheduleSettings = field(default_factory=ScheduleSettings)
    grid: EvaluationGrid = field(default_factory=EvaluationGrid)
    correction: CorrectionSettings = field(default_factory=CorrectionSettings)


def run(
    logs: Sequence[Path],
    work: Path,
    settings: RunSettings | None = None,
    tell: Callable[[str, Done], None] = lambda stage, done: None,
) -> Path:
    """Run the whole chain and return the report's path.

    Parameters
    ----------
    logs : sequence of Path
        Log files or folders; each folder is one run.
    work : Path
        Work folder; its tables are replaced.
    settings : RunSettings, optional
        Settings of every stage.
    tell : callable, optional
        Called with each stage's name and what it made.

    Notes
    -----
    A log without a thermal cycle has no corrections to simulate; those two stages are then left
    out, and said so, and the tables of a former run are removed.
    """
    chosen = settings or RunSettings()
    tell("ingest", ingest(logs, work, chosen.ingest))
    tell("pair", pair(work, chosen.pairing))
    tell("separate", separate(work, chosen.sign))
    tell("fit", fit(work, chosen.fit))
    optional: Mapping[str, Callable[[], Done]] = {
        "simulate": lambda: simulate(work, chosen.schedule, chosen.correction),
        "evaluate": lambda: evaluate(work, chosen.grid, chosen.correction),
    }
    for stage, path in (("simulate", work / SCHEDULE), ("evaluate", work / EVALUATION)):
        try:
            tell(stage, optional[stage]())
        except NotEnoughData as fault:
            path.unlink(missing_ok=True)
            tell(stage, Done(path, f"left out: {fault}"))
    done = report(work)
    tell("report", done)
    return done.path


def _write(
    path: Path,
    rows: pd.DataFrame,
    table: schemas.Table,
    stage: str,
    settings: Any,
    inputs: list[Path],
    facts: Mapping[str, Any],
) -> None:
    values = settings if isinstance(settings, dict) else asdict(settings)
    tables.write(path, rows, table, Provenance(stage, values, hashes(inputs)), facts)


def _given_phases(path: Path, pairs: pd.DataFrame) -> pd.Series:
    """Return the phase that the manifest gives for each pair's recording; missing where none."""
    if not path.exists():
        return pd.Series([None] * len(pairs), index=pairs.index, dtype=object)
    recordings = tables.read(path, schemas.RECORDINGS)
    given = recordings.drop_duplicates(["run", "recording"]).set_index(["run", "recording"])
    keys = pd.MultiIndex.from_frame(pairs[["run", "recording"]])
    return pd.Series(given["phase"].reindex(keys).to_numpy(), index=pairs.index, dtype=object)


def _each_joint(
    torques: pd.DataFrame, work_on: Callable[[pd.DataFrame], FrictionModel]
) -> tuple[list[FrictionModel], list[str]]:
    """Return the models of the joints that have one, and why the others have none."""
    models, faults = [], []
    for _, group in torques.groupby("joint"):
        try:
            models.append(work_on(group))
        except NotEnoughData as fault:
            faults.append(str(fault))
    if not models:
        raise NotEnoughData("; ".join(faults))
    return models, faults


def _each_model(
    work: Path, work_on: Callable[[pd.DataFrame, FrictionModel], pd.DataFrame]
) -> tuple[pd.DataFrame, list[str], dict[str, Any]]:
    """Return the rows of the joints that give some, why others give none, and the facts."""
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    rows, faults = [], []
    for model in read_models(work / MODEL):
        try:
            rows.append(work_on(torques[torques["joint"] == model.joint], model))
        except NotEnoughData as fault:
            faults.append(str(fault))
    if not rows:
        raise NotEnoughData("; ".join(faults) or f"{work / MODEL} has no model of these joints")
    return pd.concat(rows, ignore_index=True), faults, tables.facts(work / TORQUES)


def _span(values: pd.Series) -> str:
    return f"{values.min():.3g} to {values.max():.3g}"


def _pair_text(pairs: pd.DataFrame, facts: Mapping[str, Any], settings: PairingSettings) -> str:
    lines = []
    if facts["bin_width"] > settings.bin_width:
        lines.append(
            f"angle bins widened from {settings.bin_width:g} to {facts['bin_width']:g} deg: the"
            " joint moves that far between samples"
        )
    heads = pairs.drop_duplicates(["run", "joint", "pair"])
    for joint, group in heads.groupby("joint"):
        speeds = group["speed"].round(1).value_counts().sort_index()
        told = ", ".join(f"{count} at {speed:g}" for speed, count in speeds.head(12).items())
        more = f" and {len(speeds) - 12} other speeds" if len(speeds) > 12 else ""
        lines.append(f"joint {joint}: {len(group)} pairs: {told}{more} deg/s")
    kept = int(pairs["n_forward"].sum() + pairs["n_reverse"].sum())
    dropped = "; ".join(f"{reason} {count}" for reason, count in facts["dropped"].items() if count)
    lines.append(f"samples: {facts['samples']} read, {kept} in pairs; dropped: {dropped or 0}")
    return "\n".join(lines)
