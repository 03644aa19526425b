"""Stages ``simulate`` and ``evaluate``: torques and model of a joint to schedule and errors."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli.arrays import Indices
from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.correction.deviation import Deviation, estimated_deviation, probes_of
from frictioncli.correction.phases import CorrectionPhase, phases_of
from frictioncli.correction.replay import PhaseData, Replay, replay, replay_online
from frictioncli.correction.schedule import BY_READING, equally_spaced
from frictioncli.correction.settings import CorrectionSettings, EvaluationGrid, ScheduleSettings
from frictioncli.correction.uncertainty import follow
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel


class Evaluation(NamedTuple):
    """Rows of :data:`frictioncli.schemas.EVALUATION`, and what could not be evaluated and why."""

    rows: pd.DataFrame
    notes: tuple[str, ...]


def simulate(
    torques: pd.DataFrame,
    model: FrictionModel,
    settings: CorrectionSettings,
    schedule: ScheduleSettings,
) -> pd.DataFrame:
    """Simulate Algorithm 3 on one joint; return rows of :data:`frictioncli.schemas.SCHEDULE`.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    model : FrictionModel
        Its model.
    settings : CorrectionSettings
        How corrections are computed.
    schedule : ScheduleSettings
        When to correct.

    Raises
    ------
    NotEnoughData
        If the joint has no heat-up or cool-down, its model does not know temperature, or the pairs
        are too few to see how uncertain friction becomes, where the criterion asks for it.
    """
    phases = phases_of(torques, model, settings)
    highest = float(torques["speed"].max())
    process = _deviation(phases, model) if schedule.criterion == "uncertainty" else None
    tables = []
    for phase in phases:
        result = _simulated(phase.data, model, schedule, process, highest)
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
    Where the pairs are too few for that criterion, it is left out and a note says so.

    Parameters
    ----------
    torques, model, settings
        As :func:`simulate`.
    grid : EvaluationGrid
        The values of k, tmax and the bound.
    """
    phases = phases_of(torques, model, settings)
    highest = float(torques["speed"].max())
    process, notes = None, []
    try:
        process = _deviation(phases, model)
    except NotEnoughData as fault:
        notes.append(f"left out: {fault}")
    rules = _rules(grid, bounds=grid.bound if process else ())
    rows = []
    for phase in phases:
        results = list(
            zip(rules, _replays(phase.data, model, rules, process, highest), strict=True)
        )
        rows += [_row(phase, model, rule.criterion, rule, result) for rule, result in results]
        rows += [
            _row(phase, model, "equal", rule, _evenly(phase.data, model, result))
            for rule, result in results
            if rule.criterion in ("first_degree", "uncertainty")
        ]
    return Evaluation(_pooled(pd.DataFrame(rows)), tuple(notes))


def _rules(grid: EvaluationGrid, bounds: Sequence[float]) -> list[ScheduleSettings]:
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
    rule: ScheduleSettings,
    result: Replay,
) -> dict[str, object]:
    return {
        "run": phase.run,
        "joint": model.joint,
        "phase": phase.name,
        **(rule.columns() | {"criterion": criterion}),
        "corrections": int(result.corrected.sum()),
        "failed": int(result.failed.sum()),
        "pairs": len(phase.pairs),
        "epsilon": result.epsilon(phase.data.smoothed),
        "epsilon_unsmoothed": result.epsilon(phase.data.friction),
    }


def _pooled(rows: pd.DataFrame) -> pd.DataFrame:
    """Put several phases of one kind in a run (a second thermal cycle) into one row."""
    keys = ["run", "joint", "phase", "criterion", "k", "tmax", "bound"]
    squares = {
        name: np.square(rows[name]) * rows["pairs"] for name in ("epsilon", "epsilon_unsmoothed")
    }
    grouped = rows.assign(**squares).groupby(keys, sort=False, dropna=False, as_index=False)
    total = grouped[["corrections", "failed", "pairs", *squares]].sum()
    for name in squares:
        total[name] = np.sqrt(total[name] / total["pairs"])
    return total.drop(columns="pairs")


def _deviation(phases: list[CorrectionPhase], model: FrictionModel) -> Deviation:
    """Return how friction departs from the motor temperature, from all phases of the joint."""
    numbers = pd.factorize(np.array([phase.run for phase in phases], dtype=object))[0]
    probes = probes_of(
        [(int(number), phase.data) for number, phase in zip(numbers, phases, strict=True)],
        model.friction,
    )
    try:
        return estimated_deviation(probes)
    except NotEnoughData as fault:
        raise NotEnoughData(f"joint {model.joint}: {fault}") from None


def _simulated(
    data: PhaseData,
    model: FrictionModel,
    schedule: ScheduleSettings,
    process: Deviation | None,
    highest: float,
) -> Replay:
    """Return what one schedule does, as a robot at work would, told pair by pair.

    Evenly spaced corrections are as many as the paper's are.
    """
    if process is not None:
        return follow(data, model.friction, process, bound=schedule.bound, speed=highest)
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
    rules: Sequence[ScheduleSettings],
    process: Deviation | None,
    highest: float,
) -> list[Replay]:
    """Return what each of the rules does in a phase."""
    instants: dict[ScheduleSettings, Indices] = {}
    for criterion, reading in BY_READING.items():
        own = [rule for rule in rules if rule.criterion == criterion]
        k, tmax = np.array([rule.k for rule in own]), np.array([rule.tmax for rule in own])
        found = reading(data.time, data.reading, k=k, tmax=tmax)
        instants |= dict(zip(own, found, strict=True))
    results = []
    for rule in rules:
        if rule.criterion == "uncertainty":
            assert process is not None  # estimated wherever the criterion is asked for
            result = follow(data, model.friction, process, bound=rule.bound, speed=highest)
        else:
            result = replay(data, model.friction, instants.get(rule, ()))
        results.append(result)
    return results


def _evenly(data: PhaseData, model: FrictionModel, like: Replay) -> Replay:
    """Return what as many corrections do when they are equally spaced in time."""
    count = int(like.corrected.sum())
    return replay(data, model.friction, equally_spaced(data.time, count))


def epsilon(rows: pd.DataFrame, reference: str) -> float:
    """Return the error (21) of schedule rows against one of their friction columns. [N·m]."""
    return float(np.sqrt(np.mean(np.square(rows["friction_predicted"] - rows[reference]))))


def evaluation_text(rows: pd.DataFrame, unit: str) -> str:
    """Return the median error at each number of corrections, heating and cooling side by side."""
    lines = []
    for (run, joint), group in rows.groupby(["run", "joint"], sort=False):
        never = group[group["criterion"] == "none"].set_index("phase")["epsilon"]
        lines.append(f"{run}, joint {joint}: epsilon [{unit}] by number of corrections")
        for phase, part in group.groupby("phase", sort=False):
            lines.append(
                f"  {phase:9s} none: {never[phase]:.2f}  {_by_count(part, 'first_degree')}"
            )
            if (part["criterion"] == "uncertainty").any():
                lines.append(f"  {'':9s} by uncertainty  {_by_count(part, 'uncertainty')}")
    return "\n".join(lines)


def _by_count(rows: pd.DataFrame, criterion: str) -> str:
    chosen = rows[rows["criterion"] == criterion]
    median = chosen.groupby("corrections")["epsilon"].median().head(15)
    return "  ".join(f"{count}: {value:.2f}" for count, value in median.items())
