"""ROS recordings: the JointState messages of a bag, read with rosbags (extra ``mcap``).

Bags of ROS 2 are SQLite or MCAP files, those of ROS 1 are ``.bag`` files.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Array
from frictioncli.logs.formats.compression import refuse_compressed
from frictioncli.logs.formats.containers import (
    ContainerLog,
    Rows,
    first_names,
    refuse_without_package,
    unreadable_on_error,
)
from frictioncli.logs.log_source import CsvHints, Refusal

_MCAP, _SQLITE, _BAG_1 = b"\x89MCAP0\r\n", b"SQLite format 3\0", b"#ROSBAG V2.0"
_PROFILE = re.compile(rb"\x89MCAP0\r\n\x01.{8}(?P<length>.)\0\0\0", re.DOTALL)
_ZSTD = b"\x28\xb5\x2f\xfd"
_MAX_MESSAGE = 1 << 20  # [byte]
_MAX_ROWS = 1 << 16
_WHAT = "a ROS recording"
_TYPE = "sensor_msgs/msg/JointState"
_FIELDS = {
    "position": "position_{} [rad]",
    "velocity": "velocity_{} [rad/s]",
    "effort": "effort_{}",
}
_LAST_NUMBER = re.compile(r"(\d{1,2})$")
_UNIVERSAL_ROBOTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
"""Joints from the base on; the drivers publish them in alphabetical order."""


@dataclass(frozen=True, slots=True)
class _JointState:
    """One JointState message.

    Attributes
    ----------
    topic : str
        Name of the topic.
    received, stamp : float
        Time of reception, and time stamp (0 where it is not set), since 1970. [s]
    joints : tuple of str
        Names of the joints.
    values : dict of str to ndarray, shape (joints,)
        Values by field; empty where the message has none.
    """

    topic: str
    received: float
    stamp: float
    joints: tuple[str, ...]
    values: dict[str, Array]


@dataclass(slots=True)
class _Group:
    """Summary of the messages of one topic with the same joints.

    Attributes
    ----------
    topic : str
        Name of the topic.
    joints : tuple of str
        Names in the order of the first message.
    count : int
        Number of messages.
    is_stamped : bool
        Whether a message has a time stamp.
    filled : Counter
        Number of finite values by field and joint.
    """

    topic: str
    joints: tuple[str, ...]
    count: int = 0
    is_stamped: bool = False
    filled: Counter[tuple[str, str]] = field(default_factory=Counter)

    @property
    def with_effort(self) -> list[str]:
        """The joints whose effort is known in some message."""
        return [joint for joint in self.joints if self.filled["effort", joint]]

    def add(self, message: _JointState) -> None:
        """Count the values of a message."""
        self.count += 1
        self.is_stamped = self.is_stamped or message.stamp != 0
        for name, values in message.values.items():
            if len(values) == len(message.joints):
                known = np.isfinite(values)
                self.filled.update(
                    (name, j) for j, k in zip(message.joints, known, strict=True) if k
                )


def read_ros(path: Path, head: bytes, hints: CsvHints) -> ContainerLog | Refusal | None:
    """Open a ROS 1 or 2 recording; None when it is another format.

    Joints are identified by name, as their order may change from message to message, and numbered
    by :func:`joint_numbers`.

    Raises
    ------
    UnreadableLog
        If the file is damaged.
    """
    if not head.startswith((_MCAP, _SQLITE, _BAG_1)):
        return None
    compressed = refuse_compressed(path, _WHAT)
    if compressed is not None:
        return compressed
    profile = _PROFILE.match(head)
    if profile is not None:
        profile_name = head[profile.end() : profile.end() + ord(profile["length"])]
        if profile_name != b"ros2":
            return Refusal(
                "format_not_read",
                f"MCAP recording of profile {profile_name.decode('utf-8', 'replace')!r}, expected"
                " 'ros2' with JointState messages; export the joint states as CSV",
            )
    try:
        import rosbags.rosbag2  # noqa: F401
    except ImportError:
        return refuse_without_package(_WHAT, "mcap")
    with unreadable_on_error(f"cannot be read as {_WHAT}"):
        topics, groups = _scan(path)
    if not groups:
        return Refusal(
            "not_a_log",
            f"{_WHAT} without {_TYPE} messages; its topics are {first_names(sorted(topics))}",
        )
    best = max(groups, key=lambda group: (len(group.with_effort), group.count))
    if not best.with_effort:
        return Refusal(
            "no_torque_channel",
            f"effort of {first_names(best.joints)} is empty in all {best.count} messages of"
            f" {best.topic}; record joint states with efforts",
        )
    numbers = joint_numbers(best.joints)
    cells = [(name, joint) for joint in best.joints for name in _FIELDS if best.filled[name, joint]]
    columns = ("time [s]", *(_FIELDS[name].format(numbers[joint]) for name, joint in cells))
    rows = partial(_rows, path, best.topic, best.joints, best.is_stamped, tuple(cells))
    return ContainerLog(path, columns, _form(best, groups, numbers), rows)


def joint_numbers(joints: Sequence[str]) -> dict[str, int]:
    """Return the number of each joint, from 1.

    It is the number at the end of the name where all names have different ones. Joints with the
    names of Universal Robots are numbered from the base on. Others are numbered in the order given.

    Examples
    --------
    >>> joint_numbers(["joint_b_2", "joint_a_1"])
    {'joint_b_2': 2, 'joint_a_1': 1}
    >>> joint_numbers(["ur_elbow_joint", "ur_shoulder_pan_joint"])
    {'ur_elbow_joint': 3, 'ur_shoulder_pan_joint': 1}
    """
    found = [_LAST_NUMBER.search(joint) for joint in joints]
    numbers = [int(match[1]) for match in found if match is not None]
    if len(set(numbers)) == len(joints):
        shift = 1 if 0 in numbers else 0
        return {joint: number + shift for joint, number in zip(joints, numbers, strict=True)}
    parts = [[p for p in _UNIVERSAL_ROBOTS if joint.endswith(f"{p}_joint")] for joint in joints]
    if all(parts) and len({part[0] for part in parts}) == len(joints):
        order = [_UNIVERSAL_ROBOTS.index(part[0]) + 1 for part in parts]
        return dict(zip(joints, order, strict=True))
    return {joint: number for number, joint in enumerate(joints, 1)}


def _form(best: _Group, groups: Sequence[_Group], numbers: dict[str, int]) -> str:
    """Return the form in words: what is read, and what is left out."""
    named = ", ".join(
        f"{number} {joint}"
        for number, joint in sorted((number, joint) for joint, number in numbers.items())
    )
    parts = [f"{_WHAT}, {best.count} messages of {best.topic}, joints {named}"]
    for name in _FIELDS:
        empty = [joint for joint in best.joints if not best.filled[name, joint]]
        if empty:
            parts.append(f"{name} of {first_names(empty)} is empty in all messages")
    if not best.is_stamped:
        parts.append("no time stamps: times of reception are read")
    others = [
        f"{other.count} messages of {other.topic} ({first_names(other.joints, 3)})"
        for other in sorted(groups, key=lambda group: -group.count)
        if other is not best
    ]
    if others:
        parts.append(f"left out: {first_names(others)}")
    return "; ".join(parts)


def _scan(path: Path) -> tuple[set[str], list[_Group]]:
    """Return all topics, and a summary of JointState messages by topic and set of joints."""
    groups: dict[tuple[str, frozenset[str]], _Group] = {}
    with _Bag(path) as bag:
        for message in bag.joint_states():
            key = (message.topic, frozenset(message.joints))
            groups.setdefault(key, _Group(message.topic, message.joints)).add(message)
        return bag.topics, list(groups.values())


def _rows(
    path: Path,
    topic: str,
    joints: tuple[str, ...],
    is_stamped: bool,
    cells: tuple[tuple[str, str], ...],
    columns: Sequence[int],
    rows: int,
) -> Iterator[Rows]:
    """Yield the values of the given columns; see :class:`ContainerLog`."""
    columns = (0, *(column for column in columns if column))
    block = np.empty((len(columns), min(rows, _MAX_ROWS)))
    filled = 0
    with _Bag(path) as bag:
        for message in bag.joint_states():
            if message.topic != topic or frozenset(message.joints) != frozenset(joints):
                continue
            block[0, filled] = message.stamp if is_stamped else message.received
            for row, column in enumerate(columns[1:], 1):
                name, joint = cells[column - 1]
                values = message.values[name]
                has_values = len(values) == len(message.joints)
                block[row, filled] = values[message.joints.index(joint)] if has_values else np.nan
            filled += 1
            if filled == block.shape[1]:
                yield dict(zip(columns, block.copy(), strict=True))
                filled = 0
    if filled:
        yield dict(zip(columns, block[:, :filled].copy(), strict=True))


class _Bag:
    """An opened recording."""

    def __init__(self, path: Path) -> None:
        from rosbags import rosbag1, rosbag2
        from rosbags.typesys import Stores, get_typestore

        with path.open("rb") as stream:
            magic = stream.read(16)
        self._reader: Any
        self._decode: Callable[[bytes, str], Any]
        if magic.startswith(_BAG_1):
            self._reader = rosbag1.Reader(path)
            self._decode = get_typestore(Stores.ROS1_NOETIC).deserialize_ros1
        else:
            # by the content, not by the suffix of the name
            kind = ".mcap" if magic.startswith(_MCAP) else ".db3"
            if kind == ".db3":  # its reader puts the name into a URI as it is
                path = Path(quote(str(path), safe="/:\\"))
            self._reader = rosbag2.Reader.STORAGE_PLUGINS[kind](path)
            self._decode = get_typestore(Stores.LATEST).deserialize_cdr

    def __enter__(self) -> "_Bag":
        self._reader.open()
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    @property
    def topics(self) -> set[str]:
        """The names of all topics."""
        return {connection.topic for connection in self._reader.connections}

    def joint_states(self) -> Iterator[_JointState]:
        """Yield the JointState messages in order of reception."""
        wanted = [c for c in self._reader.connections if c.msgtype == _TYPE]
        if not wanted:
            return
        for connection, received, raw in self._reader.messages(wanted):
            if bytes(raw[:4]) == _ZSTD:  # messages may be compressed one by one
                with pa.CompressedInputStream(pa.BufferReader(raw), "zstd") as compressed:
                    raw = compressed.read(_MAX_MESSAGE)
            message = self._decode(raw, _TYPE)
            stamp = message.header.stamp
            yield _JointState(
                connection.topic,
                received * 1e-9,
                stamp.sec + stamp.nanosec * 1e-9,
                tuple(message.name),
                {name: getattr(message, name) for name in _FIELDS},
            )
