"""Text of a comparison for the terminal."""

from frictioncli.comparison.causes import CauseOfChange
from frictioncli.comparison.compare import Comparison
from frictioncli.comparison.day_to_day import LevelEstimate
from frictioncli.comparison.from_comparison import load_unit
from frictioncli.wording import probability_text

_WEAK = (
    "two runs do not show how much a joint varies from day to day: the interval relies on an"
    " assumed"
)


def comparison_text(comparison: Comparison) -> str:
    """Return the changes with intervals, their causes and advice."""
    model = comparison.history.models[-1]
    unit = model.torque_unit
    lines = [
        f"joint {model.joint}, {len(comparison.levels)} runs{_period_text(comparison)}:"
        f" {comparison.verdict.replace('_', ' ')}",
        f"  friction, first run to last: {_estimate_text(comparison, comparison.trend)}",
    ]
    if comparison.last_run is not None:
        lines.append(
            f"  last run to the earlier:     {_estimate_text(comparison, comparison.last_run)}"
        )
    if comparison.load is not None:
        load = comparison.load
        lines.append(
            f"  load torque, first to last:  {load.value:+.2f} % ({load.low:+.2f} to"
            f" {load.high:+.2f})"
        )
    lines += [_cause_text(comparison, cause) for cause in comparison.causes]
    if comparison.weak:
        lines.append(f"  weak: {_WEAK} {comparison.settings.day_to_day:g} % (--day-to-day)")
    if comparison.verdict == "undetermined":
        lines.append(f"  a change of {comparison.margin:.2g} % is not ruled out; measure more days")
    lines.append(
        f"  mean friction {comparison.mean_friction:.3g} {unit}; it varies from day to day by"
        f" {comparison.day_to_day:.2g} % (1 sigma), plus noise within the runs; ambient temperature"
        f" from {comparison.history.ambient_source}"
    )
    lines += _conditions_text(comparison, unit)
    lines += _parameters_text(comparison)
    if comparison.exceeded is not None:
        found = "a change above it was found" if comparison.exceeded else "no change above it found"
        lines.append(f"  threshold {_threshold_text(comparison, unit)}: {found}")
    return "\n".join(lines)


def _period_text(comparison: Comparison) -> str:
    history = comparison.history
    folders = len(history.folders)
    where = f" of {folders} folders" if folders > 1 else ""
    first, last = history.runs[0], history.runs[-1]
    if first.started_at is None or last.started_at is None:
        return f"{where}, in the order given (dates are not known)"
    return f"{where}, {first.started_at:%Y-%m-%d} to {last.started_at:%Y-%m-%d}"


def _estimate_text(comparison: Comparison, estimate: LevelEstimate) -> str:
    unit, factor = comparison.history.models[-1].torque_unit, comparison.mean_friction / 100
    return (
        f"{estimate.value:+.2f} % ({estimate.low:+.2f} to {estimate.high:+.2f}),"
        f" {estimate.value * factor:+.3g} {unit} ({estimate.low * factor:+.3g} to"
        f" {estimate.high * factor:+.3g})"
    )


def _cause_text(comparison: Comparison, cause: CauseOfChange) -> str:
    shares = [f"{name} ({probability_text(cause.probabilities[name])})" for name in cause.effects]
    since = ""
    if cause.change_point is not None:
        since = f" since {comparison.history.runs[cause.change_point].label}"
    return (
        f"  looks like {' or '.join(shares)}, {cause.change.value:+.2g} % in the"
        f" {cause.channel}{since}: {cause.claim}"
    )


def _conditions_text(comparison: Comparison, unit: str) -> list[str]:
    if not comparison.conditions:
        return ["  change at other conditions: not determined; measure more speeds or temperatures"]
    load = f"{comparison.conditions[0].load:.3g} {load_unit(comparison)}"
    lines = [f"  friction [{unit}] at a load of {load}, and its change, first run to last"]
    for one in comparison.conditions:
        factor = one.friction / 100
        mark = "  not measured in all runs" if one.extrapolated else ""
        lines.append(
            f"    {one.temperature:3.0f} °C {one.speed:6.1f} deg/s {one.friction:8.2f}"
            f" {one.change.value * factor:+7.2f} ({one.change.low * factor:+.2f} to"
            f" {one.change.high * factor:+.2f}){mark}"
        )
    return lines


def _parameters_text(comparison: Comparison) -> list[str]:
    if not comparison.parameters:
        return []
    lines = [
        "  parameters of the first and the last folder's model; they compensate each other:"
        " rely on the friction above"
    ]
    for one in comparison.parameters:
        change = "not in both models"
        if one.change is not None and one.ci95 is not None:
            change = f"{one.change:+.3g} ({one.ci95[0]:+.3g} to {one.ci95[1]:+.3g}) {one.unit}"
        lines.append(f"    {one.name:6s} {one.first:9.4g} -> {one.last:9.4g}  {change}")
    return lines


def _threshold_text(comparison: Comparison, unit: str) -> str:
    threshold = comparison.settings.fail_above
    assert threshold is not None  # only called with a threshold
    return f"{threshold.value:g} {'%' if threshold.unit == '%' else unit}"
