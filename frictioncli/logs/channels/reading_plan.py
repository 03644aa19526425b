"""Logs that share a header are surveyed together and read by one plan."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from frictioncli.errors import OptionError
from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.survey import survey
from frictioncli.logs.channels.unit_inference import JointPlan, plan_joint
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.runs.opening import OpenedLog, RefusedLog
from frictioncli.logs.samples.chunks import PlannedLog, plan_log
from frictioncli.logs.settings import IngestSettings


def planned_logs(
    opened: Iterable[OpenedLog], settings: IngestSettings, chart: ChannelMap
) -> tuple[list[PlannedLog], list[RefusedLog]]:
    """Return how each log is going to be read, and the logs that cannot be.

    Raises
    ------
    OptionError
        If one gear ratio is given for several joints.
    """
    found, refused = [], []
    for log, plans in plans_by_log(opened, settings, chart):
        if isinstance(plans, Refusal):
            refused.append(RefusedLog(log.run, log.file, log.recording, plans))
        else:
            found.append(plan_log(log, plans))
    return found, refused


def plans_by_log(
    logs: Iterable[OpenedLog], settings: IngestSettings, chart: ChannelMap
) -> Iterator[tuple[OpenedLog, list[JointPlan] | Refusal]]:
    """Yield each log with how to read its joints, or why none of them can be read.

    Raises
    ------
    OptionError
        If one gear ratio is given for several joints.
    """
    layouts: dict[tuple[str, ...], list[OpenedLog]] = {}
    for log in logs:
        layouts.setdefault(log.layout, []).append(log)
    for same in layouts.values():
        plans = _plans(same, settings, chart)
        for log in same:
            yield log, plans if isinstance(plans, Refusal) else _with_notes(plans, log)


def _with_notes(plans: list[JointPlan], log: OpenedLog) -> list[JointPlan]:
    """Return the plans with what only this log has to say."""
    if not log.sidecar.notes:
        return plans
    return [replace(plans[0], notes=(*plans[0].notes, *log.sidecar.notes)), *plans[1:]]


def _plans(
    logs: list[OpenedLog], settings: IngestSettings, chart: ChannelMap
) -> list[JointPlan] | Refusal:
    seen = survey(logs)
    forced = {**chart.units, **settings.forced_units()}
    ratio = settings.gear_ratio if settings.gear_ratio is not None else chart.gear_ratio
    if ratio is not None and len(logs[0].joints) > 1:
        joints = ", ".join(str(own.joint) for own in logs[0].joints)
        raise OptionError(
            f"gear ratio {ratio:g} is given, but {logs[0].file.path} has joints {joints};"
            " expected one joint: choose it with --joint"
        )
    found = [plan_joint(joint, seen, forced=forced, gear_ratio=ratio) for joint in logs[0].joints]
    plans = [plan for plan in found if isinstance(plan, JointPlan)]
    refusals = [plan for plan in found if isinstance(plan, Refusal)]
    if not plans:
        return refusals[0]
    left_out = tuple(f"left out: {refusal.text}" for refusal in refusals)
    return [replace(plans[0], notes=(*plans[0].notes, *left_out)), *plans[1:]]
