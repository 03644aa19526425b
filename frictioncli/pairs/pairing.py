"""Pairs of counter-directed segments of the same speed, joint, temperature and angles."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Numbers
from frictioncli.errors import NotEnoughData
from frictioncli.pairs.added_torque import AddedByOthers
from frictioncli.pairs.common_speeds import Level, common_speeds, is_same_command
from frictioncli.pairs.matching import Matches, SegmentArrays, match_bins
from frictioncli.pairs.matching_groups import MatchingGroup, matching_groups
from frictioncli.pairs.no_pairs_text import directions_text, dropped_text
from frictioncli.pairs.other_joints import OTHER_MOVES, OTHER_POSE, OtherMotion
from frictioncli.pairs.partitioned_store import Columns, PartitionedStore
from frictioncli.pairs.segments import TEMPERATURES, Joint, SegmentTables
from frictioncli.pairs.settings import PairingSettings
from frictioncli.pairs.speed_levels import SpeedCounts, speed_levels, steps_of

_ALONE = "no counter-directed partner"
_NOT_SHARED = "angle not shared with the partner"
_OTHER_PAYLOAD = "the partner has another payload"
_REASONS = (OTHER_MOVES, _ALONE, _NOT_SHARED, _OTHER_PAYLOAD, OTHER_POSE)


@dataclass(frozen=True, slots=True)
class Pairing:
    """Pairs, and the samples that are in none.

    Attributes
    ----------
    store : PartitionedStore
        Two tables by run and joint. ``pairs``, one row per pair in time order: pair (its number),
        level, recording (its number), speed [deg/s], time [s], the temperatures [°C], payload [kg],
        pose (of the other joints).
        ``bins``, one row per pair and angle bin: pair, bin, torques and samples of both directions,
        load.
    speeds : dict of (int, int) to float
        The value that stands for a commanded speed, by joint and level. [deg/s]
    medians : dict of (int, int) to float
        Median speed of the pairs, by joint and level. [deg/s]
    dropped : dict of str to int
        Samples by reason; with the samples of the pairs they are all samples.
    added : dict of int to AddedByOthers
        What other joints add to the torque of joints while they move, by joint.
    """

    store: PartitionedStore[Joint]
    speeds: dict[Level, float]
    medians: dict[Level, float]
    dropped: dict[str, int]
    added: dict[int, AddedByOthers] = field(default_factory=dict)

    @property
    def joints(self) -> list[int]:
        """The joints that have pairs."""
        return sorted({joint for _, joint in self.store.keys})

    def speed_of(self, joint: int, pairs: Columns) -> Array:
        """Return the speed of pairs; one commanded speed has one value [deg/s]."""
        common, median = (
            np.array([by_level[joint, level] for level in pairs["level"].tolist()])
            for by_level in (self.speeds, self.medians)
        )
        return np.where(is_same_command(pairs["speed"], median), common, pairs["speed"])


def pair_segments(
    segments: SegmentTables,
    settings: PairingSettings,
    store: PartitionedStore[Joint],
    payload: pd.Series | None = None,
) -> Pairing:
    """Pair counter-directed segments and put both torques of each angle bin side by side.

    Moves with different payloads are loaded differently and make no pair, nor do a move whose
    payload is known and one whose payload is not. Two moves of unknown payload are taken to have
    the same. So it is with poses of the other joints, unless no pair is left.

    Parameters
    ----------
    segments : SegmentTables
        The constant-speed segments.
    settings : PairingSettings
        What makes a pair.
    store : PartitionedStore
        Store for the pairs.
    payload : Series, optional
        Payload by run and recording, missing where unknown; that of a segment goes before. [kg]

    Returns
    -------
    Pairing
        The pairs.

    Raises
    ------
    NotEnoughData
        If nothing moves at constant speed, or nothing has a counter-directed partner.
    """
    if not segments.counts:
        raise NotEnoughData(
            f"no constant-velocity motion in {segments.samples} samples"
            f" ({dropped_text(segments.dropped)}); expected moves that hold a speed above"
            f" {settings.steady.min_speed:g} deg/s (check the velocity); for other motion, such as"
            " sines, use 'frictioncli separate --by regression'"
        )
    pairer = _Pairer(
        settings,
        _steps_and_levels(segments, settings),
        _payloads(segments, payload),
        store,
        segments.other_motion,
    )
    pairer.add_all(segments, sorted(segments.counts))
    motion = segments.other_motion
    paired = {joint for joint, _ in pairer.speeds}
    motion.needed |= {joint for joint in motion.shared if motion.leaves_out(joint)} - paired
    motion.across_poses |= pairer.in_other_poses() - paired - motion.needed
    if motion.needed or motion.across_poses:
        pairer.added = {
            joint: found for joint, found in pairer.added.items() if joint not in motion.needed
        }
        redone = motion.needed | motion.across_poses
        again = [joint for joint in sorted(segments.counts) if joint[1] in redone]
        pairer.add_all(segments, again)
    dropped = pairer.total()
    if not pairer.speeds:
        mixed = "".join(
            f", {reason}" for reason in (_OTHER_PAYLOAD, OTHER_POSE, OTHER_MOVES) if dropped[reason]
        )
        raise NotEnoughData(
            f"no pair of counter-directed moves: {directions_text(segments)}{mixed}; expected"
            " motion in both directions over the same angles at the same speed; log both"
            " directions, or loosen --same-speed, --same-temperature, --longest-pause; for other"
            " motion use 'frictioncli separate --by regression'"
        )
    medians = {level: counts.median for level, counts in pairer.speeds.items()}
    speeds = common_speeds(store, medians)
    return Pairing(store, speeds, medians, segments.dropped | dropped, pairer.added)


@dataclass(slots=True)
class _Pairer:
    """Pairs the segments group by group, and counts."""

    settings: PairingSettings
    steps_and_levels: tuple[Numbers, Numbers]
    payloads: Array
    store: PartitionedStore[Joint]
    other_motion: OtherMotion
    dropped: dict[Joint, dict[str, int]] = field(default_factory=dict)
    speeds: dict[Level, SpeedCounts] = field(default_factory=dict)
    added: dict[int, AddedByOthers] = field(default_factory=dict)

    def add_all(self, segments: SegmentTables, joints: Sequence[Joint]) -> None:
        """Pair the segments of runs and joints; one of which no pair was found may come again."""
        for joint in joints:
            self.dropped[joint] = dict.fromkeys(_REASONS, 0)
            count = 0
            for group in matching_groups(segments.store, joint):
                count += self.add(joint, group, count)

    def total(self) -> dict[str, int]:
        """Return the samples dropped of all joints, by reason."""
        return {reason: sum(one[reason] for one in self.dropped.values()) for reason in _REASONS}

    def in_other_poses(self) -> set[int]:
        """Return the joints with samples whose partner has another pose of the other joints."""
        return {joint for (_, joint), reasons in self.dropped.items() if reasons[OTHER_POSE]}

    def add(self, joint: Joint, group: MatchingGroup, count: int) -> int:
        """Pair the segments of a group, numbered from ``count``; return the number of pairs."""
        segments, bins = group.segments, group.bins
        steps, levels = self.steps_and_levels
        level = levels[np.searchsorted(steps, steps_of(segments["speed"]))]
        payload = segments["payload"]
        payload = np.where(np.isnan(payload), self.payloads[segments["recording"]], payload)
        pose = segments["pose"]
        if not self.other_motion.tells_poses_apart(joint[1]):
            pose = np.full(len(pose), np.nan)
        kind = np.stack([payload, pose])
        if bins["shared"].any() or joint[1] in self.added:
            of_bins = (
                values[bins["segment"]]
                for values in (segments["direction"], level, np.nan_to_num(payload, nan=-1.0))
            )
            self.added.setdefault(joint[1], AddedByOthers()).add(
                (bins["bin"], *of_bins),
                **{name: bins[name] for name in ("time", "torque", "segment", "shared")},
            )
        if self.other_motion.leaves_out(joint[1]):
            shared = bins["shared"]
            self.dropped[joint][OTHER_MOVES] += int(bins["n"][shared].sum())
            bins = {name: values[~shared] for name, values in bins.items()}
        arrays = _arrays(segments, bins)
        matches = match_bins(arrays, _groups(segments["start"], level, kind), self.settings)
        matched = matches.bin_match >= 0
        rest = ~matched
        # the bins that remain may match in another pose, or else with another payload
        other = {}
        for reason, differs, kept in (
            (OTHER_POSE, pose, kind[:1]),
            (_OTHER_PAYLOAD, payload, kind[:0]),
        ):
            other[reason] = np.zeros(len(rest), bool)
            if len(np.unique(differs)) > 1:
                left = _arrays(segments, {name: values[rest] for name, values in bins.items()})
                again = match_bins(left, _groups(segments["start"], level, kept), self.settings)
                other[reason][rest] = again.bin_match >= 0
                rest = rest & ~other[reason]
        paired = np.concatenate([matches.forward, matches.reverse])
        alone = ~np.isin(bins["segment"], paired)
        for reason, rows in (
            (_ALONE, rest & alone),
            (_NOT_SHARED, rest & ~alone),
            *other.items(),
        ):
            self.dropped[joint][reason] += int(bins["n"][rows].sum())
        if not len(paired):
            return 0
        pairs, number = _pairs(segments, matches, level, kind, count)
        for one in np.unique(pairs["level"]).tolist():
            counts = self.speeds.setdefault((joint[1], one), SpeedCounts())
            counts.add(pairs["speed"][pairs["level"] == one])
        self.store.add(joint, {"pairs": pairs, "bins": _paired_bins(bins, matches, number)})
        return len(pairs["pair"])


def _steps_and_levels(
    segments: SegmentTables, settings: PairingSettings
) -> tuple[Numbers, Numbers]:
    """Return the steps of speed that occur, ascending, and the speed level of each."""
    counts = SpeedCounts()
    for of_direction in segments.speeds.values():
        counts.add(of_direction.speeds)
    return counts.steps, speed_levels(counts.speeds, settings.same_speed)


def _payloads(segments: SegmentTables, payload: pd.Series | None) -> Array:
    """Return the payload of each recording, NaN where unknown [kg]."""
    if payload is None:
        return np.full(len(segments.recordings), np.nan)
    return payload.reindex(pd.MultiIndex.from_tuples(segments.recordings)).to_numpy(float)


def _groups(start: Array, level: Numbers, kinds: Array) -> list[Numbers]:
    """Return the segments that may pair with each other, in time order.

    They have the same level and the same value of each of the kinds, shape (kinds, segments); an
    unknown value, NaN, is equal to another unknown one.
    """
    codes = [level, *(np.unique(kind, return_inverse=True)[1] for kind in kinds)]
    order = np.lexsort((start, *reversed(codes)))
    new = np.any([np.diff(code[order]) != 0 for code in codes], axis=0)
    return np.split(order, np.flatnonzero(new) + 1)


def _arrays(segments: Columns, bins: Columns) -> SegmentArrays:
    return SegmentArrays(
        direction=segments["direction"],
        start=segments["start"],
        stop=segments["stop"],
        temperature=segments["motor_temperature"],
        bin_segment=bins["segment"],
        bin_number=bins["bin"],
        bin_time=bins["time"],
    )


def _pairs(
    segments: Columns, matches: Matches, level: Numbers, kind: Array, count: int
) -> tuple[Columns, Numbers]:
    """Return a row per pair in time order, and the number of the pair of each match."""
    one, other = matches.forward, matches.reverse
    start, stop = segments["start"], segments["stop"]
    time = (start[one] + stop[one] + start[other] + stop[other]) / 4
    order = np.lexsort((one, time))
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(count, count + len(order))
    pairs = {
        "level": level[one],
        "recording": segments["recording"][one],
        "time": time,
        "payload": kind[0][one],
        "pose": kind[1][one],
    }
    for name in ("speed", *TEMPERATURES):
        pairs[name] = (segments[name][one] + segments[name][other]) / 2
    pairs = {name: values[order] for name, values in pairs.items()}
    return {"pair": number[order]} | pairs, number


def _paired_bins(bins: Columns, matches: Matches, number: Numbers) -> Columns:
    """Return one row per pair and bin, in the order of pairs and angles."""
    matched = np.flatnonzero(matches.bin_match >= 0)
    match = matches.bin_match[matched]
    is_forward = bins["segment"][matched] == matches.forward[match]
    by_direction = []
    for rows in (matched[is_forward], matched[~is_forward]):
        pair = number[matches.bin_match[rows]]
        by_direction.append(rows[np.lexsort((bins["bin"][rows], pair))])
    forward, reverse = by_direction
    return {
        "pair": number[matches.bin_match[forward]],
        "bin": bins["bin"][forward],
        "torque_forward": bins["torque"][forward],
        "torque_reverse": bins["torque"][reverse],
        "n_forward": bins["n"][forward],
        "n_reverse": bins["n"][reverse],
        "load": (bins["load"][forward] + bins["load"][reverse]) / 2,
    }
