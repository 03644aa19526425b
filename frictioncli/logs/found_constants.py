"""Torque constants of all joints whose torque is a current, where the user asks for ``auto``."""

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace

from frictioncli.errors import NotEnoughData
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_map import ChannelMap
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel, recognise_channels
from frictioncli.logs.channels.shared_load import ChannelPair
from frictioncli.logs.channels.survey import survey
from frictioncli.logs.channels.torque_constant import TorqueConstant, estimate_constant
from frictioncli.logs.log_source import Refusal
from frictioncli.logs.reading_plan import Constants, planned_logs, wanted_constant
from frictioncli.logs.runs.discovery import LogRun
from frictioncli.logs.runs.opening import open_run
from frictioncli.logs.samples.chunks import PlannedLog
from frictioncli.logs.settings import AUTO, IngestSettings

NO_CONSTANT = "no_torque_constant"

_TARGET = re.compile(
    r"(?:^robot[ _.]+)?(?:^|(?<=[ _.]))(?:target|desired|commanded|command|cmd|soll)[ _.]", re.I
)


def found_constants(
    runs: Iterable[LogRun], settings: IngestSettings, channel_map: ChannelMap
) -> Constants:
    """Return the torque constants of all joints with a current, or why one is not known.

    Of each joint, the beginnings of up to 16 logs per run are read; all runs together tell one
    constant.

    Parameters
    ----------
    runs : iterable of LogRun
        All runs.
    settings : IngestSettings
        Settings of the user.
    channel_map : ChannelMap
        Mapping file of the user.

    Returns
    -------
    dict of int to TorqueConstant or Refusal
        By joint; empty where ``auto`` is not asked for.
    """
    if wanted_constant(settings, channel_map) != AUTO:
        return {}
    pairs: dict[int, list[list[ChannelPair]]] = defaultdict(list)
    columns: dict[int, tuple[str, str]] = {}
    for run in runs:
        opened, _ = open_run(run, settings, channel_map)
        planned, _ = planned_logs(opened, settings, channel_map)
        layouts: dict[tuple[str, ...], list[PlannedLog]] = {}
        for log in planned:
            layouts.setdefault(log.log.layout, []).append(log)
        for logs in layouts.values():
            for number, plan in enumerate(logs[0].plans):
                if plan.torque_unit == "A":
                    joint = plan.channels.joint
                    torque = _torque_beside(plan) or _target_torque(logs[0], joint)
                    columns.setdefault(joint, (plan.channels.torque.name, ""))
                    if torque is not None:
                        columns[joint] = plan.channels.torque.name, torque.name
                        pairs[joint].append(_pairs(logs, number, torque))
    return {joint: _constant(joint, *pair, pairs[joint]) for joint, pair in columns.items()}


def _torque_beside(plan: JointPlan) -> LogChannel | None:
    """Return the torque in N·m at the joint that stands beside a current, if any."""
    load, others = plan.channels.load, plan.channels.other_torques
    for channel in [*([load] if load is not None else []), *others]:
        at_joint = channel.meaning.side == names.JOINT_SIDE
        if at_joint and not channel.is_merged and _factor(channel) is not None:
            return channel
    return None


def _target_torque(log: PlannedLog, joint: int) -> LogChannel | None:
    """Return the torque that the robot has computed for a joint, if it is logged.

    It holds the load as the robot's own model has it, and is computed for the joint.
    """
    columns = log.log.source.columns
    targets = [i for i, name in enumerate(columns) if _TARGET.search(name)]
    plain = ["" if i not in targets else _TARGET.sub("_", n) for i, n in enumerate(columns)]
    for channel in recognise_channels([name.strip(" _.") for name in plain]):
        at_joint = channel.meaning.side == names.JOINT_SIDE
        if channel.quantity == names.TORQUE and channel.joint == joint and at_joint:
            found = replace(channel, name=columns[channel.column])
            return found if _factor(found) is not None else None
    return None


def _factor(channel: LogChannel) -> float | None:
    """Return the factor to N·m; None where the channel is something else."""
    written = channel.unit or channel.meaning.unit
    unit = units.canonical(written, names.LOAD) if written else "N·m"
    return None if unit is None else units.FACTORS[names.LOAD][unit]


def _pairs(logs: Sequence[PlannedLog], number: int, torque: LogChannel) -> list[ChannelPair]:
    """Return time, position, current and torque of the beginnings of logs with one layout."""
    plan = logs[0].plans[number]
    channels = plan.channels.time, plan.channels.position, plan.channels.torque
    heads = survey([log.log.source for log in logs], [*channels, torque], channels[0].column).heads
    conversions = [plan.conversions[n] for n in (names.TIME, names.POSITION, names.TORQUE)]
    scale = _factor(torque) or 1.0
    found = []
    for head in heads:
        time, position, current = (
            conversion.factor * head[channel.column] + conversion.offset
            for channel, conversion in zip(channels, conversions, strict=True)
        )
        found.append(ChannelPair(time, position, current, scale * head[torque.column]))
    return found


def _constant(
    joint: int, current: str, torque: str, pairs: Sequence[Sequence[ChannelPair]]
) -> TorqueConstant | Refusal:
    hint = "give it with --torque-constant VALUE [N·m/A], or leave results in A"
    if not torque:
        return Refusal(
            NO_CONSTANT,
            f"joint {joint}: the log has no torque in N·m at the joint from which the torque"
            f" constant of {current} could be found; {hint}",
        )
    try:
        found = estimate_constant(pairs)
    except NotEnoughData as why:
        return Refusal(
            NO_CONSTANT,
            f"joint {joint}: {current} and {torque} do not determine a torque constant: {why};"
            f" {hint}",
        )
    reason = f"from the {found.seen_by} that {current} and {torque} share in {found.rows} rows"
    if _TARGET.search(torque):
        reason += f", as accurate as the robot's own model, from which {torque} is computed"
    return TorqueConstant(found.value, found.ci95, reason)
