"""A comparison as plain values: ``comparison.json``."""

from typing import Any

import numpy as np

from frictioncli.comparison.causes import CauseOfChange
from frictioncli.comparison.compare import Comparison
from frictioncli.comparison.day_to_day import LevelEstimate
from frictioncli.effects import BY_NAME

_HOURS = 1000.0


def comparison_document(comparison: Comparison) -> dict[str, Any]:
    """Return a comparison as plain values.

    Parameters
    ----------
    comparison : Comparison
        The comparison.
    """
    history = comparison.history
    model = history.models[-1]
    unit = model.torque_unit
    threshold = comparison.settings.fail_above
    return {
        "verdict": comparison.verdict,
        "weak": comparison.weak,
        "joint": model.joint,
        "torque_unit": unit,
        "load_unit": load_unit(comparison),
        "temperature": model.temperature,
        "folders": list(history.folders),
        "mean_friction": {"estimate": comparison.mean_friction, "unit": unit},
        "trend": _trend(comparison),
        "last_run": None
        if comparison.last_run is None
        else _change(comparison, comparison.last_run),
        "load": _percent(comparison.load) if comparison.load else None,
        "causes": [_cause(comparison, cause) for cause in comparison.causes],
        "friction": [
            {
                "temperature": one.temperature,
                "speed": one.speed,
                "load": one.load,
                "friction": one.friction,
                "change": one.change.value * one.friction / 100,
                "ci95": [one.change.low * one.friction / 100, one.change.high * one.friction / 100],
                "unit": unit,
                "percent": _percent(one.change),
                "extrapolated": one.extrapolated,
            }
            for one in comparison.conditions
        ],
        "parameters": {
            one.name: {
                "first": one.first,
                "last": one.last,
                "change": one.change,
                "ci95": None if one.ci95 is None else list(one.ci95),
                "unit": one.unit,
            }
            for one in comparison.parameters
        },
        "runs": _runs(comparison),
        "scatter": {
            "day_to_day": comparison.day_to_day,
            "assumed": comparison.settings.day_to_day,
            "unit": "%",
            "surroundings_from": history.ambient_source,
        },
        "margin": {"value": comparison.margin, "unit": "%"},
        "threshold": None
        if threshold is None
        else {
            "value": threshold.value,
            "unit": threshold.unit if threshold.unit == "%" else unit,
            "exceeded": comparison.exceeded,
        },
    }


def load_unit(comparison: Comparison) -> str:
    """Return the unit of the load torque: alpha is 1 over it, or torque over its square."""
    return comparison.history.models[-1].parameters["alpha"].unit.split("(")[1].split(")")[0]


def _percent(estimate: LevelEstimate) -> dict[str, Any]:
    return {
        "estimate": estimate.value,
        "ci95": [estimate.low, estimate.high],
        "unit": "%",
        "p_value": estimate.p_value,
    }


def _change(comparison: Comparison, estimate: LevelEstimate) -> dict[str, Any]:
    factor = comparison.mean_friction / 100
    return {
        "change": estimate.value * factor,
        "ci95": [estimate.low * factor, estimate.high * factor],
        "unit": comparison.history.models[-1].torque_unit,
        "percent": _percent(estimate),
    }


def _trend(comparison: Comparison) -> dict[str, Any]:
    trend, history = comparison.trend, comparison.history
    steps = len(comparison.levels) - 1
    found = _change(comparison, trend) | {
        "per_run": {
            "estimate": trend.value / steps,
            "ci95": [trend.low / steps, trend.high / steps],
            "unit": "%/run",
        },
        "per_1000_h": None,
    }
    if history.dated:
        factor = _HOURS / (24 * float(history.time[-1]))
        found["per_1000_h"] = {
            "estimate": trend.value * factor,
            "ci95": [trend.low * factor, trend.high * factor],
            "unit": "%/1000 h",
        }
    return found


def _cause(comparison: Comparison, cause: CauseOfChange) -> dict[str, Any]:
    return {
        "effects": list(cause.effects),
        "probabilities": cause.probabilities,
        "channel": cause.channel,
        "claim": cause.claim,
        "change": _percent(cause.change),
        "since": None
        if cause.change_point is None
        else comparison.history.runs[cause.change_point].label,
        "experiment": BY_NAME[cause.effects[0]].experiment,
    }


def _runs(comparison: Comparison) -> list[dict[str, Any]]:
    rows = zip(
        comparison.history.runs,
        comparison.history.time.tolist(),
        comparison.levels.tolist(),
        comparison.adjusted.tolist(),
        comparison.half_widths.tolist(),
        strict=True,
    )
    return [
        {
            "folder": run.folder,
            "run": run.run,
            "started_at": None if run.started_at is None else run.started_at.isoformat(),
            "days": time if comparison.history.dated else None,
            "surroundings": run.ambient if np.isfinite(run.ambient) else None,
            "measured": measured,
            "level": level,
            "ci95": [level - half_width, level + half_width],
            "unit": "%",
        }
        for run, time, measured, level, half_width in rows
    ]
