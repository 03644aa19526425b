"""Trace folder of a simulated run, and the truth about it."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.enriched_protocol import second_shares
from frictioncli.simulator.paper_protocol import MeasuringSeries
from frictioncli.simulator.planted.planting import PlantedEffects
from frictioncli.simulator.recording import record
from frictioncli.simulator.run import SimulatedRun
from frictioncli.simulator.trace_writer import ManifestRow, manifest_text, moment, write_trace

MANIFEST = "manifest.csv"
"""File with the start of each recording."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """Summary of the files of one run.

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
class _Recording:
    """A series with its file name and, for each round trip, start [s] and friction offset [N·m]."""

    file: str
    series: MeasuringSeries
    begins: Array
    offsets: Array


def write_run(
    folder: Path, run: SimulatedRun, planted: PlantedEffects | None = None
) -> tuple[RunSummary, dict[str, Any]]:
    """Write a run's traces and manifest.

    Parameters
    ----------
    folder : Path
        Folder to make.
    run : SimulatedRun
        The run.
    planted : PlantedEffects, optional
        Effects that add torque.

    Returns
    -------
    RunSummary
        Summary of the files.
    dict
        Truth about the run, ready for JSON.
    """
    setup, series = run.setup, run.series
    offset_seed, *torque_seeds = setup.seeds.spawn(1 + len(series))
    recordings = _recordings(run, generator_of(offset_seed))
    folder.mkdir(parents=True)
    rows = 0
    motor_decimals = 0 if setup.logger.motor_step % 1.0 == 0.0 else 2
    for number, (one, seed) in enumerate(zip(recordings, torque_seeds, strict=True)):
        logged = record(
            setup.joints[one.series.payload_index],
            setup.program,
            run.history,
            one.series,
            logger=setup.logger,
            noise=setup.noise,
            pair_offsets=one.offsets,
            generator=generator_of(seed),
            planted=planted,
            operation=run.operation,
            nuisances=setup.nuisances,
            number=(setup.number, number),
        )
        write_trace(folder / one.file, logged, joint=setup.axis, motor_decimals=motor_decimals)
        rows += len(logged.time)
    manifest = manifest_text(_manifest_row(run, one) for one in recordings)
    (folder / MANIFEST).write_text(manifest, encoding="utf-8", newline="\n")
    heating, cooling = _durations(series)
    summary = RunSummary(
        name=setup.name,
        recordings=len(series),
        rows=rows,
        heating=heating,
        cooling=cooling,
        ambient=setup.ambient.start,
        motor_heat_share=next(iter(setup.joint.heat.shares.values())),
    )
    return summary, _truth(run, recordings)


def generator_of(seed: np.random.SeedSequence) -> np.random.Generator:
    """Return the random number generator of a seed."""
    return np.random.Generator(np.random.PCG64(seed))


def _durations(series: tuple[MeasuringSeries, ...]) -> tuple[float, float]:
    """Return the durations of the first heat-up and the first cool-down [s]."""
    phases = [one.phase for one in series]
    hot = phases.index("heat-up")
    cool = phases.index("cool-down", hot)
    end = next((n for n in range(cool, len(series)) if phases[n] != "cool-down"), len(series))
    return series[cool].start - series[hot].start, series[end - 1].start - series[cool].start


def _recordings(run: SimulatedRun, generator: np.random.Generator) -> tuple[_Recording, ...]:
    """Return the series with file names that sort by time, and with drawn friction offsets."""
    series, begins = run.series, run.trips.begin
    offsets = run.setup.noise.pair_offsets(generator, begins)
    cuts = np.cumsum([len(one.speeds) for one in series])[:-1]
    parts = zip(series, np.split(begins, cuts), np.split(offsets, cuts), strict=True)
    return tuple(
        _Recording(f"{number:03d}_{one.phase}_KRCIpo.csv", one, start, offset)
        for number, (one, start, offset) in enumerate(parts, start=1)
    )


def _manifest_row(run: SimulatedRun, recording: _Recording) -> ManifestRow:
    setup, series = run.setup, recording.series
    return ManifestRow(
        file=recording.file,
        started_at=moment(setup.day, series.start),
        phase=series.phase,
        payload=setup.payloads[series.payload_index],
        ambient=float(setup.ambient.at(series.start)),
    )


def _truth(run: SimulatedRun, recordings: tuple[_Recording, ...]) -> dict[str, Any]:
    """Return all parameters of a run, and its true temperatures at the start of each round trip."""
    setup = run.setup
    documents = []
    for one in recordings:
        temperatures = run.history.at(one.begins)
        documents.append(
            {
                "file": one.file,
                "phase": one.series.phase,
                "start": one.series.start,
                "round_trips": [
                    {
                        "speed": speed,
                        "begin": _rounded(one.begins[number]),
                        "friction_offset": _rounded(one.offsets[number]),
                        "temperatures": {
                            node: _rounded(values[number]) for node, values in temperatures.items()
                        },
                    }
                    for number, speed in enumerate(one.series.speeds)
                ],
            }
        )
    truth: dict[str, Any] = {
        "name": setup.name,
        "started_at": setup.day.isoformat(),
        "joint": asdict(setup.joint),
        "program": asdict(setup.program),
        "ambient": asdict(setup.ambient),
        "logger": asdict(setup.logger),
        "noise": asdict(setup.noise),
        "recordings": documents,
    }
    if setup.enriched:
        truth["payloads"] = [setup.payloads[one.series.payload_index] for one in recordings]
        truth["second_heat_shares"] = dict(second_shares(setup.joint.heat.shares))
    return truth


def _rounded(value: float) -> float:
    """Return a value rounded to 1e-6, so that it does not depend on the processor's last bit."""
    return round(float(value), 6)
