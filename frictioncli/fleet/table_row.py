"""Row of a joint in the fleet's table, from the files of its work folder."""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from frictioncli import documents, schemas, tables
from frictioncli.comparison.change import change_of_last_run
from frictioncli.correction.evaluation import epsilon
from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.model.friction import friction_torque
from frictioncli.workfiles import DIAGNOSIS, MODEL, SCHEDULE, TORQUES

_PHASES = {"heat-up": "heating", "cool-down": "cooling"}


def table_row(work: Path) -> dict[str, Any]:
    """Return the row of a joint; columns without a value are absent.

    Parameters
    ----------
    work : Path
        Work folder after the chain has run.
    """
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    # only the logs of one joint were read, so there is one model
    model = read_models(work / MODEL)[0]
    row = _model_columns(model) | _reference_columns(model) | _schedule_columns(work)
    row |= _diagnosis_columns(work)
    change = change_of_last_run(torques, model)
    if change is not None:
        row |= _with_interval("change", change.estimate, change.ci95)
        row["friction_by_run"] = list(change.by_run)
    return {name: _plain(value) for name, value in row.items()}


def unused_runs(work: Path, runs: Iterable[str]) -> list[str]:
    """Return the runs without pairs.

    Parameters
    ----------
    work : Path
        Work folder after the chain has run.
    runs : iterable of str
        Names of all runs.
    """
    used = set(tables.read(work / TORQUES, schemas.TORQUES)["run"].unique())
    return [run for run in runs if run not in used]


def _model_columns(model: FrictionModel) -> dict[str, Any]:
    """Return the parameters with their intervals, and the misfit."""
    row: dict[str, Any] = {
        "torque_unit": model.torque_unit,
        "temperature": model.temperature,
        "rmse": model.rmse,
        "n_pairs": model.n_pairs,
    }
    for name, entry in model.parameters.items():
        row |= _with_interval(name, entry.estimate, entry.ci95)
        row |= {f"{name}_unit": entry.unit, f"{name}_determined": entry.determined}
    return row


def _reference_columns(model: FrictionModel) -> dict[str, Any]:
    """Return friction without load at the middle speed, at temperatures within the data."""
    speeds, temperatures = model.range.speed, model.range.temperature
    if speeds is None:
        return {}
    speed = sum(speeds) / 2
    row: dict[str, Any] = {"reference_speed": speed}
    for temperature in schemas.REFERENCE_TEMPERATURES:
        if temperatures is not None and temperatures[0] <= temperature <= temperatures[1]:
            row[f"friction_{temperature}"] = float(
                friction_torque(model.friction, load=0.0, speed=speed, temperature=temperature)
            )
    return row


def _schedule_columns(work: Path) -> dict[str, Any]:
    """Return the error of the corrected friction and the corrections per run, by phase."""
    if not (work / SCHEDULE).exists():
        return {}
    schedule = tables.read(work / SCHEDULE, schemas.SCHEDULE)
    row: dict[str, Any] = {}
    for phase, rows in schedule.groupby("phase"):
        kind = _PHASES[str(phase)]
        row[f"epsilon_{kind}"] = epsilon(rows, "friction_smoothed")
        row[f"corrections_{kind}"] = float(rows["corrected"].sum() / rows["run"].nunique())
    return row


def _diagnosis_columns(work: Path) -> dict[str, Any]:
    """Return the verdict, the causes and the gain."""
    if not (work / DIAGNOSIS).exists():
        return {}
    document = documents.read(work / DIAGNOSIS, DiagnosisDocument, "diagnose")
    row: dict[str, Any] = {"verdict": document.verdict, "causes": causes_text(document.causes)}
    gain = document.gain
    if gain is not None:
        row |= _with_interval("gain", gain.reduction, gain.ci95)
        row["gain_basis"] = gain.basis
    return row


def causes_text(causes: Sequence[CauseRecord]) -> str:
    """Return the causes of a diagnosis, strongest first: ``thermal_lag; drift or run_in``.

    Properties of the measurement are findings like others; what is only visible is not listed.

    Parameters
    ----------
    causes : sequence of CauseRecord
        The causes.
    """
    named = [" or ".join(cause.effects) or "unnamed" for cause in causes]
    return "; ".join(named)


def _with_interval(name: str, value: Any, interval: Any) -> dict[str, Any]:
    low, high = (None, None) if interval is None else interval
    return {name: value, f"{name}_low": low, f"{name}_high": high}


def _plain(value: Any) -> Any:
    """Return a value as JSON has it; None for what is not finite."""
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
