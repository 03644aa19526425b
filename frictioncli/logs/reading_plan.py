"""How each log is read: logs with the same header are surveyed together and share one plan."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from frictioncli.errors import OptionError
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import surveyed_motion, units
from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.joint_plan import JointPlan, plan_joint
from frictioncli.logs.channels.simulated import command_columns, warn_of_simulation
from frictioncli.logs.channels.survey import Survey, survey
from frictioncli.logs.channels.surveyed_motion import with_moving_position
from frictioncli.logs.channels.torque_choice import choose_torques
from frictioncli.logs.channels.torque_constant import TorqueConstant
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.runs.opening import OpenedLog, RefusedLog
from frictioncli.logs.samples.chunks import PlannedLog, plan_log
from frictioncli.logs.samples.clock_range import with_continuous_clock
from frictioncli.logs.settings import IngestSettings

_SHORTEST_PERIOD = 2.5e-5
"""Robots and drives log no faster. [s]"""

Constants = Mapping[int, TorqueConstant | Refusal]
"""Torque constant by joint, or why it is not known."""


def planned_logs(
    opened: Iterable[OpenedLog],
    settings: IngestSettings,
    channel_map: ChannelMap,
    constants: Constants | None = None,
) -> tuple[list[PlannedLog], list[RefusedLog]]:
    """Return how each log is to be read, and the logs that cannot be read.

    Parameters
    ----------
    opened : iterable of OpenedLog
        The logs of one run.
    settings : IngestSettings
        Units and gear ratio given by option, which take precedence over the map's.
    channel_map : ChannelMap
        Units and gear ratio given by the mapping file.
    constants : mapping of int to TorqueConstant or Refusal, optional
        Those that were found, by joint; one that the user gives takes precedence.

    Raises
    ------
    OptionError
        If one gear ratio or one torque constant is given for several joints.
    """
    found, refused = [], []
    for log, plans in _joint_plans(opened, settings, channel_map, constants or {}):
        if isinstance(plans, Refusal):
            refused.append(RefusedLog(log.run, log.file, log.recording, plans))
        else:
            found.append(with_continuous_clock(plan_log(log, plans)))
    return found, refused


def _joint_plans(
    logs: Iterable[OpenedLog],
    settings: IngestSettings,
    channel_map: ChannelMap,
    constants: Constants,
) -> Iterator[tuple[OpenedLog, list[JointPlan] | Refusal]]:
    """Yield each log with the plans of its joints, or why none of them can be read."""
    layouts: dict[tuple[str, ...], list[OpenedLog]] = {}
    for log in logs:
        layouts.setdefault(log.layout, []).append(log)
    for same_layout in layouts.values():
        plans = _plans_of_layout(same_layout, settings, channel_map, constants)
        for log in same_layout:
            yield log, plans if isinstance(plans, Refusal) else _with_notes(plans, log)


def _with_notes(plans: list[JointPlan], log: OpenedLog) -> list[JointPlan]:
    """Return the plans with the notes of one log's companion files."""
    if not log.sidecar.notes:
        return plans
    return [replace(plans[0], notes=(*plans[0].notes, *log.sidecar.notes)), *plans[1:]]


def _plans_of_layout(
    logs: list[OpenedLog],
    settings: IngestSettings,
    channel_map: ChannelMap,
    constants: Constants,
) -> list[JointPlan] | Refusal:
    first = logs[0]
    commands = command_columns(first.source.columns, first.channels)
    surveyed = survey(
        [log.source for log in logs],
        first.channels,
        first.joints[0].time.column,
        commands.values(),
    )
    forced = {**channel_map.units, **settings.forced_units()}
    ratio = settings.gear_ratio if settings.gear_ratio is not None else channel_map.gear_ratio
    if ratio is not None and len(first.joints) > 1:
        joints = ", ".join(str(channels.joint) for channels in first.joints)
        raise OptionError(
            f"gear ratio {ratio:g} is given, but {first.file.path} has joints {joints};"
            " expected one joint: choose it with --joint"
        )
    rated = settings.rated_torque
    rated = channel_map.rated_torque if rated is None else rated
    told = wanted_constant(settings, channel_map)
    if isinstance(told, float | int):
        one = TorqueConstant(float(told), None, "as given")
        constants = {channels.joint: one for channels in first.joints}
    moving = [with_moving_position(channels, surveyed) for channels in first.joints]
    chosen = warn_of_simulation(choose_torques(moving, surveyed), commands, surveyed)
    found = [
        plan_joint(
            joint,
            surveyed,
            forced=forced,
            gear_ratio=ratio,
            rated_torque=rated,
            constant=constants.get(joint.joint),
        )
        for joint in chosen
    ]
    plans = _with_one_time([plan for plan in found if isinstance(plan, JointPlan)])
    scaled = [str(plan.channels.joint) for plan in plans if plan.constant is not None]
    if isinstance(told, float | int) and len(scaled) > 1:
        raise OptionError(
            f"torque constant {told:g} N·m/A is given, but {first.file.path} has currents of joints"
            f" {', '.join(scaled)}; expected one joint: choose it with --joint"
        )
    refusals = [plan for plan in found if isinstance(plan, Refusal)]
    if not plans:
        return refusals[0]
    left_out = tuple(f"left out: {refusal.text}" for refusal in refusals)
    doubts = _doubts_of_time(plans, surveyed, forced)
    first_plan = replace(
        plans[0],
        notes=(*plans[0].notes, *left_out),
        warnings=(*plans[0].warnings, *doubts),
    )
    return [first_plan, *plans[1:]]


def _doubts_of_time(
    plans: list[JointPlan], surveyed: Survey, forced: Mapping[str, str]
) -> tuple[str, ...]:
    """Return a warning of times that may be in another unit, or count rows."""
    time, unit = plans[0].channels.time, plans[0].conversions[names.TIME].unit
    if names.TIME in forced or any(plan.shows_time for plan in plans):
        return ()
    period = surveyed_motion.period(surveyed, time)
    if period is not None and 0 < period * units.FACTORS[names.TIME][unit] < _SHORTEST_PERIOD:
        return (
            f"{time.name} is read as {unit}, in which its rows follow each other within"
            f" {period:.2g} {unit}: if it is in s, say so with --time-unit s",
        )
    if time.unit or time.meaning.unit:
        return ()
    step = units.whole_step([head[time.column] for head in surveyed.heads])
    if step is None or step < 1 or unit != "s":
        return ()
    return (
        f"{time.name} has no unit and grows by {step:g} from row to row: read as s; if it is in ms,"
        " say so with --time-unit ms; if it counts rows, give their period in s with --map, as"
        " [scale] time = 0.005",
    )


def _with_one_time(plans: list[JointPlan]) -> list[JointPlan]:
    """Return the plans with one unit of time: the one that most joints that move show."""
    shown = [plan.conversions[names.TIME] for plan in plans if plan.shows_time]
    if not shown:
        return plans
    time = max(shown, key=shown.count)
    return [replace(plan, conversions={**plan.conversions, names.TIME: time}) for plan in plans]


def wanted_constant(settings: IngestSettings, channel_map: ChannelMap) -> float | str | None:
    """Return the torque constant that the user gives, ``auto``, or None.

    Parameters
    ----------
    settings : IngestSettings
        The option, which takes precedence.
    channel_map : ChannelMap
        The mapping file.
    """
    told = settings.torque_constant
    return channel_map.torque_constant if told is None else told
