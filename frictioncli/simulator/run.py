"""One run: what it is simulated with, and its course."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from frictioncli.simulator import defaults
from frictioncli.simulator.cells import Trips, cells_of, trips_of
from frictioncli.simulator.enriched import PAYLOADS, SPEEDS, run_enriched
from frictioncli.simulator.history import History, ThermalHistory
from frictioncli.simulator.joint import Joint
from frictioncli.simulator.noise import Noise
from frictioncli.simulator.noise_kinds import noise_of_kind
from frictioncli.simulator.plain import plain_joint
from frictioncli.simulator.planted.journey import Before, Journey, look_back
from frictioncli.simulator.planted.state import State
from frictioncli.simulator.program import Program, Series, run_program
from frictioncli.simulator.recording import Logger
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal import Ambient

FIRST_DAY = datetime(2019, 3, 4, 8, 0, 0)
"""Start of the first run; each further run starts a day later."""

DAY = 24 * 3600.0
"""Time between the starts of two runs [s]."""

_ORDER_STREAM = 1_000_000
"""Keeps the random numbers of an enriched protocol apart from those of the noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
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
    joints : tuple of Joint
        The joint with each of them.
    program, ambient, logger, noise : Program, Ambient, Logger, Noise
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
    joints: tuple[Joint, ...]
    program: Program
    ambient: Ambient
    logger: Logger
    noise: Noise
    seeds: np.random.SeedSequence
    enriched: bool

    @property
    def joint(self) -> Joint:
        """The joint with the first payload."""
        return self.joints[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """How a run went: its temperatures and series, and what lies behind each moment."""

    run: Run
    history: History
    series: tuple[Series, ...]
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


def prepare(settings: SynthesisSettings, number: int, seeds: np.random.SeedSequence) -> Run:
    """Return run ``number``, counted from 0, of a synthesis."""

    def own(values: tuple[float, ...]) -> float:
        return values[number % len(values)]

    enriched = settings.protocol == "enriched"
    payloads = tuple(settings.payload + more for more in (PAYLOADS if enriched else (0.0,)))
    program = replace(defaults.PROGRAM, lowest=settings.lowest, highest=settings.highest)
    return Run(
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
            defaults.LOGGER,
            sign=settings.sign,
            interval=defaults.LOGGER.interval * settings.thin,
        ),
        noise=noise_of_kind(settings.noise_kind, defaults.NOISE).scaled(settings.noise_scale),
        seeds=seeds,
        enriched=enriched,
    )


def simulate(runs: list[Run], kind: type[History] = ThermalHistory) -> list[Course]:
    """Let runs take their course, one after the other on the same joint.

    Parameters
    ----------
    runs : list of Run
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
            Course(
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


def _run(run: Run, kind: type[History]) -> tuple[History, tuple[Series, ...]]:
    if not run.enriched:
        return run_program(run.joint, run.program, run.ambient, kind)
    own = np.random.SeedSequence(run.seeds.entropy, spawn_key=(*run.seeds.spawn_key, _ORDER_STREAM))
    generator = np.random.Generator(np.random.PCG64(own))
    return run_enriched(run.joints, run.program, run.ambient, generator, kind)


def joint_of(kind: str, payload: float, motor_heat_share: float) -> Joint:
    """Return the joint of a kind with a payload [kg] and a share of heat at the motor."""
    joint = defaults.joint(payload=payload, motor_heat_share=motor_heat_share)
    if kind == "zones":
        return joint
    return plain_joint(arm=joint.arm, servo=joint.servo, motor_heat_share=motor_heat_share)
