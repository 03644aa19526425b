"""Which of several torque-like channels of a joint bears its friction, seen from the values.

Torque that a controller has freed of friction, as some arms log beside the motor current, has no
half difference between the two directions of motion that keeps one sign.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.channel_names import Meaning
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.survey import Survey

_BINS = 40
"""Number of angle bins, over the range of positions of a file, that directions are compared in."""
_LEAST_BINS = 12
"""Least number of angle bins that both directions cross."""
_MOVING = 0.3
"""Least speed, as a share of the highest one but outliers."""
_SCATTERED = 0.85
"""Half differences with a smaller mean, relative to their RMS, are no friction."""
_STEADY = 0.95
"""Half differences with a greater mean, relative to their RMS, are friction."""
_SMALL_SHARE = 0.25
"""Greatest share of the friction that a channel freed of it still shows."""
_SAME_LOAD = 0.9
"""Least correlation of the half sums of two channels that show the same load."""
_AT_REST = 0.05
"""A joint that moves by less, relative to the one that moves most, says nothing of its torques."""
_RANDOM = 0.5
"""Half differences of a torque with a smaller mean, relative to their RMS, deserve a warning."""


@dataclass(frozen=True, slots=True)
class DirectionDifference:
    """Half differences and half sums of a channel between both directions, by file and angle bin.

    Attributes
    ----------
    half_difference, half_sum : ndarray, shape (bins,)
        Half the difference and half the sum of the means in forward and reverse motion. [raw]
    """

    half_difference: Array
    half_sum: Array

    @property
    def steadiness(self) -> float:
        """Mean half difference relative to its RMS: 1 where all are the same, 0 where random."""
        size = float(np.sqrt(np.mean(np.square(self.half_difference))))
        return abs(float(np.mean(self.half_difference))) / size if size > 0 else 0.0

    @property
    def contrary(self) -> int:
        """Number of half differences whose sign is not that of their mean."""
        sign = np.sign(np.mean(self.half_difference))
        return int(np.sum(np.sign(self.half_difference) != sign))


@dataclass(frozen=True, slots=True)
class _Verdict:
    """What the values of a joint say: keep its torque (``torque`` None), or take another channel.

    ``weight`` is the number of angle bins that it rests on.
    """

    weight: int
    torque: LogChannel | None = None
    reason: str = ""


def choose_torques(joints: Sequence[JointChannels], survey: Survey) -> list[JointChannels]:
    """Return the channels of all joints with torques that bear friction; the others become loads.

    The preferred torque is kept unless its half differences scatter about 0 while those of another
    torque-like channel keep their sign and are friction many times as large. All joints of a log
    take the same kind of channel, as that of a joint that hardly moves says nothing.

    Parameters
    ----------
    joints : sequence of JointChannels
        The channels of each joint, ``other_torques`` among them.
    survey : Survey
        Raw samples of logs with this layout.
    """
    ranges = {channels.joint: _range(channels, survey) for channels in joints}
    least = _AT_REST * max(ranges.values(), default=0.0)
    moving = {joint for joint, one in ranges.items() if one > least}
    return [
        _checked(channels, survey) if channels.joint in moving else channels
        for channels in _chosen(joints, moving, survey)
    ]


def _range(channels: JointChannels, survey: Survey) -> float:
    """Return the range of a joint's position but for its extreme values [raw]."""
    values = np.sort(survey.pooled(channels.position))
    if not len(values):
        return 0.0
    extreme = len(values) // 1000
    return float(values[-1 - extreme]) - float(values[extreme])


def _chosen(
    joints: Sequence[JointChannels], moving: Collection[int], survey: Survey
) -> list[JointChannels]:
    verdicts = {
        channels.joint: _verdict(channels, survey) if channels.joint in moving else _Verdict(0)
        for channels in joints
    }
    kept = sum(one.weight for one in verdicts.values() if one.torque is None)
    replacing = {joint: one for joint, one in verdicts.items() if one.torque is not None}
    if sum(one.weight for one in replacing.values()) <= kept:
        return list(joints)
    model_joint = max(replacing, key=lambda joint: replacing[joint].weight)
    model = replacing[model_joint].torque
    found = []
    for channels in joints:
        same_kind = [c for c in channels.other_torques if model and c.family == model.family]
        if not same_kind:
            found.append(channels)
            continue
        reason = verdicts[channels.joint].reason or f"as that of joint {model_joint}"
        found.append(_with_torque(channels, same_kind[0], reason))
    return found


def _verdict(channels: JointChannels, survey: Survey) -> _Verdict:
    others = [c for c in channels.other_torques if np.any(survey.pooled(c))]
    if not others:
        return _Verdict(0)
    found = direction_differences(survey, channels, [channels.torque, *others])
    if found is None:
        return _Verdict(0)
    preferred, bins = found[0], len(found[0].half_sum)
    if preferred.steadiness >= _SCATTERED:
        return _Verdict(bins)
    name = channels.torque.name
    for torque, one in zip(others, found[1:], strict=True):
        if one.steadiness >= _STEADY and _share(preferred, one) <= _SMALL_SHARE:
            return _Verdict(
                bins,
                torque,
                f"half the difference between the directions of motion has one sign in"
                f" {bins - one.contrary} of {bins} angle bins, that of {name} in"
                f" {bins - preferred.contrary}: {name} is free of most friction",
            )
    return _Verdict(bins)


