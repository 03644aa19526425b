"""Simulation of the correction on one joint, and evaluation of criteria over a grid."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli.arrays import Indices
from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.correction.deviation import (
    DeviationProcess,
    correction_pairs_of,
    fit_deviation_process,
)
from frictioncli.correction.phases import CorrectionPhase, correction_phases
from frictioncli.correction.replay import PhaseData, Replay, replay, replay_online
from frictioncli.correction.schedule import BY_READING, equally_spaced
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.correction.uncertainty import replay_with_filter
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel
from frictioncli.wording import number_text

_MOST_COUNTS = 15
"""Most numbers of corrections that a line of text lists."""


class Evaluation(NamedTuple):
    """Result of the evaluation.

    Attributes
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.EVALUATION`.
    notes : tuple of str
        Criteria that could not be evaluated, with the reason.
    """

    rows: pd.DataFrame
    notes: tuple[str, ...]


def simulate(
    torques: pd.DataFrame,
    model: FrictionModel,
    settings: CorrectionSettings,
    schedule: ScheduleSettings,
) -> pd.DataFrame:
    """Simulate Algorithm 3 on one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    model : FrictionModel
        Model of the joint.
    settings : CorrectionSettings
        Settings of the corrections.
    schedule : ScheduleSettings
        Criterion that decides when to correct.

    Returns
    -------
    DataFrame
        Rows of :data:`frictioncli.schemas.SCHEDULE`.

    Raises
    ------
    NotEnoughData
        If the joint has no heat-up or cool-down, its model does not depend on temperature, or the
        criterion is ``uncertainty`` and there are too few pairs to estimate the process.
    """
    phases = correction_phases(torques, model, settings)
    highest = float(torques["speed"].max())
    process = _deviation_process(phases, model) if schedule.criterion == "uncertainty" else None
    tables = []
    for phase in phases:
        result = _simulate_phase(phase.data, model, schedule, process, highest)
        table = phase.pairs[["run", "joint", "pair", "speed", "time", "phase"]].assign(
            **schedule.columns(),
            temperature_parameter=phase.data.temperature + result.correction,
            temperature_correction=result.correction,
            corrected=result.corrected,
            failed=result.failed,
            friction_torque=phase.data.friction,
            friction_smoothed=phase.data.smoothed,
            friction_predicted=result.predicted,
        )
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def evaluate(
    torques: pd.DataFrame,
    model: FrictionModel,
    settings: CorrectionSettings,
    grid: EvaluationGrid,
) -> Evaluation:
    """Evaluate all criteria over a grid.

    The rows with criterion ``equal`` have as many corrections, equally spaced in time, as the
    ``first_degree`` row with the same k and tmax, or the ``uncertainty`` row with the same bound.
    With too few pairs for the criterion ``uncertainty``, it is left out and a note states why.

    Parameters
    ----------
    torques, model, settings
        As for :func:`simulate`.
    grid : EvaluationGrid
        Values of k, tmax and the bound.

    Returns
    -------
    Evaluation
        Rows and notes.
    """
    phases = correction_phases(torques, model, settings)
    highest = float(torques["speed"].max())
    process, notes = None, []
    try:
        process = _deviation_process(phases, model)
    except NotEnoughData as fault:
        notes.append(f"left out: {fault}")
    schedules = _schedules(grid, bounds=grid.bound if process else ())
    rows = []
    for phase in phases:
        results = list(
            zip(schedules, _replays(phase.data, model, schedules, process, highest), strict=True)
        )
        rows += [
            _row(phase, model, schedule.criterion, schedule, result) for schedule, result in results
        ]
        rows += [
            _row(phase, model, "equal", schedule, _replay_equally_spaced(phase.data, model, result))
            for schedule, result in results
            if schedule.criterion in ("first_degree", "uncertainty")
        ]
    return Evaluation(_pooled(pd.DataFrame(rows)), tuple(notes))


def _schedules(grid: EvaluationGrid, bounds: Sequence[float]) -> list[ScheduleSettings]:
    by_time = [
        ScheduleSettings(criterion=reading, k=k, tmax=tmax)
        for reading in BY_READING
        for k in grid.k
        for tmax in grid.tmax
    ]
    by_bound = [ScheduleSettings(criterion="uncertainty", bound=bound) for bound in bounds]
    return [ScheduleSettings(criterion="none"), *by_time, *by_bound]


def _row(
    phase: CorrectionPhase,
    model: FrictionModel,
    criterion: str,
    schedule: ScheduleSettings,
    result: Replay,
) -> dict[str, object]:
    return {
        "run": phase.run,
        "joint": model.joint,
        "phase": phase.name,
        **(schedule.columns() | {"criterion": criterion}),
        "corrections": int(result.corrected.sum()),
        "failed": int(result.failed.sum()),
        "pairs": len(phase.pairs),
        "epsilon": result.epsilon(phase.data.smoothed),
        "epsilon_unsmoothed": result.epsilon(phase.data.friction),
    }


def _pooled(rows: pd.DataFrame) -> pd.DataFrame:
    """Pool the phases of one kind in a run, as of several thermal cycles, into one row."""
    keys = ["run", "joint", "phase", "criterion", "k", "tmax", "bound"]
    squares = {
        name: np.square(rows[name]) * rows["pairs"] for name in ("epsilon", "epsilon_unsmoothed")
    }
    grouped = rows.assign(**squares).groupby(keys, sort=False, dropna=False, as_index=False)
    total = grouped[["corrections", "failed", "pairs", *squares]].sum()
    for name in squares:
        total[name] = np.sqrt(total[name] / total["pairs"])
    return total.drop(columns="pairs")


def _deviation_process(phases: list[CorrectionPhase], model: FrictionModel) -> DeviationProcess:
    """Return the process of the deviation, fitted to all phases of the joint."""
    numbers = pd.factorize(np.array([phase.run for phase in phases], dtype=object))[0]
    pairs = correction_pairs_of(
        [(int(number), phase.data) for number, phase in zip(numbers, phases, strict=True)],
        model.friction,
    )
    try:
        return fit_deviation_process(pairs)
    except NotEnoughData as fault:
        raise NotEnoughData(f"joint {model.joint}: {fault}") from None


def _simulate_phase(
    data: PhaseData,
    model: FrictionModel,
    schedule: ScheduleSettings,
    process: DeviationProcess | None,
    highest: float,
) -> Replay:
    """Simulate one schedule in one phase, as in a controller, pair by pair.

    Equally spaced corrections are as many as those by criterion (20).
    """
    if process is not None:
        return replay_with_filter(
            data, model.friction, process, bound=schedule.bound, speed=highest
        )
    reading = schedule.criterion if schedule.criterion in BY_READING else "first_degree"

    def online(instants: ArrayLike | None = None) -> Replay:
        parameters, k, tmax = model.friction, schedule.k, schedule.tmax
        corrector = TemperatureCorrector(parameters, k=k, tmax=tmax, reading=reading)
        return replay_online(data, corrector, instants)

    if schedule.criterion == "none":
        return online(instants=())
    result = online()
    if schedule.criterion == "equal":
        return online(equally_spaced(data.time, int(result.corrected.sum())))
    return result


def _replays(
    data: PhaseData,
    model: FrictionModel,
    schedules: Sequence[ScheduleSettings],
    process: DeviationProcess | None,
    highest: float,
) -> list[Replay]:
    """Replay each schedule in one phase."""
    instants: dict[ScheduleSettings, Indices] = {}
    for criterion, reading in BY_READING.items():
        own = [one for one in schedules if one.criterion == criterion]
        k, tmax = np.array([one.k for one in own]), np.array([one.tmax for one in own])
        found = reading(data.time, data.reading, k=k, tmax=tmax)
        instants |= dict(zip(own, found, strict=True))
    results = []
    for schedule in schedules:
        if schedule.criterion == "uncertainty":
            assert process is not None  # fitted wherever the criterion is in the grid
            result = replay_with_filter(
                data, model.friction, process, bound=schedule.bound, speed=highest
            )
        else:
            result = replay(data, model.friction, instants.get(schedule, ()))
        results.append(result)
    return results


def _replay_equally_spaced(data: PhaseData, model: FrictionModel, other: Replay) -> Replay:
    """Replay as many corrections as in another replay, equally spaced in time."""
    count = int(other.corrected.sum())
    return replay(data, model.friction, equally_spaced(data.time, count))


def epsilon(rows: pd.DataFrame, reference: str) -> float:
    """Return the RMS error (21) of the predicted friction.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.SCHEDULE`.
    reference : str
        Column with the measured friction.

    Returns
    -------
    float
        Error. [torque unit]

    Examples
    --------
    >>> rows = pd.DataFrame({"friction_predicted": [50.0, 52.0], "friction_torque": [53.0, 49.0]})
    >>> epsilon(rows, "friction_torque")
    3.0
    """
    return float(np.sqrt(np.mean(np.square(rows["friction_predicted"] - rows[reference]))))


def evaluation_text(rows: pd.DataFrame, unit: str) -> str:
    """Return the text of an evaluation: median error by number of corrections, per phase."""
    lines = []
    for (run, joint), group in rows.groupby(["run", "joint"], sort=False):
        uncorrected = group[group["criterion"] == "none"].set_index("phase")["epsilon"]
        lines.append(
            f"{run}, joint {joint}: epsilon [{unit}] by number of corrections; where several"
            " settings give the same number, their median"
        )
        for phase, part in group.groupby("phase", sort=False):
            none = number_text(uncorrected[phase])
            lines.append(f"  {phase:9s} none: {none}  {_by_count(part, 'first_degree')}")
            if (part["criterion"] == "uncertainty").any():
                lines.append(f"  {'':9s} by uncertainty  {_by_count(part, 'uncertainty')}")
    return "\n".join(lines)


def _by_count(rows: pd.DataFrame, criterion: str) -> str:
    chosen = rows[rows["criterion"] == criterion]
    median = chosen.groupby("corrections")["epsilon"].median()
    texts = [f"{count}: {number_text(value)}" for count, value in median.head(_MOST_COUNTS).items()]
    more = len(median) - len(texts)
    return "  ".join(texts + ([f"({more} more)"] if more > 0 else []))
