"""Constant-speed segments of all samples, and their means per angle bin.

Samples are read in chunks, and what is found goes to a store on disk, so memory stays bounded.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Array, Flags
from frictioncli.pairs.bins import bin_means
from frictioncli.pairs.chunks import SampleChunk, chunks
from frictioncli.pairs.constant_speed import (
    REASONS,
    ConstantSpeedSegments,
    constant_speed_segments,
)
from frictioncli.pairs.other_joints import (
    STAND_ELSEWHERE,
    OtherMotion,
    bins_with_marks,
    joints_that_move,
    numbers_of_segments,
)
from frictioncli.pairs.partitioned_store import Columns, PartitionedStore
from frictioncli.pairs.ramps import MEANS, PreviousMove, ramp_means
from frictioncli.pairs.settings import SteadySettings
from frictioncli.pairs.slices import slice_means
from frictioncli.pairs.speed_levels import SpeedCounts
from frictioncli.pairs.starts import StartCounts

Joint = tuple[str, int]

TEMPERATURES = ("motor_temperature", "housing_temperature", "motor_temperature_reading")
_CHANNELS = (*MEANS, "motor_temperature_reading", "other_speed", "other_joints", "pose", "payload")

_FIRST_ROWS = 1 << 17
"""Samples from which it is found whether the angle bins must be wider."""

_LEAST_COVERAGE = 0.5
"""Share of an angle bin that a segment must cover for its mean to represent the bin."""

_BARELY = "angle bin barely crossed"


@dataclass(frozen=True, slots=True)
class SegmentTables:
    """Segments, bins and ramps of all samples.

    Attributes
    ----------
    store : PartitionedStore
        Three tables by run and joint. ``segments``, one row per segment: recording (its number in
        ``recordings``), direction (+1, -1), speed [deg/s], start, stop [s], motor_temperature,
        housing_temperature, motor_temperature_reading [°C], pose (of the other joints), payload
        [kg] where it differs within recordings. ``bins``, one row per segment and angle bin:
        segment (number within run and joint), bin (number), n (samples), torque at the bin's
        centre, load, time [s], shared (whether another joint moved meanwhile). ``ramps``: rows of
        :func:`frictioncli.pairs.ramps.ramp_means` with recording, pose and payload; ``move`` is the
        number of the segment. ``starts``: rows of :class:`frictioncli.pairs.starts.StartCounts`
        likewise.
    counts : dict of (str, int) to int
        Number of segments of each run and joint that has some.
    recordings : list of tuple of str
        Run and recording.
    bin_width : float
        Width of the bins. [deg]
    dropped : dict of str to int
        Samples that are in no bin, by reason.
    speeds : dict of int to SpeedCounts
        Counts of the segments' speeds, by direction.
    samples : int
        Number of samples read.
    other_motion : OtherMotion
        Samples in bins during which other joints moved.
    starts : StartCounts
        Which starts are to be kept.
    moving : dict of int to int
        Samples in motion, by joint.
    """

    store: PartitionedStore[Joint]
    counts: dict[Joint, int]
    recordings: list[tuple[str, str]]
    bin_width: float
    dropped: dict[str, int]
    speeds: dict[int, SpeedCounts]
    samples: int
    other_motion: OtherMotion
    starts: StartCounts
    moving: dict[int, int]


def without_angle(batch: pa.RecordBatch) -> pa.RecordBatch:
    """Return samples with position 0, so that moves are paired by speed alone.

    Parameters
    ----------
    batch : RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES` whose position was integrated from velocity.
    """
    index = batch.schema.get_field_index("position")
    zeros = pa.array(np.zeros(batch.num_rows))
    return batch.set_column(index, batch.schema.field(index), zeros)


def find_segments(
    batches: Iterable[pa.RecordBatch],
    settings: SteadySettings,
    bin_width: float,
    store: PartitionedStore[Joint],
) -> SegmentTables:
    """Find the constant-speed segments in samples that come in order, in batches of any size.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`; those of one recording stand together, those of
        one of its joints in time order.
    settings : SteadySettings
        What counts as constant speed.
    bin_width : float
        Width of an angle bin; widened where a log is sampled so slowly that bins stay empty. [deg]
    store : PartitionedStore
        Store for segments, bins and ramps.

    Returns
    -------
    SegmentTables
        The segments.
    """
    batches = iter(batches)
    first = _first_batches(batches)
    finder = _Finder(settings, max(bin_width, _least_width(first, settings, bin_width)), store)
    for chunk in chunks(chain(first, batches), _CHANNELS, settings):
        finder.add(chunk)
    return finder.result()


def _first_batches(batches: Iterable[pa.RecordBatch]) -> list[pa.RecordBatch]:
    first, rows = [], 0
    for batch in batches:
        first.append(batch)
        rows += batch.num_rows
        if rows >= _FIRST_ROWS:
            break
    return first


def _least_width(first: list[pa.RecordBatch], settings: SteadySettings, step: float) -> float:
    """Return the width, in whole multiples of ``step``, that no move exceeds between samples."""
    if not first:
        return 0.0
    names = ["run", "recording", "joint", "time", "velocity"]
    rows = pa.Table.from_batches([batch.select(names) for batch in first]).slice(0, _FIRST_ROWS)
    frame = rows.unify_dictionaries().to_pandas()
    grouped = frame.groupby(names[:3], sort=False, observed=True)
    turned = (frame["velocity"].abs() * grouped["time"].diff())[
        frame["velocity"].abs() > settings.min_speed
    ].dropna()
    return 0.0 if turned.empty else float(np.ceil(turned.median() / step - 1e-9) * step)


@dataclass(slots=True)
class _Finder:
    """Adds the segments of each chunk to the store, and counts."""

    settings: SteadySettings
    width: float
    store: PartitionedStore[Joint]
    counts: dict[Joint, int] = field(default_factory=dict)
    recordings: list[tuple[str, str]] = field(default_factory=list)
    samples: int = 0
    dropped: dict[str, int] = field(
        default_factory=lambda: dict.fromkeys((*REASONS, _BARELY, STAND_ELSEWHERE), 0)
    )
    speeds: dict[int, SpeedCounts] = field(
        default_factory=lambda: {1: SpeedCounts(), -1: SpeedCounts()}
    )
    other_motion: OtherMotion = field(default_factory=OtherMotion)
    starts: StartCounts = field(default_factory=StartCounts)
    moving: dict[int, int] = field(default_factory=dict)
    _last_moves: dict[int, tuple[int, int]] = field(default_factory=dict)

    def add(self, chunk: SampleChunk) -> None:
        source, channels = chunk.source, chunk.channels
        if not self.recordings or self.recordings[-1] != source[:2]:
            self.recordings.append(source[:2])
            self._last_moves = {}
        found = constant_speed_segments(
            channels["time"],
            channels["velocity"],
            chunk.total,
            chunk.move_start,
            chunk.move_stop,
            self.settings,
        )
        self.samples += chunk.end - chunk.begin
        self.dropped["standing"] += chunk.standing
        moving = chunk.end - chunk.begin - chunk.standing
        self.moving[source.joint] = self.moving.get(source.joint, 0) + moving
        for reason, count in found.dropped.items():
            self.dropped[reason] += count
        if not len(found.start):
            return
        for direction, counts in self.speeds.items():
            counts.add(np.abs(found.speed[np.sign(found.speed) == direction]))
        direction, stop = self._last_moves.get(source.joint, (0, 0))
        previous = PreviousMove(direction, stop - chunk.offset)
        pose, elsewhere = numbers_of_segments(channels["pose"], found.start, found.stop)
        payload, other = numbers_of_segments(channels["payload"], found.start, found.stop)
        elsewhere |= other
        tables = {
            "segments": self._segments(channels, found) | {"pose": pose, "payload": payload},
            "bins": self._bins(channels, found, source.joint, chunk.period, elsewhere),
            "ramps": ramp_means(channels, found, chunk.period, previous),
            "starts": self.starts.add((source.run, source.joint), channels, found, chunk.period),
        }
        for name in ("segments", "ramps", "starts"):
            rows = len(tables[name]["speed"])
            tables[name]["recording"] = np.full(rows, len(self.recordings) - 1)
        joint = source.run, source.joint
        before = self.counts.get(joint, 0)
        tables["bins"]["segment"] = tables["bins"]["segment"] + before
        for name in ("ramps", "starts"):
            tables[name] |= {
                "pose": pose[tables[name]["move"]],
                "payload": payload[tables[name]["move"]],
            }
            tables[name]["move"] = tables[name]["move"] + before
        self.counts[joint] = before + len(found.start)
        self.store.add(joint, tables)
        self._last_moves[source.joint] = (
            int(np.sign(found.speed[-1])),
            int(chunk.offset + found.stop[-1]),
        )

    def _segments(self, channels: dict[str, Array], found: ConstantSpeedSegments) -> Columns:
        return {
            "direction": np.sign(found.speed).astype(np.int64),
            "speed": np.abs(found.speed),
            "start": channels["time"][found.start],
            "stop": channels["time"][found.stop - 1],
        } | {name: slice_means(channels[name], found.start, found.stop) for name in TEMPERATURES}

    def _bins(
        self,
        channels: dict[str, Array],
        found: ConstantSpeedSegments,
        joint: int,
        period: float,
        elsewhere: Flags,
    ) -> Columns:
        time, start, stop = channels["time"], found.start, found.stop
        means = bin_means(
            position=channels["position"],
            torque=channels["torque"],
            load=channels["load"],
            time=time,
            start=start,
            stop=stop,
            width=self.width,
        )
        step = np.abs(found.speed) * (time[stop - 1] - time[start]) / (stop - start - 1)
        expected = np.maximum(self.width / np.maximum(step, 1e-9), 1.0)
        covered = means.n >= _LEAST_COVERAGE * expected[means.segment]
        self.dropped[_BARELY] += int(means.n[~covered].sum())
        bins = {
            name: getattr(means, name)[covered]
            for name in ("segment", "bin", "n", "torque", "load", "time")
        }

        def marked(samples: Flags) -> Flags:
            return bins_with_marks(
                samples,
                channels["position"],
                start,
                stop,
                self.width,
                bins["segment"],
                bins["bin"],
            )

        gone = marked(elsewhere)
        self.dropped[STAND_ELSEWHERE] += int(bins["n"][gone].sum())
        bins = {name: values[~gone] for name, values in bins.items()}
        shared = marked(channels["other_speed"] > 0)
        self.other_motion.add(joint, bins["n"], bins["segment"], shared, period)
        if shared.any():
            others = joints_that_move(channels["other_joints"], start, stop)
            self.other_motion.others[joint] = self.other_motion.others.get(joint, 0) | others
        return bins | {"shared": shared}

    def result(self) -> SegmentTables:
        return SegmentTables(
            self.store,
            self.counts,
            self.recordings,
            self.width,
            self.dropped,
            self.speeds,
            self.samples,
            self.other_motion,
            self.starts,
            self.moving,
        )
