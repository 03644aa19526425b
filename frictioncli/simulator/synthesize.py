"""Command ``synthesize``: simulated trace folders and the truth about them."""

from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from frictioncli import documents, files
from frictioncli.errors import OptionError, TableError
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.nuisances.definition import NO_NUISANCES, Nuisances
from frictioncli.simulator.planted.catalogue import requested_effects
from frictioncli.simulator.planted.planting import PlantedEffects, plant
from frictioncli.simulator.run import run_setup, simulate
from frictioncli.simulator.run_files import MANIFEST, RunSummary, write_run
from frictioncli.simulator.settings import SynthesisSettings

__all__ = ["TRUTH", "SynthesisSettings", "SynthesisSummary", "synthesize"]

TRUTH = "truth.json"
"""File with the truth about the traces."""

_OPTIONAL_SETTINGS = (
    "effects",
    "nuisances",
    "blind",
    "joint_kind",
    "noise_kind",
    "protocol",
    "thin",
)
"""Settings that the truth holds only where they differ from the default."""


class _WrittenFile(msgspec.Struct):
    """The part of a recording's truth that names its file."""

    file: str


class _WrittenRun(msgspec.Struct):
    """The part of a run's truth that names its folder and files."""

    name: str
    recordings: tuple[_WrittenFile, ...]


class _WrittenRuns(msgspec.Struct):
    """The part of ``truth.json`` that names what a synthesis wrote."""

    runs: tuple[_WrittenRun, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SynthesisSummary:
    """Files that were written, and the truth about them; ``str`` omits the truth if it is blind."""

    folder: Path
    seed: int
    runs: tuple[RunSummary, ...]
    truth: Path
    blind: bool
    friction: str
    planted: PlantedEffects
    nuisances: Nuisances = NO_NUISANCES

    def files_text(self) -> str:
        """Return the text about the files."""
        noun = "run" if len(self.runs) == 1 else "runs"
        lines = [f"{self.folder}: {len(self.runs)} simulated {noun}, seed {self.seed}"]
        lines += [
            f"  {run.name}: {run.recordings} recordings, {run.rows} samples; "
            f"heat-up {run.heating / 60.0:.0f} min, cool-down {run.cooling / 60.0:.0f} min"
            for run in self.runs
        ]
        return "\n".join(lines)

    def truth_text(self) -> str:
        """Return the text about what the traces hide."""
        lines = [f"hidden (all of it in {self.truth}):"]
        lines += [
            f"  {run.name}: {run.motor_heat_share:.0%} of the heat enters at the motor, "
            f"ambient {run.ambient:.1f} °C at the start"
            for run in self.runs
        ]
        lines += [f"  {self.friction}"]
        lines += [
            f"  {one.effect.name}, {one.rms:.2f} N·m: {one.effect.definition.equation}"
            for one in self.planted.effects
        ]
        lines += [
            f"  nuisance {one.name}, {one.size:.3g} {one.definition.unit}:"
            f" {one.definition.description}"
            for one in self.nuisances.present
        ]
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.files_text() if self.blind else f"{self.files_text()}\n{self.truth_text()}"


def synthesize(folder: Path, settings: SynthesisSettings | None = None) -> SynthesisSummary:
    """Simulate runs and write them as trace folders with a manifest each, and the truth.

    The truth is ``truth.json`` in the folder, or ``FOLDER-truth.json`` beside it if it is blind.

    Parameters
    ----------
    folder : Path
        Folder to make; a former synthesis there is replaced.
    settings : SynthesisSettings, optional
        What to simulate.

    Returns
    -------
    SynthesisSummary
        Files that were written, and the truth about them.

    Raises
    ------
    OptionError
        If an effect is unknown or cannot be planted, or the folder holds files that no former
        synthesis wrote.
    """
    settings = SynthesisSettings() if settings is None else settings
    effects = requested_effects(settings.effects)
    beside = folder.absolute().with_name(f"{folder.absolute().name}-{TRUTH}")
    _refuse_foreign(folder, beside)
    if settings.blind and beside.exists() and not _files_of_synthesis(beside):
        raise OptionError(f"{beside}: is no truth of a former synthesis; choose another folder")
    seeds = np.random.SeedSequence(settings.seed).spawn(settings.runs)
    runs = simulate([run_setup(settings, number, seed) for number, seed in enumerate(seeds)])
    nuisances = runs[0].setup.nuisances
    planted = PlantedEffects()
    if effects or nuisances:
        states = [state for run in runs for state in run.states()]
        planted = plant(effects, settings.seed, states, settings.sign, nuisances)
    summaries: list[RunSummary] = []
    truths: list[dict[str, Any]] = []
    with files.atomic_write(folder) as draft:
        for run in runs:
            summary, truth = write_run(draft / run.setup.name, run, planted if planted else None)
            summaries.append(summary)
            truths.append(truth)
        document = {
            "program": "frictioncli synthesize",
            "settings": _settings_document(settings),
            "runs": truths,
        }
        if effects:
            document["effects"] = [one.truth() for one in planted.effects]
        if nuisances:
            document["nuisances"] = nuisances.truth()
        text = documents.to_json(document)
        if not settings.blind:
            (draft / TRUTH).write_text(text, encoding="utf-8", newline="\n")
    if settings.blind:
        with files.atomic_write(beside) as draft:
            draft.write_text(text, encoding="utf-8", newline="\n")
    return SynthesisSummary(
        folder=folder,
        seed=settings.seed,
        runs=tuple(summaries),
        truth=beside if settings.blind else folder / TRUTH,
        blind=settings.blind,
        friction=_friction(runs[0].setup.joint, settings.joint_kind),
        planted=planted,
        nuisances=nuisances,
    )


def _friction(joint: SimulatedJoint, kind: str) -> str:
    if kind == "plain":
        return "friction of equation (16) at the motor's true temperature"
    if kind == "network":
        return "friction of equation (16) at the temperature of the gear, which no sensor has"
    zones = ", ".join(f"{zone.name} ({zone.node})" for zone in joint.zones)
    return f"friction of three zones at three temperatures: {zones}"


def _settings_document(settings: SynthesisSettings) -> dict[str, Any]:
    """Return the settings; optional ones only where they differ from the default."""
    document = asdict(settings)
    for field in fields(settings):
        if field.name in _OPTIONAL_SETTINGS and document[field.name] == field.default:
            del document[field.name]
    return document


def _refuse_foreign(folder: Path, beside: Path) -> None:
    """Raise OptionError if ``folder`` holds a file that no synthesis wrote."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise OptionError(f"{folder}: is a file, expected a folder to make; choose another name")
    present = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    foreign = sorted(present - _files_of_synthesis(folder / TRUTH) - _files_of_synthesis(beside))
    if foreign:
        raise OptionError(
            f"{folder}: holds {foreign[0]}, which no former synthesis wrote; "
            "choose a new or an empty folder"
        )


def _files_of_synthesis(truth: Path) -> set[str]:
    """Return the files that a former synthesis wrote; none if ``truth`` cannot be read."""
    try:
        runs = documents.decode(truth.read_bytes(), _WrittenRuns).runs
    except (OSError, TableError):
        return set()
    named = {f"{run.name}/{one.file}" for run in runs for one in run.recordings}
    return named | {f"{run.name}/{MANIFEST}" for run in runs} | {TRUTH}
