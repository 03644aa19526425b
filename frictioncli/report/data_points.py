"""Measured and simulated torque of every move, for the chart that looks into the data."""

from base64 import b64encode
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.diagnosis.documents.reload import Misfits, Reloaded
from frictioncli.model.zero_load import PAIR_KEY, temperature_of
from frictioncli.plain_text import without_control_characters
from frictioncli.report.binning import is_warming
from frictioncli.report.map_cells import map_cells, outside
from frictioncli.report.results import JointResults

MOST_ROWS = 50_000
"""Rows on a page: each has seven numbers of two bytes, so that these take less than 1 MB."""

_LEVELS = 65535
_RISING, _FALLING, _STEADY = 1, -1, 0
_DIRECTIONS = (("forward", 1.0), ("reverse", -1.0))


def data_points(results: JointResults, *, most_rows: int = MOST_ROWS) -> dict[str, Any]:
    """Return the points of one joint in the form that the script reads.

    With a diagnosis, the simulated torque is that of the models fitted to its runs, friction and
    gravity. Without one it has the measured load torque, so that only friction can be missed.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    most_rows : int
        Greatest number of pairs and angles; beyond that, evenly spaced pairs are left out.
    """
    diagnosis = results.diagnosis
    rows = _of_model(results) if diagnosis is None else _of_diagnosis(results, diagnosis)
    count = int(rows["pair"].iloc[-1]) + 1
    step = int(np.ceil(len(rows) / most_rows))
    rows = rows[rows["pair"] % step == 0]
    pairs = rows.drop_duplicates("pair")
    columns = [name for name in rows.columns if name.startswith(("angle", "u_", "base_", "ext_"))]
    temperatures = [name for name in ("motor", "housing") if pairs[name].notna().any()]
    runs = {run: number for number, run in enumerate(results.runs)}
    return {
        "unit": results.unit,
        "sign": results.model.sign,
        "runs": [without_control_characters(run) for run in runs],
        "moves": count,
        "step": step,
        "extended": "ext_forward" in columns,
        "load": results.load_unit == results.unit,
        "run": [runs[str(run)] for run in pairs["run"]],
        "number": [int(pair) + 1 for pair in pairs["pair"]],
        "length": [int(size) for size in rows.groupby("pair").size()],
        "time": _rounded(pairs["time"].to_numpy(float) / 60.0, 2),
        "speed": _rounded(pairs["speed"].to_numpy(float), 2),
        "trend": [int(trend) for trend in pairs["trend"]],
        "temperatures": {name: _rounded(pairs[name].to_numpy(float), 2) for name in temperatures},
        "columns": {name: _packed(rows[name].to_numpy(float)) for name in columns},
        "cells": _cells(results, count, step),
    }


def _cells(results: JointResults, count: int, step: int) -> dict[str, Any]:
    """Return the cells of the residual maps by move; nothing without a diagnosis."""
    if results.diagnosis is None:
        return {}
    seen = results.diagnosis.seen
    cells = map_cells(seen, results.model.temperature)
    cells = outside(cells, count - len(np.unique(seen.problem.table.pair)))
    return {
        name: own | ({"move": own["move"][::step]} if "move" in own else {})
        for name, own in cells.items()
    }


def _of_diagnosis(results: JointResults, diagnosis: Reloaded) -> pd.DataFrame:
    """Return the rows of the diagnosis: first the runs that it has learned from."""
    extended = bool(diagnosis.seen.terms)
    known = [part for part in (diagnosis.seen, diagnosis.new) if part is not None]
    parts = [_misfit_rows(results, part, extended=extended) for part in known]
    rows = pd.concat(parts, ignore_index=True)
    return rows.assign(pair=_numbered(rows, ["run", "pair"]))


def _misfit_rows(results: JointResults, misfits: Misfits, *, extended: bool) -> pd.DataFrame:
    problem, table = misfits.problem, misfits.problem.table
    names = dict(zip(np.unique(table.run), problem.runs, strict=True))
    trend = np.full(len(table.pair), _STEADY)
    if np.ptp(np.nan_to_num(table.measured_temperature)) > 0:
        trend = np.where(is_warming(table), _RISING, _FALLING)
    rows = pd.DataFrame(
        {
            "run": [names[run] for run in table.run],
            "pair": table.pair,
            "time": table.time,
            "speed": table.speed,
            "motor": table.motor_temperature,
            "housing": table.housing_temperature,
            "trend": trend,
            "angle": table.position,
        }
    )
    # a log's own load channel is in N·m, where torque is a current: friction alone can be shown
    share = 1.0 if results.load_unit == results.unit else 0.0
    for name, sign in _DIRECTIONS:
        direction = sign * results.model.sign
        rows[f"u_{name}"] = share * problem.load + direction * problem.friction
        for model, misfit in (("base", misfits.before), ("ext", misfits.after)):
            if model == "base" or extended:
                missed = share * misfit["load"] + direction * misfit["friction"]
                rows[f"{model}_{name}"] = missed
    return rows


def _of_model(results: JointResults) -> pd.DataFrame:
    """Return all rows with what the friction function misses."""
    torques = results.torques.sort_values(["run", "time", "pair", "position"], kind="stable")
    predicted = results.predict(
        load=torques["load_torque"],
        speed=torques["speed"],
        temperature=temperature_of(torques, results.model.temperature),
    )
    friction = torques["friction_torque"].to_numpy(float)
    freed = results.friction()["friction_torque"].loc[torques.index].to_numpy(float)
    load = torques["load_torque"].to_numpy(float)
    phases = torques["phase"].astype(str)
    rows = pd.DataFrame(
        {
            "run": torques["run"].astype(str),
            "time": torques["time"],
            "speed": torques["speed"],
            "motor": torques["motor_temperature"],
            "housing": torques["housing_temperature"],
            "trend": np.select(
                [phases == "heat-up", phases == "cool-down"], [_RISING, _FALLING], _STEADY
            ),
            "angle": torques["position"],
        }
    )
    share = 1.0 if results.load_unit == results.unit else 0.0
    for name, sign in _DIRECTIONS:
        direction = sign * results.model.sign
        rows[f"u_{name}"] = share * load + direction * friction
        rows[f"base_{name}"] = direction * (freed - predicted)
    rows = rows.assign(pair=_numbered(torques, PAIR_KEY)).reset_index(drop=True)
    known = rows[["u_forward", "base_forward"]].notna().all(axis=1)
    return rows[known].reset_index(drop=True)


def _numbered(rows: pd.DataFrame, key: list[str]) -> Array:
    """Return the number of each row's pair, from 0 in the order of the rows."""
    return np.asarray(rows.groupby(key, sort=False).ngroup())


def _packed(values: Array) -> Mapping[str, Any]:
    """Return values as 16-bit numbers in base64, with the least value and the step."""
    low, high = float(values.min()), float(values.max())
    step = (high - low) / _LEVELS or 1.0
    levels = np.round((values - low) / step).astype("<u2")
    return {"low": low, "step": step, "levels": b64encode(levels.tobytes()).decode()}


def _rounded(values: Array, digits: int) -> list[float | None]:
    # adding zero makes -0.0 positive
    return [
        float(value) + 0.0 if np.isfinite(value) else None for value in np.round(values, digits)
    ]
