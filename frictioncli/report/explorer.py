"""What the explorer on the page shows: k and tmax of the evaluated grid, replayed, in few bytes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from frictioncli import tables
from frictioncli.arrays import Array
from frictioncli.correction.settings import CorrectionSettings, ScheduleSettings
from frictioncli.diagnosis.documents.apply_extension import without_effects
from frictioncli.diagnosis.documents.extended_model import ExtendedModel, read_extended
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.plain_text import without_control_characters
from frictioncli.report.evaluation_figure import compared_criterion
from frictioncli.report.grid_replay import ReplayedPhase, ScheduleGrid, replayed_phases
from frictioncli.report.labels import (
    CRITERION_WORDS,
    TEMPERATURE_SYMBOLS,
    number_text,
    speed_text,
)
from frictioncli.report.missing_data import evaluation_missing
from frictioncli.report.results import MOST_RUNS, JointResults
from frictioncli.report.style import PHASE_WORDS
from frictioncli.workfiles import EVALUATION, EXTENDED

_MOST_POINTS = 400
"""Pairs of a phase that are drawn; ε is of all of them."""

_SAME = 1e-6
"""Two replays of one schedule differ by less than this, relatively, whatever the machine."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Explorer:
    """The explorer of one joint.

    Attributes
    ----------
    missing : str
        Why there is none; empty where there is.
    data : dict
        What its script draws, as JSON takes it.
    without_extended : str
        Why it has no switch for the extended model; empty where it has.
    """

    missing: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    without_extended: str = ""


def explorers(work: Path, results: list[JointResults]) -> dict[int, Explorer]:
    """Return the explorer of each joint.

    Parameters
    ----------
    work : Path
        The work folder.
    results : list of JointResults
        What the report draws from.
    """
    path = work / EVALUATION
    stated = tables.document(path).get("settings", {}) if path.exists() else {}
    extensions, models = _extended(work)
    found = {}
    for joint in results:
        if missing := evaluation_missing(joint) or _unevaluated(joint):
            found[joint.joint] = Explorer(missing=missing)
            continue
        try:
            found[joint.joint] = explorer(
                joint, stated, models.get(joint.joint), extensions.get(joint.joint)
            )
        except NotEnoughData as fault:
            found[joint.joint] = Explorer(missing=str(fault))
    return found


def _extended(work: Path) -> tuple[dict[int, ExtendedModel], dict[int, FrictionModel]]:
    if not (work / EXTENDED).exists():
        return {}, {}
    models = read_models(work / EXTENDED)
    return read_extended(work / EXTENDED), {model.joint: model for model in models}


def _unevaluated(results: JointResults) -> str:
    if compared_criterion(results, bounded=False):
        return ""
    return "No criterion with k and tmax was evaluated. It needs 'frictioncli evaluate'."


def explorer(
    results: JointResults,
    stated: Mapping[str, Any],
    model: FrictionModel | None,
    extension: ExtendedModel | None,
) -> Explorer:
    """Return the explorer of one joint.

    Parameters
    ----------
    results : JointResults
        The joint's results, evaluated by criterion ``first_degree`` or ``latest_degree``.
    stated : dict
        Settings of the evaluation.
    model, extension : FrictionModel and ExtendedModel, or None
        The extended model, if there is one.

    Raises
    ------
    NotEnoughData
        If the model cannot be corrected, or no phase heats or cools.
    """
    settings = CorrectionSettings(
        correction_speed=stated.get("correction_speed"),
        smoothing_degree=int(stated.get("smoothing_degree", 3)),
    )
    criterion = compared_criterion(results, bounded=False)
    rows = results.evaluation[results.evaluation["criterion"] == criterion]
    grid = ScheduleGrid(
        criterion=criterion,
        k=tuple(sorted(float(k) for k in rows["k"].unique())),
        tmax=tuple(sorted(float(tmax) for tmax in rows["tmax"].unique())),
    )
    runs = sorted(str(run) for run in rows["run"].unique())[:MOST_RUNS]
    replays = {
        "base": replayed_phases(results.torques, results.model, settings, grid, runs),
    }
    lacking = _lacking(extension)
    if model is not None and extension is not None and not lacking:
        bare, base, _ = without_effects(results.torques, model, extension)
        try:
            replays["extended"] = replayed_phases(bare, base, settings, grid, runs)
        except NotEnoughData as fault:
            lacking = f"The extended model cannot be corrected: {fault}."
    evaluated = "extended" if stated.get("extended") else "base"
    if evaluated not in replays or not _agree(replays[evaluated], results.evaluation, grid):
        return Explorer(
            missing="The evaluation is of another model than the one at hand, so its grid cannot be"
            " shown step by step. It needs 'frictioncli evaluate' again."
        )
    return Explorer(
        data={
            "unit": results.unit,
            "symbol": TEMPERATURE_SYMBOLS["motor"],
            "criterion": CRITERION_WORDS[criterion],
            "k": grid.k,
            "tmax": [round(tmax / 60.0, 4) for tmax in grid.tmax],
            "start": _start(results, grid),
            "evaluated": evaluated,
            "speeds": [
                {"text": speed_text(speed), "colour": style.colour, "marker": style.marker}
                for speed, style in sorted(results.styles.items())
            ],
            "models": {
                name: [_packed(phase, results) for phase in phases]
                for name, phases in replays.items()
            },
        },
        without_extended=lacking,
    )


