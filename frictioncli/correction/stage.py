"""Stages ``simulate`` and ``evaluate``: torques and model of a joint to schedule and errors."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from frictioncli.correction.replay import PhaseData, Replay, phase_data, replay
from frictioncli.correction.schedule import equally_spaced, first_degree, latest_degree
from frictioncli.correction.settings import (
    CRITERIA,
    CorrectionSettings,
    EvaluationGrid,
    ScheduleSettings,
)
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel
from frictioncli.model.zero_load import friction_at_zero_load

_READINGS = {"first_degree": first_degree, "latest_degree": latest_degree}

_MIDDLE = 2 / 3
"""The paper corrects at 67.5 deg/s, two thirds of its highest speed."""


@dataclass(frozen=True, slots=True)
class _Phase:
    """The pairs of one phase, and as arrays."""

    run: str
    name: str
    pairs: pd.DataFrame
    data: PhaseData


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
        If the joint has no heat-up or cool-down, or its model does not know temperature.
    """
    tables = []
    for phase in _phases(torques, model, settings):
        result = _replayed(phase.data, model, schedule)
        table = phase.pairs[["run", "joint", "pair", "speed", "time", "phase"]].assign(
            **asdict(schedule),
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
) -> pd.DataFrame:
    """Evaluate all criteria over a grid; return rows of :data:`frictioncli.schemas.EVALUATION`.

    The rows with criterion ``equal`` have as many corrections, equally spaced in time, as the
    ``first_degree`` row with the same k and tmax.

    Parameters
    ----------
    torques, model, settings
        As :func:`simulate`.
    grid : EvaluationGrid
        The values of k and tmax.
    """
    cells = [ScheduleSettings(criterion="none")]
    cells += [
        ScheduleSettings(criterion=criterion, k=k, tmax=tmax)
        for criterion in CRITERIA
        if criterion != "none"
        for k in grid.k
        for tmax in grid.tmax
    ]
    rows = []
    for phase in _phases(torques, model, settings):
        for cell in cells:
            result = _replayed(phase.data, model, cell)
            never = cell.criterion == "none"
            rows.append(
                {
                    "run": phase.run,
                    "joint": model.joint,
                    "phase": phase.name,
                    "criterion": cell.criterion,
                    "k": np.nan if never else cell.k,
                    "tmax": np.nan if never else cell.tmax,
                    "corrections": int(result.corrected.sum()),
                    "failed": int(result.failed.sum()),
                    "pairs": len(phase.pairs),
                    "epsilon": result.epsilon(phase.data.smoothed),
                    "epsilon_unsmoothed": result.epsilon(phase.data.friction),
                }
            )
    return _pooled(pd.DataFrame(rows))


def _pooled(rows: pd.DataFrame) -> pd.DataFrame:
    """Put several phases of one kind in a run (a second thermal cycle) into one row."""
    keys = ["run", "joint", "phase", "criterion", "k", "tmax"]
    squares = {
        name: np.square(rows[name]) * rows["pairs"] for name in ("epsilon", "epsilon_unsmoothed")
    }
    grouped = rows.assign(**squares).groupby(keys, sort=False, dropna=False, as_index=False)
    total = grouped[["corrections", "failed", "pairs", *squares]].sum()
    for name in squares:
        total[name] = np.sqrt(total[name] / total["pairs"])
    return total.drop(columns="pairs")


def _phases(
    torques: pd.DataFrame, model: FrictionModel, settings: CorrectionSettings
) -> Iterator[_Phase]:
    """Yield each stretch of heat-up or cool-down of the joint."""
    if not model.knows_temperature:
        raise NotEnoughData(
            f"joint {model.joint}: the model does not know how friction falls with temperature"
            f" ({model.parameters['delta'].reason}), so a correction cannot be computed"
        )
    pairs = friction_at_zero_load(torques, model.friction.alpha)
    pairs = pairs[pairs["motor_temperature"].notna()]
    if "motor_temperature_reading" not in pairs:
        pairs = pairs.assign(motor_temperature_reading=np.nan)
    stretch = (pairs["phase"] != pairs["phase"].shift()) | (pairs["run"] != pairs["run"].shift())
    thermal = pairs["phase"].isin(["heat-up", "cool-down"])
    if not thermal.any():
        raise NotEnoughData(
            f"joint {model.joint}: no heat-up or cool-down of 5 °C or more in the log, so the"
            " correction of temperature cannot be simulated; log a thermal cycle"
        )
    speed = settings.correction_speed
    if speed is None:
        speed = _MIDDLE * float(pairs.loc[thermal, "speed"].max())
    for _, group in pairs[thermal].groupby(stretch.cumsum()[thermal], sort=True):
        data = phase_data(group, correction_speed=speed, degree=settings.smoothing_degree)
        head = group.iloc[0]
        yield _Phase(str(head["run"]), str(head["phase"]), group, data)


def _replayed(data: PhaseData, model: FrictionModel, schedule: ScheduleSettings) -> Replay:
    if schedule.criterion == "none":
        return replay(data, model.friction, [])
    reading = _READINGS.get(schedule.criterion, first_degree)
    events = reading(data.time, data.reading, k=schedule.k, tmax=schedule.tmax)
    if schedule.criterion == "equal":
        events = equally_spaced(data.time, len(events))
    return replay(data, model.friction, events)


def epsilon(rows: pd.DataFrame, reference: str) -> float:
    """Return the error (21) of schedule rows against one of their friction columns. [N·m]."""
    return float(np.sqrt(np.mean(np.square(rows["friction_predicted"] - rows[reference]))))


def evaluation_text(rows: pd.DataFrame, unit: str) -> str:
    """Return the median error at each number of corrections, heating and cooling side by side."""
    lines = []
    for (run, joint), group in rows.groupby(["run", "joint"], sort=False):
        never = group[group["criterion"] == "none"].set_index("phase")["epsilon"]
        lines.append(f"{run}, joint {joint}: epsilon [{unit}] by number of corrections")
        for phase, part in group[group["criterion"] == "first_degree"].groupby("phase", sort=False):
            median = part.groupby("corrections")["epsilon"].median().head(15)
            told = "  ".join(f"{count}: {value:.2f}" for count, value in median.items())
            lines.append(f"  {phase:9s} none: {never[phase]:.2f}  {told}")
    return "\n".join(lines)
