"""Stage ``pair``: counter-directed motion at the same speed, joint, temperature and angle."""

import math
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.errors import NotEnoughData
from frictioncli.pairs.matching import Matches, SegmentArrays, match_bins
from frictioncli.pairs.matching_groups import MatchingGroup, matching_groups
from frictioncli.pairs.partitioned_store import Columns, PartitionedStore
from frictioncli.pairs.segments import TEMPERATURES, Joint, Segments
from frictioncli.pairs.settings import PairingSettings
from frictioncli.pairs.speed_levels import SpeedCounts, speed_levels, steps_of

Level = tuple[int, int]

_ALONE = "no counter-directed partner"
_NOT_SHARED = "angle not shared with the partner"
_OTHER_PAYLOAD = "the partner has another payload"

_ALIKE = 0.01
"""Speeds this close to the middle one of their level are one commanded speed."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """Pairs, and what was left over.

    Attributes
    ----------
    pages : PartitionedStore
        Pages by run and joint, of two tables. ``heads``, one row per pair in time order: pair (its
        number), level, recording (its number), speed, time, the temperatures, payload. ``rows``,
        one row per pair and angle bin: pair, bin, torques and samples of both directions, load.
    speeds : dict of (int, int) to float
        The number that stands for a commanded speed, by joint and level. [deg/s]
    middles : dict of (int, int) to float
        Median speed of the pairs, by joint and level. [deg/s]
    dropped : dict of str to int
        Samples by reason; with the samples of the pairs they are all samples.
    """

    pages: PartitionedStore[Joint]
    speeds: dict[Level, float]
    middles: dict[Level, float]
    dropped: dict[str, int]

    def speed_of(self, joint: int, heads: Columns) -> Array:
        """Return the speed of pairs: one commanded speed gets one number [deg/s]."""
        common, middle = (
            np.array([by_level[joint, level] for level in heads["level"].tolist()])
            for by_level in (self.speeds, self.middles)
        )
        return np.where(_alike(heads["speed"], middle), common, heads["speed"])


def pair_segments(
    found: Segments,
    settings: PairingSettings,
    pages: PartitionedStore[Joint],
    payload: pd.Series | None = None,
) -> Pairing:
    """Pair counter-directed spans and put both torques of each angle bin side by side.

    Moves with different payloads are loaded differently and make no pair; nor do a move whose
    payload is known and one whose is not. Of the latter two are taken to carry the same.

    Parameters
    ----------
    found : Segments
        The constant-velocity spans.
    settings : PairingSettings
        What makes a pair.
    pages : PartitionedStore
        Where the pairs go.
    payload : Series, optional
        Payload by run and recording, missing where unknown. [kg]

    Raises
    ------
    NotEnoughData
        If nothing moves at constant velocity, or nothing has a counter-directed partner.
    """
    if not found.counts:
        raise NotEnoughData(
            f"no constant-velocity motion in {found.samples} samples"
            f" ({_told(found.dropped)}); expected moves that hold a speed above"
            f" {settings.steady.min_speed:g} deg/s; look at the velocity, or loosen --min-speed,"
            " --speed-tolerance, --settling"
        )
    work = _Matching(
        settings,
        _steps_and_levels(found, settings),
        _payloads(found, payload),
        pages,
        dict.fromkeys((_ALONE, _NOT_SHARED, _OTHER_PAYLOAD), 0),
    )
    for joint in sorted(found.counts):
        count = 0
        for section in matching_groups(found.pages, joint):
            count += work.add(joint, section, count)
    if not work.middles:
        mixed = f", {_OTHER_PAYLOAD}" if work.dropped[_OTHER_PAYLOAD] else ""
        raise NotEnoughData(
            f"no pair of counter-directed moves: {_directions(found)}{mixed}; expected motion there"
            " and back over the same angles at the same speed; log both directions, or loosen"
            " --same-speed, --same-temperature, --longest-pause"
        )
    middles = {level: counts.median for level, counts in work.middles.items()}
    return Pairing(pages, _common(pages, middles), middles, found.dropped | work.dropped)


@dataclass(slots=True)
class _Matching:
    """Pairs section by section, and counts."""

    settings: PairingSettings
    levels: tuple[Numbers, Numbers]
    payloads: Array
    pages: PartitionedStore[Joint]
    dropped: dict[str, int]
    middles: dict[Level, SpeedCounts] = field(default_factory=dict)

    def add(self, joint: Joint, section: MatchingGroup, count: int) -> int:
        """Pair the spans of a section, numbered from ``count``; return how many pairs they make."""
        spans, visits = section.spans, section.visits
        level = self.levels[1][np.searchsorted(self.levels[0], steps_of(spans["speed"]))]
        payload = self.payloads[spans["recording"]]
        arrays = _arrays(spans, visits)
        matches = match_bins(arrays, _groups(spans["start"], level, payload), self.settings)
        used = matches.visit_couple >= 0
        other = ~used
        if len(np.unique(payload)) > 1:
            # those of one payload have been matched as far as they can be
            rest = _arrays(spans, {name: values[~used] for name, values in visits.items()})
            again = match_bins(rest, _groups(spans["start"], level), self.settings)
            other[~used] = again.visit_couple >= 0
        else:
            other[:] = False
        coupled = np.concatenate([matches.forward, matches.reverse])
        alone = ~np.isin(visits["span"], coupled)
        for reason, rows in (
            (_ALONE, ~used & ~other & alone),
            (_NOT_SHARED, ~used & ~other & ~alone),
            (_OTHER_PAYLOAD, other),
        ):
            self.dropped[reason] += int(visits["n"][rows].sum())
        if not len(coupled):
            return 0
        heads, number = _heads(spans, matches, level, payload, count)
        for one in np.unique(heads["level"]).tolist():
            counts = self.middles.setdefault((joint[1], one), SpeedCounts())
            counts.add(heads["speed"][heads["level"] == one])
        self.pages.add(joint, {"heads": heads, "rows": _rows(visits, matches, number)})
        return len(heads["pair"])


def _steps_and_levels(found: Segments, settings: PairingSettings) -> tuple[Numbers, Numbers]:
    """Return the steps of speed that occur, growing, and the speed level of each."""
    counts = SpeedCounts()
    for part in found.speeds.values():
        counts.add(part.speeds)
    return counts.steps, speed_levels(counts.speeds, settings.same_speed)


def _payloads(found: Segments, payload: pd.Series | None) -> Array:
    """Return the payload of each recording, NaN where unknown [kg]."""
    if payload is None:
        return np.full(len(found.recordings), np.nan)
    return payload.reindex(pd.MultiIndex.from_tuples(found.recordings)).to_numpy(float)


def _groups(start: Array, level: Numbers, payload: Array | None = None) -> list[Numbers]:
    """Return the spans that may pair with each other, in time order."""
    kind = np.zeros(len(level)) if payload is None else payload
    order = np.lexsort((start, kind, level))
    # an unknown payload is equal to another unknown one
    _, code = np.unique(kind[order], return_inverse=True)
    new = (np.diff(level[order]) != 0) | (np.diff(code) != 0)
    return np.split(order, np.flatnonzero(new) + 1)


def _arrays(spans: Columns, visits: Columns) -> SegmentArrays:
    return SegmentArrays(
        direction=spans["direction"],
        start=spans["start"],
        stop=spans["stop"],
        temperature=spans["motor_temperature"],
        visit_span=visits["span"],
        visit_bin=visits["bin"],
        visit_time=visits["time"],
    )


def _heads(
    spans: Columns, matches: Matches, level: Numbers, payload: Array, count: int
) -> tuple[Columns, Numbers]:
    """Return what the two spans of each pair have in common, in time order; and their numbers."""
    one, other = matches.forward, matches.reverse
    start, stop = spans["start"], spans["stop"]
    time = (start[one] + stop[one] + start[other] + stop[other]) / 4
    order = np.lexsort((one, time))
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(count, count + len(order))
    heads = {
        "level": level[one],
        "recording": spans["recording"][one],
        "time": time,
        "payload": payload[one],
    }
    for name in ("speed", *TEMPERATURES):
        heads[name] = (spans[name][one] + spans[name][other]) / 2
    heads = {name: values[order] for name, values in heads.items()}
    return {"pair": number[order]} | heads, number


def _rows(visits: Columns, matches: Matches, number: Numbers) -> Columns:
    """Return one row per pair and bin, in the order of pairs and angles."""
    used = np.flatnonzero(matches.visit_couple >= 0)
    couple = matches.visit_couple[used]
    ahead = visits["span"][used] == matches.forward[couple]
    sides = []
    for side in (used[ahead], used[~ahead]):
        pair = number[matches.visit_couple[side]]
        sides.append(side[np.lexsort((visits["bin"][side], pair))])
    forward, reverse = sides
    return {
        "pair": number[matches.visit_couple[forward]],
        "bin": visits["bin"][forward],
        "torque_forward": visits["torque"][forward],
        "torque_reverse": visits["torque"][reverse],
        "n_forward": visits["n"][forward],
        "n_reverse": visits["n"][reverse],
        "load": (visits["load"][forward] + visits["load"][reverse]) / 2,
    }


def _alike(speed: Array, middle: Array | float) -> Flags:
    return np.abs(speed - middle) < _ALIKE * middle


def _common(pages: PartitionedStore[Joint], middles: dict[Level, float]) -> dict[Level, float]:
    """Return the mean of the speeds that are alike, by joint and level [deg/s]."""
    sums: dict[Level, list[float]] = {level: [] for level in middles}
    counts = dict.fromkeys(middles, 0)
    for joint in pages.keys:
        for (heads,) in pages.of(joint, "heads"):
            for one in np.unique(heads["level"]).tolist():
                level = joint[1], one
                speed = heads["speed"][heads["level"] == one]
                alike = speed[_alike(speed, middles[level])]
                sums[level].append(math.fsum(alike))
                counts[level] += len(alike)
    return {level: math.fsum(sums[level]) / max(counts[level], 1) for level in middles}


def _told(dropped: dict[str, int]) -> str:
    return ", ".join(f"{reason}: {count}" for reason, count in dropped.items() if count)


def _directions(found: Segments) -> str:
    told = []
    for name, sign in (("forward", 1), ("reverse", -1)):
        counts = found.speeds[sign]
        reach = (
            f" at {counts.speeds[0]:.3g} to {counts.speeds[-1]:.3g} deg/s" if counts.total else ""
        )
        told.append(f"{counts.total} constant-velocity parts {name}{reach}")
    return ", ".join(told)
