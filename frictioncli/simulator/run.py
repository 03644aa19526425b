"""One run: simulated by its program, written as a trace folder, and what is true about it."""

from dataclasses import asdict, dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictioncli.simulator import defaults
from frictioncli.simulator.history import ThermalHistory
from frictioncli.simulator.joint import Joint
from frictioncli.simulator.noise import Noise
from frictioncli.simulator.program import Program, Series, run_program
from frictioncli.simulator.recording import Logger, record
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal import Ambient
from frictioncli.simulator.trace_writer import ManifestRow, manifest_text, moment, write_trace

MANIFEST = "manifest.csv"
"""File that tells when each recording started."""

FIRST_DAY = datetime(2019, 3, 4, 8, 0, 0)
"""Start of the first run; each further run starts a day later."""


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
        Durations of heat-up and cool-down. [s]
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """Everything that one run is simulated with.

    Attributes
    ----------
    name : str
        Name of its folder.
    day : datetime
        When it begins.
    axis : int
        Number of the joint in the traces' channel names.
    payload : float
        Mass at the flange. [kg]
    joint, program, ambient, logger, noise : Joint, Program, Ambient, Logger, Noise
        The physics and its recording.
    seeds : numpy.random.SeedSequence
        Source of all its random parts.
    """

    name: str
    day: datetime
    axis: int
    payload: float
    joint: Joint
    program: Program
    ambient: Ambient
    logger: Logger
    noise: Noise
    seeds: np.random.SeedSequence


@dataclass(frozen=True, slots=True)
class _Planned:
    """A series with its file name and, for each round trip, begin and friction offset."""

    file: str
    series: Series
    begins: NDArray[np.float64]
    offsets: NDArray[np.float64]


def prepare(settings: SynthesisSettings, number: int, seeds: np.random.SeedSequence) -> Run:
    """Return run ``number``, counted from 0, of a synthesis."""

    def own(values: tuple[float, ...]) -> float:
        return values[number % len(values)]

    return Run(
        name=f"day{number + 1}",
        day=FIRST_DAY + timedelta(days=number),
        axis=settings.joint,
        payload=settings.payload,
        joint=defaults.joint(
            payload=settings.payload, motor_heat_share=own(settings.motor_heat_share)
        ),
        program=replace(defaults.PROGRAM, lowest=settings.lowest, highest=settings.highest),
        ambient=Ambient(start=own(settings.ambient), drift=own(settings.ambient_drift)),
        logger=replace(defaults.LOGGER, sign=settings.sign),
        noise=defaults.NOISE.scaled(settings.noise_scale),
        seeds=seeds,
    )


def write_run(folder: Path, run: Run) -> tuple[RunSummary, dict[str, Any]]:
    """Simulate a run and write its traces and manifest.

    Parameters
    ----------
    folder : Path
        Folder to make.
    run : Run
        The run.

    Returns
    -------
    RunSummary
        What was made.
    dict
        What is true about it, ready for JSON.
    """
    history, series = run_program(run.joint, run.program, run.ambient)
    offset_seed, *torque_seeds = run.seeds.spawn(1 + len(series))
    planned = _plan(run, series, _generator(offset_seed))
    folder.mkdir(parents=True)
    rows = 0
    for one, seed in zip(planned, torque_seeds, strict=True):
        recording = record(
            run.joint,
            run.program,
            history,
            one.series,
            logger=run.logger,
            noise=run.noise,
            pair_offsets=one.offsets,
            generator=_generator(seed),
        )
        write_trace(folder / one.file, recording, joint=run.axis)
        rows += len(recording.time)
    manifest = manifest_text(_manifest_row(run, one) for one in planned)
    (folder / MANIFEST).write_text(manifest, encoding="utf-8", newline="\n")
    starts = {
        phase: [one.start for one in series if one.phase == phase]
        for phase in ("heat-up", "cool-down")
    }
    summary = RunSummary(
        name=run.name,
        recordings=len(series),
        rows=rows,
        heating=starts["cool-down"][0] - starts["heat-up"][0],
        cooling=starts["cool-down"][-1] - starts["cool-down"][0],
        ambient=run.ambient.start,
        motor_heat_share=run.joint.heat.shares["motor"],
    )
    return summary, _truth(run, history, planned)


def _plan(
    run: Run, series: tuple[Series, ...], generator: np.random.Generator
) -> tuple[_Planned, ...]:
    """Name the series so that they sort by time, and draw their friction offsets."""
    begins = [one.start + run.program.trip_begins(run.joint.servo, one.speeds) for one in series]
    offsets = run.noise.pair_offsets(generator, np.concatenate(begins))
    ends = np.cumsum([len(own) for own in begins])
    return tuple(
        _Planned(f"{number:03d}_{one.phase}_KRCIpo.csv", one, own, drawn)
        for number, (one, own, drawn) in enumerate(
            zip(series, begins, np.split(offsets, ends[:-1]), strict=True), start=1
        )
    )


def _manifest_row(run: Run, planned: _Planned) -> ManifestRow:
    return ManifestRow(
        file=planned.file,
        started_at=moment(run.day, planned.series.start),
        phase=planned.series.phase,
        payload=run.payload,
        ambient=float(run.ambient.at(planned.series.start)),
    )


def _truth(run: Run, history: ThermalHistory, planned: tuple[_Planned, ...]) -> dict[str, Any]:
    """Return every parameter of a run, and its true temperatures at each round trip's begin."""
    recordings = []
    for one in planned:
        temperatures = history.at(one.begins)
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
    return {
        "name": run.name,
        "started_at": run.day.isoformat(),
        "joint": asdict(run.joint),
        "program": asdict(run.program),
        "ambient": asdict(run.ambient),
        "logger": asdict(run.logger),
        "noise": asdict(run.noise),
        "recordings": recordings,
    }


def _generator(seed: np.random.SeedSequence) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


def _stable(value: float) -> float:
    """Return a value rounded so far that it does not depend on the processor's last bit."""
    return round(float(value), 6)
