"""Samples, batch by batch, to constant-velocity spans and their means per angle bin.

Memory is bounded: of a long recording only the move that a batch cuts is kept for the next one.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

import numpy as np
import pandas as pd
import pyarrow as pa
from numpy.typing import NDArray

from frictioncli.motion.ramps import COLUMNS, PARTS, ramp_rows
from frictioncli.motion.settings import SteadySettings
from frictioncli.motion.steady import (
    REASONS,
    STANDING,
    STEADY,
    SteadyPart,
    moves,
    smoothed,
    steady_parts,
)

Array = NDArray[np.float64]

_KEY = ("run", "recording", "joint")
_CHANNELS = (
    "time",
    "position",
    "velocity",
    "torque",
    "motor_temperature",
    "housing_temperature",
    "motor_temperature_reading",
    "load",
)
_LONGEST_MOVE = 2_000_000
"""A joint that turns on and on is cut here, so that memory stays bounded. [samples]"""

_LEAST_COVER = 0.5
"""Share of an angle bin that a span must have crossed for its mean to stand for the bin."""


@dataclass(frozen=True, slots=True)
class Spans:
    """The constant-velocity spans of a work folder.

    Attributes
    ----------
    spans : DataFrame
        One row per span: run, recording, joint, direction (+1, -1), speed [deg/s], start, stop,
        [s], motor_temperature, housing_temperature, motor_temperature_reading [°C].
    visits : DataFrame
        One row per span and angle bin: span (row number in ``spans``), bin (number), n (samples),
        torque at the bin's centre, load, time [s].
    ramps : DataFrame
        Rows of :data:`frictioncli.schemas.RAMPS` (without payload).
    samples : int
        Samples read.
    dropped : dict of str to int
        Samples that are in no visit, by reason.
    bin_width : float
        Width of the bins. [deg]
    """

    spans: pd.DataFrame
    visits: pd.DataFrame
    ramps: pd.DataFrame
    samples: int
    dropped: dict[str, int]
    bin_width: float


def find_spans(
    batches: Iterable[pa.RecordBatch], settings: SteadySettings, bin_width: float
) -> Spans:
    """Find the constant-velocity spans in samples that come in order, in batches of any size.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.SAMPLES`; those of one recording and joint in time order.
    settings : SteadySettings
        What counts as constant velocity.
    bin_width : float
        Width of an angle bin; widened where a log is sampled so slowly that bins stay empty. [deg]
    """
    batches = iter(batches)
    head = next(batches, None)
    if head is None:
        return _Collector(settings, bin_width).result()
    collector = _Collector(settings, max(bin_width, _least_width(head, settings, bin_width)))
    open_moves: dict[tuple, dict[str, Array]] = {}
    for batch in chain([head], batches):
        frame = batch.to_pandas()
        recordings = set()
        for key, rows in frame.groupby(list(_KEY), sort=False, observed=True):
            recordings.add(key[:2])
            channels = _channels(rows)
            if key in open_moves:
                kept = open_moves.pop(key)
                channels = {name: np.append(kept[name], channels[name]) for name in _CHANNELS}
            cut = _last_complete(channels, settings)
            collector.add(key, {name: values[:cut] for name, values in channels.items()})
            open_moves[key] = {name: values[cut:] for name, values in channels.items()}
        for key in [key for key in open_moves if key[:2] not in recordings]:
            collector.add(key, open_moves.pop(key))
    for key, channels in open_moves.items():
        collector.add(key, channels)
    return collector.result()


def _least_width(head: pa.RecordBatch, settings: SteadySettings, step: float) -> float:
    """Return the width, in whole multiples of ``step``, that no move steps over between samples."""
    frame = head.to_pandas()
    grouped = frame.groupby(list(_KEY), sort=False, observed=True)
    way = (frame["velocity"].abs() * grouped["time"].diff())[
        frame["velocity"].abs() > settings.min_speed
    ].dropna()
    return 0.0 if way.empty else float(np.ceil(way.median() / step - 1e-9) * step)


def _channels(rows: pd.DataFrame) -> dict[str, Array]:
    missing = np.full(len(rows), np.nan)
    return {name: rows[name].to_numpy(float) if name in rows else missing for name in _CHANNELS}


def _last_complete(channels: dict[str, Array], settings: SteadySettings) -> int:
    """Return where the last, perhaps unfinished, move starts."""
    time = channels["time"]
    found = moves(time, smoothed(time, channels["velocity"]), settings)
    if not found or len(time) > _LONGEST_MOVE:
        return len(time)
    # the moving mean near the cut needs a few samples of standstill before the move
    return found[-1][0]


class _Collector:
    """Gathers spans and visits while the samples go by."""

    def __init__(self, settings: SteadySettings, bin_width: float) -> None:
        self._settings = settings
        self._width = bin_width
        self._spans: list[dict] = []
        self._visits: list[dict[str, Array]] = []
        self._ramps: list[tuple[tuple, dict[str, Array]]] = []
        self._ways: dict[tuple, int] = {}
        self._samples = 0
        self._dropped = dict.fromkeys((*REASONS, "angle bin barely crossed"), 0)

    def add(self, key: tuple, channels: dict[str, Array]) -> None:
        parts, classes = steady_parts(channels["time"], channels["velocity"], self._settings)
        self._samples += len(classes)
        counts = np.bincount(classes, minlength=STEADY + 1)
        for reason, count in zip(REASONS, counts[STANDING:STEADY], strict=True):
            self._dropped[reason] += int(count)
        ramps = ramp_rows(channels, parts, self._ways.get(key, 0))
        self._ramps.append((key, ramps | {"move": ramps["move"] + len(self._spans)}))
        for part in parts:
            self._add_part(key, channels, part)
        if parts:
            self._ways[key] = 1 if parts[-1].speed > 0 else -1

    def _add_part(self, key: tuple, channels: dict[str, Array], part: SteadyPart) -> None:
        inside = {name: values[part.start : part.stop] for name, values in channels.items()}
        time = inside["time"]
        self._spans.append(
            dict(zip(_KEY, key, strict=True))
            | {
                "direction": 1 if part.speed > 0 else -1,
                "speed": abs(part.speed),
                "start": time[0],
                "stop": time[-1],
            }
            | {name: _mean(inside[name]) for name in _CHANNELS if "temperature" in name}
        )
        visits = bin_means(
            position=inside["position"],
            torque=inside["torque"],
            load=inside["load"],
            time=time,
            width=self._width,
        )
        step = abs(part.speed) * float(np.median(np.diff(time)))
        expected = max(self._width / max(step, 1e-9), 1.0)
        covered = visits["n"] >= _LEAST_COVER * expected
        self._dropped["angle bin barely crossed"] += int(visits["n"][~covered].sum())
        kept = {name: values[covered] for name, values in visits.items()}
        self._visits.append(kept | {"span": np.full(covered.sum(), len(self._spans) - 1)})

    def result(self) -> Spans:
        names = ("span", "bin", "n", "torque", "load", "time")
        parts = self._visits or [{name: np.empty(0) for name in names}]
        return Spans(
            spans=pd.DataFrame(self._spans),
            visits=pd.DataFrame(
                {name: np.concatenate([part[name] for part in parts]) for name in names}
            ),
            ramps=_ramps(self._ramps),
            samples=self._samples,
            dropped=self._dropped,
            bin_width=self._width,
        )


def _ramps(parts: list[tuple[tuple, dict[str, Array]]]) -> pd.DataFrame:
    """Return the ramps of all recordings as one table."""
    rows = [len(part["move"]) for _, part in parts]
    columns = {name: [part[name] for _, part in parts] for name in COLUMNS}
    keys = {
        name: pd.Categorical.from_codes(*_repeated([key[i] for key, _ in parts], rows))
        for i, name in enumerate(_KEY)
    }
    values = {name: np.concatenate([*found, np.empty(0)]) for name, found in columns.items()}
    part = pd.Categorical.from_codes(values["part"].astype(np.int8), list(PARTS))
    counts = {name: values[name].astype(np.int64) for name in ("move", "bin", "samples")}
    counts["direction"] = values["direction"].astype(np.int16)
    joint = np.asarray(keys["joint"].astype(np.int16)) if parts else np.empty(0, np.int16)
    return pd.DataFrame(
        keys
        | values
        | counts
        | {"joint": joint, "part": part, "reversal": values["reversal"].astype(bool)}
    )


def _repeated(labels: list, counts: list[int]) -> tuple[NDArray[np.intp], list]:
    """Return each label as often as told, as codes and the labels that differ."""
    codes, names = pd.factorize(np.array(labels, dtype=object))
    return np.repeat(codes, counts), list(names)


def _mean(values: Array) -> float:
    finite = values[np.isfinite(values)]
    return float(np.mean(finite)) if finite.size else float("nan")


def bin_means(
    *, position: Array, torque: Array, load: Array, time: Array, width: float
) -> dict[str, Array]:
    """Return mean torque per angle bin, carried to the bin's centre along the torque's slope.

    A bin that a move crossed only in part has its samples off its centre; left there, the gravity
    torque of the two directions would be taken at different angles.

    Parameters
    ----------
    position, torque, load, time : ndarray, shape (samples,)
        Samples of one constant-velocity span. [deg], [N·m], [N·m], [s]
    width : float
        Width of the bins; bin 0 reaches from 0 to ``width``. [deg]

    Returns
    -------
    dict of str to ndarray, shape (bins,)
        ``bin`` (number), ``n`` (samples), ``torque``, ``load``, ``time``, by growing angle.
    """
    number = np.floor(position / width).astype(np.int64)
    first = number.min()
    index = number - first
    count = np.bincount(index)
    hit = np.flatnonzero(count)
    n = count[hit]
    mean_position, mean_torque, mean_load, mean_time = (
        np.bincount(index, values)[hit] / n for values in (position, torque, load, time)
    )
    centre = (hit + first + 0.5) * width
    if len(hit) > 1:
        for values in (mean_torque, mean_load):
            values += np.gradient(values, mean_position) * (centre - mean_position)
    return {
        "bin": hit + first,
        "n": n,
        "torque": mean_torque,
        "load": mean_load,
        "time": mean_time,
    }
