"""Signs that a log is simulated: values that repeat commands, and torques without any noise.

Such a log is read like any other, but its friction is that of a model.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.logs.channels.column_name import MEASURED, WORD_ENDS, key_of, split_unit
from frictioncli.logs.channels.joint_channels import JointChannels
from frictioncli.logs.channels.named_joints import COMMAND
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.channels.survey import Survey
from frictioncli.logs.channels.translated_names import in_english
from frictioncli.plain_text import printable

_SHORT_COMMAND = re.compile(r"(?:^|(?<=[ _.\-]))(?:ref|des|set|sp|d)(?=$|[ _.\-\d])", re.I)
_LEAST_ROWS = 100
_SAME = 0.99
"""Share of the rows in motion in which a measured value has to repeat the command."""
_TOLERANCE = 1e-6
"""Greatest difference of a repeated value, as a share of its range."""
_LATEST = 2
"""Longest delay with which commands are repeated. [rows]"""
_ORDER = 4
_NORM = np.sqrt(70.0)
"""RMS of the fourth difference of white noise of unit size."""
_SMOOTH = 3e-5
"""Noise below this share of the torque's range is that of no sensor."""


def command_columns(columns: Sequence[str], channels: Sequence[LogChannel]) -> dict[int, int]:
    """Return the column of the command that belongs to each measured column, where there is one.

    Their names are the same but for the words that say which was commanded and which measured.

    Parameters
    ----------
    columns : sequence of str
        All column names.
    channels : sequence of LogChannel
        The measured ones.

    Examples
    --------
    >>> from frictioncli.logs.channels.recognition import recognise_channels
    >>> columns = ["time", "actual_q_0", "target_q_0"]
    >>> command_columns(columns, recognise_channels(columns))
    {1: 2}
    """
    measured = {channel.column for channel in channels}
    commands: dict[str, int] = {}
    for number, column in enumerate(columns):
        plain, is_command = _plain(column)
        if is_command and number not in measured:
            commands.setdefault(plain, number)
    keys = {column: _plain(columns[column])[0] for column in sorted(measured) if commands}
    return {column: commands[key] for column, key in keys.items() if key in commands}


def _plain(column: str) -> tuple[str, bool]:
    """Return a name without words for measured and commanded, and whether it had the latter."""
    name = WORD_ENDS.sub(" ", split_unit(in_english(column))[0])
    without = _SHORT_COMMAND.sub("", COMMAND.sub("", name))
    return key_of(MEASURED.sub("", without)), without != name


def warn_of_simulation(
    joints: Sequence[JointChannels], commands: dict[int, int], survey: Survey
) -> list[JointChannels]:
    """Return the channels of all joints with warnings of values that nothing has measured.

    Parameters
    ----------
    joints : sequence of JointChannels
        The channels of each joint.
    commands : dict of int to int
        As of :func:`command_columns`.
    survey : Survey
        Raw samples, those of the commands among them.
    """
    return [
        replace(channels, warnings=(*channels.warnings, *_warnings(channels, commands, survey)))
        for channels in joints
    ]


def _warnings(channels: JointChannels, commands: dict[int, int], survey: Survey) -> list[str]:
    found = []
    for channel in (channels.position, channels.torque):
        command = commands.get(channel.column)
        pairs = [(head[channel.column], head[command]) for head in survey.heads if command in head]
        if pairs and (share := _repeated(pairs)) is not None:
            found.append(
                f"{printable(channel.name)} repeats its command in {100 * share:.3g} % of the rows"
                " in motion: simulated, or no measured value; friction is then that of a model"
            )
    if _is_smooth(channels, survey):
        found.append(
            f"{printable(channels.torque.name)} has no noise: simulated, computed by a model, or"
            " heavily filtered; intervals are then too narrow"
        )
    return found


def _repeated(pairs: Sequence[tuple[Array, Array]]) -> float | None:
    """Return the share of the rows in motion in which a value is its command; None if too small."""
    for delay in range(_LATEST + 1):
        same = moving = 0
        for values, command in pairs:
            later, earlier = values[delay:], command[: len(command) - delay]
            moved = np.append(False, np.diff(later) != 0) & np.isfinite(later)
            size = float(np.ptp(later[np.isfinite(later)])) if moved.any() else 0.0
            same += int(np.sum(np.abs(later - earlier)[moved] <= _TOLERANCE * size))
            moving += int(moved.sum())
        if moving >= _LEAST_ROWS and same >= _SAME * moving:
            return same / moving
    return None


def _is_smooth(channels: JointChannels, survey: Survey) -> bool:
    """Return whether the torque changes from row to row without noise, while the joint moves."""
    rough, moving, values = [], 0, []
    for head in survey.heads:
        torque, position = head[channels.torque.column], head[channels.position.column]
        steps = (np.diff(position) != 0) & np.isfinite(torque[1:]) & np.isfinite(torque[:-1])
        moves = _windows(steps)
        changes = moves & _windows(steps & (np.diff(torque) != 0))
        rough.append(np.abs(np.diff(torque, _ORDER))[changes] / _NORM)
        values.append(torque[1:][steps])
        moving += int(moves.sum())
    noise, torques = np.concatenate([np.empty(0), *rough]), np.concatenate([np.empty(0), *values])
    if len(noise) < max(_LEAST_ROWS, moving / 2):
        return False
    low, high = np.quantile(torques, (0.01, 0.99))
    return float(np.quantile(noise, 0.75)) < _SMOOTH * float(high - low)


def _windows(steps: Flags) -> Flags:
    """Return for each run of consecutive steps as long as the differences whether all hold."""
    count = max(len(steps) - _ORDER + 1, 0)
    return np.all([steps[i : i + count] for i in range(_ORDER)], axis=0)
