"""A run written as a trace folder, and what is true about it."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.enriched_protocol import second_shares
from frictioncli.simulator.paper_protocol import SeriesOfMoves
from frictioncli.simulator.planted.state import Extra, State
from frictioncli.simulator.recording import record
from frictioncli.simulator.run import RunCourse
from frictioncli.simulator.trace_writer import ManifestRow, manifest_text, moment, write_trace

MANIFEST = "manifest.csv"
"""File that tells when each recording started."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """What was made for one run.

    Attributes
    ----------
    name : str
        Name of its folder.
    recordings : int
        Number of trace files.
    rows : int
        Samples in them.
    heating, cooling : float
        Durations of the first heat-up and cool-down. [s]
    ambient : float
        Ambient temperature at its start. [°C]
    motor_heat_share : float
        Share of the heat that enters at the motor. [-]
    """

    name: str
    recordings: int
    rows: int
    heating: float
    cooling: float
    ambient: float
    motor_heat_share: float


@dataclass(frozen=True, slots=True)
class _Planned:
    """A series with its file name and, for each round trip, begin and friction offset."""

    file: str
    series: SeriesOfMoves
    begins: Array
    offsets: Array


def write_run(
    folder: Path, course: RunCourse, hidden: Callable[[State], Extra] | None = None
) -> tuple[RunSummary, dict[str, Any]]:
    """Write a run's traces and manifest.

    Parameters
    ----------
    folder : Path
        Folder to make.
    course : RunCourse
        How the run went.
    hidden : callable, optional
        Returns what planted effects add at a state.

    Returns
    -------
    RunSummary
        What was made.
    dict
        What is true about it, ready for JSON.
    """
    run, series = course.run, course.series
    offset_seed, *torque_seeds = run.seeds.spawn(1 + len(series))
    planned = _plan(course, generator_of(offset_seed))
    folder.mkdir(parents=True)
    rows = 0
    for one, seed in zip(planned, torque_seeds, strict=True):
        recording = record(
            run.joints[one.series.load],
            run.program,
            course.history,
            one.series,
            logger=run.logger,
            noise=run.noise,
            pair_offsets=one.offsets,
            generator=generator_of(seed),
            hidden=hidden,
            journey=course.journey,
        )
        write_trace(folder / one.file, recording, joint=run.axis)
        rows += len(recording.time)
    manifest = manifest_text(_manifest_row(course, one) for one in planned)
    (folder / MANIFEST).write_text(manifest, encoding="utf-8", newline="\n")
    heating, cooling = _durations(series)
    summary = RunSummary(
        name=run.name,
        recordings=len(series),
        rows=rows,
        heating=heating,
        cooling=cooling,
        ambient=run.ambient.start,
        motor_heat_share=next(iter(run.joint.heat.shares.values())),
    )
    return summary, _truth(course, planned)


def generator_of(seed: np.random.SeedSequence) -> np.random.Generator:
    """Return the generator of random numbers that every random part uses."""
    return np.random.Generator(np.random.PCG64(seed))


def _durations(series: tuple[SeriesOfMoves, ...]) -> tuple[float, float]:
    """Return how long the first heat-up and the first cool-down took [s]."""
    phases = [one.phase for one in series]
    hot = phases.index("heat-up")
    cool = phases.index("cool-down", hot)
    end = next((n for n in range(cool, len(series)) if phases[n] != "cool-down"), len(series))
    return series[cool].start - series[hot].start, series[end - 1].start - series[cool].start


def _plan(course: RunCourse, generator: np.random.Generator) -> tuple[_Planned, ...]:
    """Name the series so that they sort by time, and draw their friction offsets."""
    series, begins = course.series, course.trips.begin
    offsets = course.run.noise.pair_offsets(generator, begins)
    cuts = np.cumsum([len(one.speeds) for one in series])[:-1]
    parts = zip(series, np.split(begins, cuts), np.split(offsets, cuts), strict=True)
    return tuple(
        _Planned(f"{number:03d}_{one.phase}_KRCIpo.csv", one, own, drawn)
        for number, (one, own, drawn) in enumerate(parts, start=1)
    )


def _manifest_row(course: RunCourse, planned: _Planned) -> ManifestRow:
    run, series = course.run, planned.series
    return ManifestRow(
        file=planned.file,
        started_at=moment(run.day, series.start),
        phase=series.phase,
        payload=run.payloads[series.load],
        ambient=float(run.ambient.at(series.start)),
    )


def _truth(course: RunCourse, planned: tuple[_Planned, ...]) -> dict[str, Any]:
    """Return every parameter of a run, and its true temperatures at each round trip's begin."""
    run = course.run
    recordings = []
    for one in planned:
        temperatures = course.history.at(one.begins)
        recordings.append(
            {
                "file": one.file,
                "phase": one.series.phase,
                "start": one.series.start,
                "round_trips": [
                    {
                        "speed": speed,
                        "begin": _stable(one.begins[number]),
                        "friction_offset": _stable(one.offsets[number]),
                        "temperatures": {
                            node: _stable(values[number]) for node, values in temperatures.items()
                        },
                    }
                    for number, speed in enumerate(one.series.speeds)
                ],
            }
        )
    told: dict[str, Any] = {
        "name": run.name,
        "started_at": run.day.isoformat(),
        "joint": asdict(run.joint),
        "program": asdict(run.program),
        "ambient": asdict(run.ambient),
        "logger": asdict(run.logger),
        "noise": asdict(run.noise),
        "recordings": recordings,
    }
    if run.enriched:
        told["payloads"] = [run.payloads[one.series.load] for one in planned]
        told["second_heat_shares"] = dict(second_shares(run.joint.heat.shares))
    return told


def _stable(value: float) -> float:
    """Return a value rounded so far that it does not depend on the processor's last bit."""
    return round(float(value), 6)
