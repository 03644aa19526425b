"""Trace folders from the joint simulator, with everything that is hidden in them beside."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from frictioncli import files
from frictioncli.errors import OptionError
from frictioncli.provenance import to_json
from frictioncli.simulator import defaults
from frictioncli.simulator.run import MANIFEST, RunSummary, prepare, write_run
from frictioncli.simulator.settings import SynthesisSettings

__all__ = ["TRUTH", "SynthesisSettings", "SynthesisSummary", "synthesize"]

TRUTH = "truth.json"
"""File that holds what the traces hide."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SynthesisSummary:
    """What was made, and what is hidden in it; ``str`` gives both."""

    folder: Path
    seed: int
    runs: tuple[RunSummary, ...]

    def made(self) -> str:
        """Return what was made."""
        lines = [f"{self.folder}: {len(self.runs)} simulated run(s), seed {self.seed}"]
        lines += [
            f"  {run.name}: {run.recordings} recordings, {run.rows} samples; "
            f"heat-up {run.heating / 60.0:.0f} min, cool-down {run.cooling / 60.0:.0f} min"
            for run in self.runs
        ]
        return "\n".join(lines)

    def hidden(self) -> str:
        """Return what the traces hide."""
        lines = [f"hidden (all of it in {self.folder / TRUTH}):"]
        lines += [
            f"  {run.name}: {run.motor_heat_share:.0%} of the heat enters at the motor, "
            f"ambient {run.ambient:.1f} °C at the start"
            for run in self.runs
        ]
        lines += [
            "  friction of three zones at three temperatures: "
            + ", ".join(f"{zone.name} ({zone.node})" for zone in defaults.ZONES)
        ]
        return "\n".join(lines)

    def __str__(self) -> str:
        return f"{self.made()}\n{self.hidden()}"


def synthesize(folder: Path, settings: SynthesisSettings | None = None) -> SynthesisSummary:
    """Simulate runs and write them as trace folders with a manifest each and the truth beside.

    Parameters
    ----------
    folder : Path
        Folder to make; a former synthesis there is replaced.
    settings : SynthesisSettings, optional
        What to simulate.

    Raises
    ------
    OptionError
        If a setting makes no sense, or the folder holds anything but a former synthesis.
    """
    settings = SynthesisSettings() if settings is None else settings
    settings.check()
    _refuse_foreign(folder)
    seeds = np.random.SeedSequence(settings.seed).spawn(settings.runs)
    runs = [prepare(settings, number, seed) for number, seed in enumerate(seeds)]
    summaries: list[RunSummary] = []
    truths: list[dict[str, Any]] = []
    with files.whole(folder) as draft:
        for run in runs:
            summary, truth = write_run(draft / run.name, run)
            summaries.append(summary)
            truths.append(truth)
        whole_truth = {
            "program": "frictioncli synthesize",
            "settings": asdict(settings),
            "runs": truths,
        }
        (draft / TRUTH).write_text(to_json(whole_truth), encoding="utf-8", newline="\n")
    return SynthesisSummary(folder=folder, seed=settings.seed, runs=tuple(summaries))


def _refuse_foreign(folder: Path) -> None:
    """Raise OptionError if ``folder`` holds anything that a synthesis did not write."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise OptionError(f"{folder}: is a file, expected a folder to make; choose another name")
    present = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    foreign = sorted(present - _files_of_synthesis(folder / TRUTH))
    if foreign:
        raise OptionError(
            f"{folder}: holds {foreign[0]}, which no former synthesis wrote; "
            "choose a new or an empty folder"
        )


def _files_of_synthesis(truth: Path) -> set[str]:
    """Return the files that a former synthesis wrote, none if ``truth`` does not tell."""
    try:
        runs = json.loads(truth.read_text(encoding="utf-8"))["runs"]
        named = {f"{run['name']}/{one['file']}" for run in runs for one in run["recordings"]}
        return named | {f"{run['name']}/{MANIFEST}" for run in runs} | {TRUTH}
    except (OSError, ValueError, KeyError, TypeError):
        return set()