def _lacking(extension: ExtendedModel | None) -> str:
    """Return why there is no extended model to switch to; empty where there is."""
    if extension is None:
        return "There is no extended model to switch to; 'frictioncli diagnose' makes one."
    if not extension.effects:
        return "The extended model adds nothing to the base model, so there is no switch to it."
    return ""


def _agree(phases: list[ReplayedPhase], evaluation: pd.DataFrame, grid: ScheduleGrid) -> bool:
    """Return whether the evaluation has the same errors and corrections as the replays."""
    keys = ["run", "phase", "k", "tmax"]
    table = evaluation[evaluation["criterion"].isin(("none", grid.criterion))].set_index(keys)
    settings = [(np.nan, np.nan), *product(grid.k, grid.tmax)]
    wanted = pd.MultiIndex.from_tuples(
        [(phase.run, phase.name, *setting) for phase in phases for setting in settings], names=keys
    )
    if not table.index.is_unique or not wanted.isin(table.index).all():
        return False
    own = table.reindex(wanted)
    errors = [value for phase in phases for value in (phase.uncorrected, *phase.epsilon)]
    tried = [n for phase in phases for n in (0, *(len(events.time) for events in phase.events))]
    return bool(
        np.allclose(own["epsilon"], errors, rtol=_SAME, atol=0.0)
        and np.array_equal(own["corrections"], tried)
    )


def _start(results: JointResults, grid: ScheduleGrid) -> tuple[int, int]:
    """Return the place of the simulated setting in the grid; of the usual one without it."""
    usual = ScheduleSettings()
    k, tmax = usual.k, usual.tmax
    if not results.schedule.empty and pd.notna(results.schedule["k"].iloc[0]):
        k, tmax = (float(results.schedule[name].iloc[0]) for name in ("k", "tmax"))
    return _nearest(grid.k, k), _nearest(grid.tmax, tmax)


def _nearest(values: tuple[float, ...], wanted: float) -> int:
    return int(np.argmin(np.abs(np.array(values) - wanted)))


def _packed(phase: ReplayedPhase, results: JointResults) -> dict[str, Any]:
    """Return a phase as the script takes it: schedules that several settings share stand once.

    Of each drawn pair the script gets the friction's error as a function of the correction: the
    temperature, what the temperature term is there, and what would be missed without it.
    """
    known: dict[tuple[Any, ...], int] = {}
    schedules: list[dict[str, Any]] = []
    settings = []
    for events in phase.events:
        steps = (
            tuple(_minutes(events.time)),
            tuple(_rounded(events.correction, 3)),
            tuple(np.flatnonzero(events.failed).tolist()),
        )
        if steps not in known:
            known[steps] = len(schedules)
            schedules.append({"time": steps[0], "step": steps[1], "failed": steps[2]})
        settings.append(known[steps])
    shown = np.unique(
        np.linspace(0, len(phase.time) - 1, min(len(phase.time), _MOST_POINTS)).astype(int)
    )
    speeds = sorted(results.styles)
    nearest = [int(np.argmin(np.abs(np.array(speeds) - speed))) for speed in phase.speed[shown]]
    return {
        "run": without_control_characters(phase.run),
        "phase": phase.name,
        "word": PHASE_WORDS[phase.name],
        "delta": phase.delta,
        "time": _minutes(phase.time[shown]),
        "speed": nearest,
        "temperature": _rounded(phase.temperature[shown], 2),
        "term": _rounded(phase.term[shown], 4),
        "error": _rounded(phase.error[shown], 4),
        "none": number_text(phase.uncorrected),
        "epsilon": [number_text(float(value)) for value in phase.epsilon],
        "settings": settings,
        "schedules": schedules,
    }


def _minutes(seconds: Array) -> list[float]:
    return _rounded(seconds / 60.0, 2)


def _rounded(values: Array, digits: int) -> list[float]:
    # adding zero makes -0.0 positive
    return [float(value) + 0.0 for value in np.round(values, digits)]
