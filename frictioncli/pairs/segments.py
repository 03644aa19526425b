"""Samples, batch by batch, to constant-velocity spans and their means per angle bin.

Memory is bounded: of a long recording only the move that a batch cuts is kept for the next one, and
what is found goes to pages on disk.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
import pyarrow as pa

from frictioncli.arrays import Array
from frictioncli.pairs.array_runs import means
from frictioncli.pairs.bins import bin_means
from frictioncli.pairs.chunks import Chunk, chunks
from frictioncli.pairs.constant_speed import REASONS, ConstantSpeedParts, constant_speed_parts
from frictioncli.pairs.partitioned_store import Columns, PartitionedStore
from frictioncli.pairs.ramps import MEANS, ComingFrom, ramp_rows
from frictioncli.pairs.settings import SteadySettings
from frictioncli.pairs.speed_levels import SpeedCounts

Joint = tuple[str, int]

TEMPERATURES = ("motor_temperature", "housing_temperature", "motor_temperature_reading")
_CHANNELS = (*MEANS, "motor_temperature_reading")

_HEAD_ROWS = 1 << 17
"""Samples that are looked at to find out whether the angle bins must be wider."""

_LEAST_COVER = 0.5
"""Share of an angle bin that a span must have crossed for its mean to stand for the bin."""

_BARELY = "angle bin barely crossed"


@dataclass(frozen=True, slots=True)
class Segments:
    """What has been found in the samples of a work folder.

    Attributes
    ----------
    pages : PartitionedStore
        Pages by run and joint, of three tables. ``spans``, one row per span: recording (its number
        in ``recordings``), direction (+1, -1), speed [deg/s], start, stop [s], motor_temperature,
        housing_temperature, motor_temperature_reading [°C]. ``visits``, one row per span and angle
        bin: span (number within run and joint), bin (number), n (samples), torque at the bin's
        centre, load, time [s]. ``ramps``: rows of :func:`frictioncli.pairs.ramps.ramp_rows` with
        recording; ``move`` is the span's number.
    counts : dict of (str, int) to int
        Spans of each run and joint that has some.
    recordings : list of tuple of str
        Run and recording.
    bin_width : float
        Width of the bins. [deg]
    dropped : dict of str to int
        Samples that are in no visit, by reason.
    speeds : dict of int to SpeedCounts
        How many spans have which speed, by direction.
    samples : int
        Samples read.
    """

    pages: PartitionedStore[Joint]
    counts: dict[Joint, int]
    recordings: list[tuple[str, str]]
    bin_width: float
    dropped: dict[str, int]
    speeds: dict[int, SpeedCounts]
    samples: int


def find_segments(
    batches: Iterable[pa.RecordBatch],
    settings: SteadySettings,
    bin_width: float,
    pages: PartitionedStore[Joint],
) -> Segments:
    """Find the constant-velocity spans in samples that come in order, in batches of any size.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`; those of one recording stand together, those of
        one of its joints in time order.
    settings : SteadySettings
        What counts as constant velocity.
    bin_width : float
        Width of an angle bin; widened where a log is sampled so slowly that bins stay empty. [deg]
    pages : PartitionedStore
        Where spans, visits and ramps go.
    """
    batches = iter(batches)
    head = _head(batches)
    found = _Finding(settings, max(bin_width, _least_width(head, settings, bin_width)), pages)
    for stretch in chunks(chain(head, batches), _CHANNELS, settings):
        found.add(stretch)
    return found.result()


def _head(batches: Iterable[pa.RecordBatch]) -> list[pa.RecordBatch]:
    head, rows = [], 0
    for batch in batches:
        head.append(batch)
        rows += batch.num_rows
        if rows >= _HEAD_ROWS:
            break
    return head


def _least_width(head: list[pa.RecordBatch], settings: SteadySettings, step: float) -> float:
    """Return the width, in whole multiples of ``step``, that no move steps over between samples."""
    if not head:
        return 0.0
    names = ["run", "recording", "joint", "time", "velocity"]
    rows = pa.Table.from_batches([batch.select(names) for batch in head]).slice(0, _HEAD_ROWS)
    frame = rows.unify_dictionaries().to_pandas()
    grouped = frame.groupby(names[:3], sort=False, observed=True)
    way = (frame["velocity"].abs() * grouped["time"].diff())[
        frame["velocity"].abs() > settings.min_speed
    ].dropna()
    return 0.0 if way.empty else float(np.ceil(way.median() / step - 1e-9) * step)


@dataclass(slots=True)
class _Finding:
    """Takes what is found, stretch by stretch, to its pages, and counts."""

    settings: SteadySettings
    width: float
    pages: PartitionedStore[Joint]
    counts: dict[Joint, int] = field(default_factory=dict)
    recordings: list[tuple[str, str]] = field(default_factory=list)
    samples: int = 0
    dropped: dict[str, int] = field(default_factory=lambda: dict.fromkeys((*REASONS, _BARELY), 0))
    speeds: dict[int, SpeedCounts] = field(
        default_factory=lambda: {1: SpeedCounts(), -1: SpeedCounts()}
    )
    _ways: dict[int, tuple[int, int]] = field(default_factory=dict)

    def add(self, stretch: Chunk) -> None:
        source, channels = stretch.source, stretch.channels
        if not self.recordings or self.recordings[-1] != source[:2]:
            self.recordings.append(source[:2])
            self._ways = {}
        parts = constant_speed_parts(
            channels["time"],
            channels["velocity"],
            stretch.total,
            stretch.first,
            stretch.last,
            self.settings,
        )
        self.samples += stretch.end - stretch.begin
        self.dropped["standing"] += stretch.standing
        for reason, count in parts.dropped.items():
            self.dropped[reason] += count
        if not len(parts.start):
            return
        for direction, counts in self.speeds.items():
            counts.add(np.abs(parts.speed[np.sign(parts.speed) == direction]))
        way, since = self._ways.get(source.joint, (0, 0))
        came_from = ComingFrom(way, since - stretch.number)
        tables = {
            "spans": self._spans(channels, parts),
            "visits": self._visits(channels, parts),
            "ramps": ramp_rows(channels, parts, stretch.period, came_from),
        }
        for name in ("spans", "ramps"):
            rows = len(tables[name]["speed"])
            tables[name]["recording"] = np.full(rows, len(self.recordings) - 1)
        joint = source.run, source.joint
        before = self.counts.get(joint, 0)
        tables["visits"]["span"] = tables["visits"]["span"] + before
        tables["ramps"]["move"] = tables["ramps"]["move"] + before
        self.counts[joint] = before + len(parts.start)
        self.pages.add(joint, tables)
        self._ways[source.joint] = (
            int(np.sign(parts.speed[-1])),
            int(stretch.number + parts.stop[-1]),
        )

    def _spans(self, channels: dict[str, Array], parts: ConstantSpeedParts) -> Columns:
        return {
            "direction": np.sign(parts.speed).astype(np.int64),
            "speed": np.abs(parts.speed),
            "start": channels["time"][parts.start],
            "stop": channels["time"][parts.stop - 1],
        } | {name: means(channels[name], parts.start, parts.stop) for name in TEMPERATURES}

    def _visits(self, channels: dict[str, Array], parts: ConstantSpeedParts) -> Columns:
        time, start, stop = channels["time"], parts.start, parts.stop
        visits = bin_means(
            position=channels["position"],
            torque=channels["torque"],
            load=channels["load"],
            time=time,
            start=start,
            stop=stop,
            width=self.width,
        )
        step = np.abs(parts.speed) * (time[stop - 1] - time[start]) / (stop - start - 1)
        expected = np.maximum(self.width / np.maximum(step, 1e-9), 1.0)
        covered = visits.n >= _LEAST_COVER * expected[visits.span]
        self.dropped[_BARELY] += int(visits.n[~covered].sum())
        return {
            name: getattr(visits, name)[covered]
            for name in ("span", "bin", "n", "torque", "load", "time")
        }

    def result(self) -> Segments:
        return Segments(
            self.pages,
            self.counts,
            self.recordings,
            self.width,
            self.dropped,
            self.speeds,
            self.samples,
        )
