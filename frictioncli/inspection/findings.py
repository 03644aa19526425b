"""Records of what a file holds, as shown in the terminal and in the JSON document."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from frictioncli.inspection.monitors.constant_torque import Limit
from frictioncli.inspection.monitors.resolution import Resolution
from frictioncli.inspection.monitors.sampling import Sampling
from frictioncli.inspection.other_clocks import OtherClock
from frictioncli.logs.channels.channel_names import LOAD


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelInspection:
    """A column that is read.

    Attributes
    ----------
    quantity, column : str
        Canonical name of the quantity, and the column's name in the file.
    side : str
        Side of the gear where it is measured; "" where irrelevant or not known.
    unit_found, unit_believed : str
        Unit in the header, "" where it has none, and the unit in which the column is read.
    evidence : str
        Why it is read in that unit.
    lowest, highest : float
        Range of the values, in the unit used inside: deg, deg/s, N·m or A, °C.
    grid : Resolution or None
        Step between its values, in the same unit.
    """

    quantity: str
    column: str
    side: str
    unit_found: str
    unit_believed: str
    evidence: str
    lowest: float
    highest: float
    grid: Resolution | None

    @property
    def constant(self) -> bool:
        """Whether the channel never changes."""
        return not self.highest > self.lowest


@dataclass(frozen=True, slots=True)
class Spikes:
    """Spikes of a channel.

    Attributes
    ----------
    quantity : str
        Canonical name of the channel.
    count, line : int
        Number of spikes, and the first line.
    farthest : float
        Largest deviation from the neighbours, in the unit of the channel.
    """

    quantity: str
    count: int
    line: int
    farthest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JointInspection:
    """What a file holds of one joint.

    Attributes
    ----------
    joint : int
        Its number, from 1.
    torque_unit, torque_side : str
        Unit and side of the gear of the torque.
    gear_ratio : float or None
        Motor turns per joint turn, where it is used. [-]
    channels : tuple of ChannelInspection
        Its columns.
    velocity_agreement : float or None
        Change of position per integral of velocity, 1 where they agree. [-]
    held_samples, held_line : int
        Samples that repeat the sample before while the joint moves, and the first line.
    limits : tuple of Limit
        Limits of the torque.
    spikes : tuple of Spikes
        Spikes of each channel.
    frozen_spans, frozen_s : int, float
        Intervals of constant torque at standstill, and their sum. [s]
    brake_closed_s : float or None
        Time with the brake closed, by a brake column. [s]
    moves : mapping of str to int
        Number of constant-speed segments ``forward`` and ``reverse``.
    """

    joint: int
    torque_unit: str
    torque_side: str
    gear_ratio: float | None
    channels: tuple[ChannelInspection, ...]
    velocity_agreement: float | None = None
    held_samples: int = 0
    held_line: int | None = None
    limits: tuple[Limit, ...] = ()
    spikes: tuple[Spikes, ...] = ()
    frozen_spans: int = 0
    frozen_s: float = 0.0
    brake_closed_s: float | None = None
    moves: Mapping[str, int] = field(default_factory=dict)

    @property
    def load_unit(self) -> str:
        """Unit of the load: N·m of a channel of its own, else that of the torque."""
        own = any(channel.quantity == LOAD for channel in self.channels)
        return "N·m" if own else self.torque_unit


@dataclass(frozen=True, slots=True, kw_only=True)
class FileInspection:
    """What a file holds.

    Attributes
    ----------
    path : Path
        The file.
    run, recording : str
        Its run, and its name as a recording.
    form : str
        Its format; "" where the format is not read.
    reason, refusal : str
        Why it cannot be used, as a word and as a sentence; "" where it can.
    columns : int
        Number of columns.
    rows, rows_kept : int
        Rows read, and those that become samples.
    rejected : mapping of str to int
        Reason -> number of rejected rows.
    sampling : Sampling or None
        Sampling; None where no row could be read.
    clocks : tuple of OtherClock
        Time columns that are not used.
    joints : tuple of JointInspection
        What it holds of each joint.
    notes : tuple of str
        Assumptions that contradict or complete the header.
    """

    path: Path
    run: str
    recording: str = ""
    form: str = ""
    reason: str = ""
    refusal: str = ""
    columns: int = 0
    rows: int = 0
    rows_kept: int = 0
    rejected: Mapping[str, int] = field(default_factory=dict)
    sampling: Sampling | None = None
    clocks: tuple[OtherClock, ...] = ()
    joints: tuple[JointInspection, ...] = ()
    notes: tuple[str, ...] = ()
