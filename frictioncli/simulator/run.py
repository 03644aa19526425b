"""One run: what it is simulated with, and its course."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from frictioncli.simulator import default_joint
from frictioncli.simulator.cells import Trips, cells_of, trips_of
from frictioncli.simulator.enriched_protocol import PAYLOADS, SPEEDS, run_enriched
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.noise import SimulatedNoise
from frictioncli.simulator.noise_kinds import noise_of_kind
from frictioncli.simulator.paper_protocol import PaperProgram, SeriesOfMoves, run_program
from frictioncli.simulator.plain_joint import plain_joint
from frictioncli.simulator.planted.journey import Before, Journey, look_back
from frictioncli.simulator.planted.state import State
from frictioncli.simulator.recording import Logger
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import History, ThermalHistory
from frictioncli.simulator.thermal_network import Ambient

FIRST_DAY = datetime(2019, 3, 4, 8, 0, 0)
"""Start of the first run; each further run starts a day later."""

DAY = 24 * 3600.0
"""Time between the starts of two runs [s]."""

_ORDER_STREAM = 1_000_000
"""Keeps the random numbers of an enriched protocol apart from those of the noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedRun:
    """Everything that one run is simulated with.

    Attributes
    ----------
    name : str
        Name of its folder.
    number : int
        Its number, from 0.
    day : datetime
        When it begins.
    axis : int
        Number of the joint in the traces' channel names.
    payloads : tuple of float
        Masses at the flange that its series have. [kg]
    joints : tuple of SimulatedJoint
        The joint with each of them.
    program, ambient, logger, noise : PaperProgram, Ambient, Logger, SimulatedNoise
        Motion, surroundings and recording.
    seeds : numpy.random.SeedSequence
        Source of all its random parts.
    enriched : bool
        Whether the protocol is the enriched one.
    """

    name: str
    number: int
    day: datetime
    axis: int
    payloads: tuple[float, ...]
    joints: tuple[SimulatedJoint, ...]
    program: PaperProgram
    ambient: Ambient
    logger: Logger
    noise: SimulatedNoise
    seeds: np.random.SeedSequence
    enriched: bool

    @property
    def joint(self) -> SimulatedJoint:
        """The joint with the first payload."""
        return self.joints[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunCourse:
    """How a run went: its temperatures and series, and what lies behind each moment."""

    run: SimulatedRun
    history: History
    series: tuple[SeriesOfMoves, ...]
    trips: Trips
    journey: Journey

    def states(self) -> list[State]:
        """Return the states in the run's cells, for each payload."""
        return [
            cells_of(
                joint,
                self.run.program,
                self.history,
                self.journey,
                self.trips,
                load=load,
                interval=self.run.logger.interval,
            ).state
            for load, joint in enumerate(self.run.joints)
        ]


def prepare(
    settings: SynthesisSettings, number: int, seeds: np.random.SeedSequence
) -> SimulatedRun:
    """Return run ``number``, counted from 0, of a synthesis."""

    def own(values: tuple[float, ...]) -> float:
        return values[number % len(values)]

    enriched = settings.protocol == "enriched"
    payloads = tuple(settings.payload + more for more in (PAYLOADS if enriched else (0.0,)))
    program = replace(default_joint.PROGRAM, lowest=settings.lowest, highest=settings.highest)
    return SimulatedRun(
        name=f"day{number + 1}",
        number=number,
        day=FIRST_DAY + timedelta(days=number),
        axis=settings.joint,
        payloads=payloads,
        joints=tuple(
            joint_of(settings.joint_kind, one, own(settings.motor_heat_share)) for one in payloads
        ),
        program=replace(program, sweep_speeds=(), cycle_speeds=SPEEDS) if enriched else program,
        ambient=Ambient(start=own(settings.ambient), drift=own(settings.ambient_drift)),
        logger=replace(
            default_joint.LOGGER,
            sign=settings.sign,
            interval=default_joint.LOGGER.interval * settings.thin,
        ),
        noise=noise_of_kind(settings.noise_kind, default_joint.NOISE).scaled(settings.noise_scale),
        seeds=seeds,
        enriched=enriched,
    )


def simulate(runs: list[SimulatedRun], kind: type[History] = ThermalHistory) -> list[RunCourse]:
    """Let runs take their course, one after the other on the same joint.

    Parameters
    ----------
    runs : list of SimulatedRun
        The runs.
    kind : type of History
        How temperatures are integrated.
    """
    gone = [_run(run, kind) for run in runs]
    total = sum(history.time for history, _ in gone)
    operated = travelled = 0.0
    courses = []
    for run, (history, series) in zip(runs, gone, strict=True):
        before = Before(
            run=run.number,
            clock=run.number * DAY,
            operated=operated,
            travelled=travelled,
            total=total,
        )
        journey = look_back(history, run.program.angles, first=series[0].start, before=before)
        courses.append(
            RunCourse(
                run=run,
                history=history,
                series=series,
                trips=trips_of(run.program, run.joint.servo, series),
                journey=journey,
            )
        )
        operated += history.time
        travelled += float(journey.travel[-1])
    return courses


def _run(run: SimulatedRun, kind: type[History]) -> tuple[History, tuple[SeriesOfMoves, ...]]:
    if not run.enriched:
        return run_program(run.joint, run.program, run.ambient, kind)
    own = np.random.SeedSequence(run.seeds.entropy, spawn_key=(*run.seeds.spawn_key, _ORDER_STREAM))
    generator = np.random.Generator(np.random.PCG64(own))
    return run_enriched(run.joints, run.program, run.ambient, generator, kind)


def joint_of(kind: str, payload: float, motor_heat_share: float) -> SimulatedJoint:
    """Return the joint of a kind with a payload [kg] and a share of heat at the motor."""
    joint = default_joint.joint(payload=payload, motor_heat_share=motor_heat_share)
    if kind == "zones":
        return joint
    return plain_joint(arm=joint.arm, servo=joint.servo, motor_heat_share=motor_heat_share)
