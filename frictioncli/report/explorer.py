"""Data of the interactive explorer: corrections and errors over a grid of k and tmax."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.correction.settings import CorrectionSettings, ScheduleSettings
from frictioncli.diagnosis.documents.apply_extension import without_effects
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.errors import NotEnoughData
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.plain_text import without_control_characters
from frictioncli.report.evaluation_figure import compared_criterion
from frictioncli.report.grid_replay import ReplayedPhase, ScheduleGrid, replayed_phases
from frictioncli.report.labels import CRITERION_WORDS, TEMPERATURE_SYMBOLS
from frictioncli.report.missing_data import evaluation_missing
from frictioncli.report.recommendation import recommended_setting
from frictioncli.report.results import MOST_RUNS, JointResults
from frictioncli.report.style import PHASE_WORDS
from frictioncli.report.target_error import target_error
from frictioncli.wording import number_text, speed_text

_MOST_POINTS = 400
"""Greatest number of pairs drawn per phase; ε is computed from all pairs."""

_TOLERANCE = 1e-6
"""Relative tolerance in comparing errors of the same schedule computed on different machines."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Explorer:
    """The explorer of one joint.

    Attributes
    ----------
    missing : str
        Why there is none; empty if there is one.
    data : dict
        Data for its script, to be written as JSON.
    without_extended : str
        Why it has no switch for the extended model; empty if it has one.
    """

    missing: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    without_extended: str = ""


def explorer(results: JointResults) -> Explorer:
    """Return the explorer of one joint, or why there is none.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    if missing := evaluation_missing(results) or _criterion_missing(results):
        return Explorer(missing=missing)
    try:
        return _explorer(results)
    except NotEnoughData as fault:
        return Explorer(missing=str(fault))


def _criterion_missing(results: JointResults) -> str:
    if compared_criterion(results, bounded=False):
        return ""
    return "No criterion with k and tmax was evaluated. It needs 'frictioncli evaluate'."


def _explorer(results: JointResults) -> Explorer:
    """Replay the evaluated grid with the base model and, if there is one, the extended model.

    Raises
    ------
    NotEnoughData
        If the base model cannot be corrected, or no phase heats or cools.
    """
    stated = results.evaluation_settings
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
    runs = runs_in_order(rows)[:MOST_RUNS]
    replays = {"base": replayed_phases(results.torques, results.model, settings, grid, runs)}
    model, extension = results.extended_model, results.extension
    without_extended = _extension_missing(extension)
    if model is not None and extension is not None and not without_extended:
        torques, base, _ = without_effects(results.torques, model, extension)
        try:
            replays["extended"] = replayed_phases(torques, base, settings, grid, runs)
        except NotEnoughData as fault:
            without_extended = f"The extended model cannot be corrected: {fault}."
    evaluated = "extended" if results.evaluated_extended else "base"
    if evaluated not in replays or not _agree(replays[evaluated], results.evaluation, grid):
        return Explorer(
            missing="The evaluation is of another model than the one at hand, so its grid cannot be"
            " shown step by step. It needs 'frictioncli evaluate' again."
        )
    target = target_error(results)
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
                name: [_phase_data(phase, results, target) for phase in phases]
                for name, phases in replays.items()
            },
            "recommended": {
                name: recommended_setting(phases, target) for name, phases in replays.items()
            },
        },
        without_extended=without_extended,
    )


def _extension_missing(extension: ExtendedModel | None) -> str:
    """Return why there is no extended model to switch to; empty if there is one."""
    if extension is None:
        return "There is no extended model to switch to; 'frictioncli diagnose' makes one."
    if extension.adds_nothing:
        return "The extended model adds nothing to the base model, so there is no switch to it."
    return ""


def _agree(phases: list[ReplayedPhase], evaluation: pd.DataFrame, grid: ScheduleGrid) -> bool:
    """Return whether errors and numbers of corrections of evaluation and replays agree."""
    keys = ["run", "phase", "k", "tmax"]
    table = evaluation[evaluation["criterion"].isin(("none", grid.criterion))].set_index(keys)
    settings = [(np.nan, np.nan), *product(grid.k, grid.tmax)]
    settings_index = pd.MultiIndex.from_tuples(
        [(phase.run, phase.name, *setting) for phase in phases for setting in settings], names=keys
    )
    if not table.index.is_unique or not settings_index.isin(table.index).all():
        return False
    own = table.reindex(settings_index)
    errors = [value for phase in phases for value in (phase.uncorrected, *phase.epsilon)]
    corrections = [
        n for phase in phases for n in (0, *(len(events.time) for events in phase.events))
    ]
    return bool(
        np.allclose(own["epsilon"], errors, rtol=_TOLERANCE, atol=0.0)
        and np.array_equal(own["corrections"], corrections)
    )


def _start(results: JointResults, grid: ScheduleGrid) -> tuple[int, int]:
    """Return the indices in the grid of the simulated setting, or else of the default setting."""
    default = ScheduleSettings()
    k, tmax = default.k, default.tmax
    if not results.schedule.empty and pd.notna(results.schedule["k"].iloc[0]):
        k, tmax = (float(results.schedule[name].iloc[0]) for name in ("k", "tmax"))
    return _nearest(grid.k, k), _nearest(grid.tmax, tmax)


def _nearest(values: Sequence[float], target: float) -> int:
    return int(np.argmin(np.abs(np.array(values) - target)))


def _phase_data(phase: ReplayedPhase, results: JointResults, target: float) -> dict[str, Any]:
    """Return a phase in the form that the script reads; equal schedules are stored once.

    For each drawn pair it holds what the script needs to compute the error of friction for any
    temperature correction: the temperature, the temperature term, and the error without correction.
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
    nearest = [_nearest(speeds, speed) for speed in phase.speed[shown]]
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
        "target": target,
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
