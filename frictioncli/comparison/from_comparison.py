"""``comparison.json`` of a comparison."""

import numpy as np

from frictioncli.comparison.causes import CauseOfChange
from frictioncli.comparison.compare import Comparison
from frictioncli.comparison.day_to_day import LevelEstimate
from frictioncli.comparison.document import (
    CauseOfChangeRecord,
    ChangeRecord,
    ComparisonDocument,
    ConditionRecord,
    EstimateRecord,
    MarginRecord,
    MeanFrictionRecord,
    ParameterChangeRecord,
    PercentRecord,
    RunRecord,
    ScatterRecord,
    ThresholdRecord,
    TrendRecord,
)
from frictioncli.effects import BY_NAME

_HOURS = 1000.0


def comparison_document(comparison: Comparison) -> ComparisonDocument:
    """Return a comparison as a document.

    Parameters
    ----------
    comparison : Comparison
        The comparison.
    """
    history = comparison.history
    model = history.models[-1]
    unit = model.torque_unit
    threshold = comparison.settings.fail_above
    last_run = comparison.last_run
    return ComparisonDocument(
        verdict=comparison.verdict,
        weak=comparison.weak,
        joint=model.joint,
        torque_unit=unit,
        load_unit=load_unit(comparison),
        temperature=model.temperature,
        folders=tuple(history.folders),
        mean_friction=MeanFrictionRecord(estimate=comparison.mean_friction, unit=unit),
        trend=_trend(comparison),
        last_run=None if last_run is None else _change(comparison, last_run),
        load=_percent(comparison.load) if comparison.load else None,
        causes=tuple(_cause(comparison, cause) for cause in comparison.causes),
        friction=tuple(
            ConditionRecord(
                temperature=one.temperature,
                speed=one.speed,
                load=one.load,
                friction=one.friction,
                change=one.change.value * one.friction / 100,
                ci95=(one.change.low * one.friction / 100, one.change.high * one.friction / 100),
                unit=unit,
                percent=_percent(one.change),
                extrapolated=one.extrapolated,
            )
            for one in comparison.conditions
        ),
        parameters={
            one.name: ParameterChangeRecord(
                first=one.first, last=one.last, change=one.change, ci95=one.ci95, unit=one.unit
            )
            for one in comparison.parameters
        },
        runs=_runs(comparison),
        scatter=ScatterRecord(
            day_to_day=comparison.day_to_day,
            assumed=comparison.settings.day_to_day,
            unit="%",
            surroundings_from=history.ambient_source,
        ),
        margin=MarginRecord(value=comparison.margin, unit="%"),
        threshold=None
        if threshold is None
        else ThresholdRecord(
            value=threshold.value,
            unit=threshold.unit if threshold.unit == "%" else unit,
            exceeded=comparison.exceeded,
        ),
    )


def load_unit(comparison: Comparison) -> str:
    """Return the unit of the load torque: alpha is 1 over it, or torque over its square."""
    return comparison.history.models[-1].parameters["alpha"].unit.split("(")[1].split(")")[0]


def _percent(estimate: LevelEstimate) -> PercentRecord:
    return PercentRecord(
        estimate=estimate.value,
        ci95=(estimate.low, estimate.high),
        unit="%",
        p_value=estimate.p_value,
    )


def _change(comparison: Comparison, estimate: LevelEstimate) -> ChangeRecord:
    factor = comparison.mean_friction / 100
    return ChangeRecord(
        change=estimate.value * factor,
        ci95=(estimate.low * factor, estimate.high * factor),
        unit=comparison.history.models[-1].torque_unit,
        percent=_percent(estimate),
    )


def _trend(comparison: Comparison) -> TrendRecord:
    trend, history = comparison.trend, comparison.history
    steps = len(comparison.levels) - 1
    change = _change(comparison, trend)
    per_1000_h = None
    if history.dated:
        factor = _HOURS / (24 * float(history.time[-1]))
        per_1000_h = EstimateRecord(
            estimate=trend.value * factor,
            ci95=(trend.low * factor, trend.high * factor),
            unit="%/1000 h",
        )
    return TrendRecord(
        change=change.change,
        ci95=change.ci95,
        unit=change.unit,
        percent=change.percent,
        per_run=EstimateRecord(
            estimate=trend.value / steps,
            ci95=(trend.low / steps, trend.high / steps),
            unit="%/run",
        ),
        per_1000_h=per_1000_h,
    )


def _cause(comparison: Comparison, cause: CauseOfChange) -> CauseOfChangeRecord:
    return CauseOfChangeRecord(
        effects=cause.effects,
        probabilities=cause.probabilities,
        channel=cause.channel,
        claim=cause.claim,
        change=_percent(cause.change),
        since=None
        if cause.change_point is None
        else comparison.history.runs[cause.change_point].label,
        experiment=BY_NAME[cause.effects[0]].experiment,
    )


def _runs(comparison: Comparison) -> tuple[RunRecord, ...]:
    rows = zip(
        comparison.history.runs,
        comparison.history.time.tolist(),
        comparison.levels.tolist(),
        comparison.adjusted.tolist(),
        comparison.half_widths.tolist(),
        strict=True,
    )
    return tuple(
        RunRecord(
            folder=run.folder,
            run=run.run,
            started_at=None if run.started_at is None else run.started_at.isoformat(),
            days=time if comparison.history.dated else None,
            surroundings=run.ambient if np.isfinite(run.ambient) else None,
            measured=measured,
            level=level,
            ci95=(level - half_width, level + half_width),
            unit="%",
        )
        for run, time, measured, level, half_width in rows
    )