def _checked(channels: JointChannels, survey: Survey) -> JointChannels:
    """Return channels without a load that bears friction; warn of a torque that bears none."""
    load = channels.load
    torques = [channels.torque] if load is None else [channels.torque, load]
    found = direction_differences(survey, channels, torques)
    if found is None:
        return channels
    torque, *loads = found
    warnings = list(channels.warnings)
    bins = len(torque.half_sum)
    if torque.steadiness < _RANDOM:
        warnings.append(
            f"torque of joint {channels.joint}, {channels.torque.name}, hardly shows friction: half"
            f" its difference between the directions of motion has one sign in"
            f" {bins - torque.contrary} of {bins} angle bins; {_why(channels, survey)}"
        )
    if loads and min(torque.steadiness, loads[0].steadiness) >= _STEADY:
        warnings.append(
            f"{channels.load.name if channels.load else ''} is not used as load: it changes with"
            " the direction of motion, as friction does; is it the drive's own torque, or a"
            " brake's?"
        )
        channels = replace(channels, load=None)
    return replace(channels, warnings=tuple(warnings))


def _why(channels: JointChannels, survey: Survey) -> str:
    """Return why a torque may bear no friction."""
    size = "is a magnitude without direction, as it is never negative, or "
    positive = bool(np.all(survey.pooled(channels.torque) >= 0))
    return (
        f"if it {size * positive}comes from a sensor behind the gear, or has been freed of friction"
        " by the controller, name a motor's torque or current with --map"
    )


def _with_torque(channels: JointChannels, torque: LogChannel, reason: str) -> JointChannels:
    """Return channels with another torque; the one before becomes the load where it can."""
    load = channels.load or _as_load(channels.torque)
    kept = f"; {channels.torque.name} serves as load" if load is not channels.load else ""
    note = f"torque of joint {channels.joint} is {torque.name}: {reason}{kept}"
    others = tuple(c for c in channels.other_torques if c is not torque)
    # the first note says which torque was preferred by its name
    return replace(
        channels,
        torque=torque,
        load=load,
        other_torques=(channels.torque, *others),
        notes=(note, *channels.notes[1:]),
    )


def direction_differences(
    survey: Survey, channels: JointChannels, torques: Sequence[LogChannel]
) -> list[DirectionDifference] | None:
    """Return the half differences and half sums of channels between both directions of motion.

    Parameters
    ----------
    survey : Survey
        Raw samples.
    channels : JointChannels
        Time and position of the joint.
    torques : sequence of LogChannel
        The channels.

    Returns
    -------
    list of DirectionDifference or None
        One per channel; None where fewer than 12 angle bins are crossed in both directions.
    """
    parts = []
    for head in survey.heads:
        columns = [channels.time, channels.position, *torques]
        rows = np.stack([head[channel.column] for channel in columns])
        rows = rows[:, np.isfinite(rows).all(axis=0)]
        if rows.shape[1] > 2 and np.ptp(rows[1]) > 0:
            parts.append(_by_bin(rows[0], rows[1], rows[2:]))
    if sum(part.shape[-1] for part in parts) < _LEAST_BINS:
        return None
    together = np.concatenate(parts, axis=-1)
    return [DirectionDifference(*channel) for channel in np.moveaxis(together, 0, 1)]


def _by_bin(time: Array, position: Array, torques: Array) -> Array:
    """Return half differences and half sums, shape (2, channels, bins)."""
    # over several samples where there are many, which divides the noise of position
    width = max(len(time) // 2000, 1)
    elapsed, moved = (values[width:] - values[:-width] for values in (time, position))
    with np.errstate(over="ignore"):  # of damaged values
        velocity = np.divide(moved, elapsed, out=np.zeros_like(moved), where=elapsed > 0)
    velocity = np.where(np.isfinite(velocity), velocity, 0.0)
    middle = slice(width // 2, width // 2 + len(velocity))
    low, span = float(np.min(position)), float(np.ptp(position))
    number = ((position[middle] - low) / span * (_BINS - 1)).astype(np.int64)
    speed = np.abs(velocity)
    moving = speed > _MOVING * float(np.quantile(speed, 0.98))
    means = []
    for direction in (1, -1):
        rows = moving & (np.sign(velocity) == direction)
        count = np.bincount(number[rows], minlength=_BINS).astype(float)
        sums = np.array([np.bincount(number[rows], one[middle][rows], _BINS) for one in torques])
        means.append(np.divide(sums, count, out=np.full(sums.shape, np.nan), where=count > 0))
    both = np.isfinite(means[0][0]) & np.isfinite(means[1][0])
    forward, reverse = (mean[:, both] for mean in means)
    return np.stack([(forward - reverse) / 2, (forward + reverse) / 2])


def _share(preferred: DirectionDifference, other: DirectionDifference) -> float:
    """Return the share of the other channel's friction that the preferred one shows [-].

    Both are brought to one unit by the loads that they show; 0 where these differ.
    """
    one, two = (d.half_sum - np.mean(d.half_sum) for d in (preferred, other))
    size = float(np.sqrt((one @ one) * (two @ two)))
    if size <= 0 or abs(one @ two) < _SAME_LOAD * size:
        return 0.0
    scale = float(one @ two) / float(one @ one)
    friction = float(np.mean(other.half_difference))
    return abs(scale * float(np.mean(preferred.half_difference)) / friction)


def _as_load(torque: LogChannel) -> LogChannel | None:
    """Return a torque as a load; None where it is not in N·m at the joint."""
    written = torque.unit or torque.meaning.unit
    unit = units.canonical(written, names.LOAD) if written else "N·m"
    if unit is None or torque.meaning.side != names.JOINT_SIDE:
        return None
    return replace(torque, meaning=Meaning(names.LOAD))
