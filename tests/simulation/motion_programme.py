"""Any sequence of motions, run after run on one joint: what a planned experiment would find."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from frictioncli.simulator.cells import Cells, cells_of, trips_of
from frictioncli.simulator.paper_protocol import SeriesOfMoves, measure
from frictioncli.simulator.planted.catalogue import asked
from frictioncli.simulator.planted.journey import Before, look_back
from frictioncli.simulator.planted.planting import Planted, plant
from frictioncli.simulator.run import DAY, RunCourse, SimulatedRun, joint_of, prepare
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import MOTOR, History
from tests.simulation.fast_history import FastHistory
from tests.simulation.torque_table import table_of

_LOOK = 30.0
"""Moves that heat look at the motor's temperature so often [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """Recorded moves there and back, one round trip per speed.

    Attributes
    ----------
    speeds : tuple of float
        In this order. [deg/s]
    low, high : float
        Angles between which it turns. [deg]
    more : float
        Payload above that of the settings. [kg]
    """

    speeds: tuple[float, ...]
    low: float
    high: float
    more: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Moved:
    """Unrecorded moves there and back for a time [s], or until the motor has a temperature [°C]."""

    speed: float
    low: float
    high: float
    seconds: float
    until: float | None = None


@dataclass(frozen=True, slots=True)
class Stood:
    """Standing for a time [s]."""

    seconds: float


Act = Measured | Moved | Stood
Setup = tuple[float, float, float]
"""Payload above that of the settings [kg], and the angles [deg]: what a measured series needs."""


def simulate_programmes(
    settings: SynthesisSettings, programmes: Sequence[Sequence[Act]], hidden_in: int
) -> list[pd.DataFrame]:
    """Simulate runs of given motions, one per day, and return the table of torques of each.

    Effects are hidden as in the first runs: they get their sizes there, and keep them. So the same
    joint can be asked what another experiment would have shown of it.

    Parameters
    ----------
    settings : SynthesisSettings
        The joint, its surroundings and noise, and what is hidden; its protocol and the number of
        its runs have no meaning here.
    programmes : sequence of sequence of Act
        Motions of each run.
    hidden_in : int
        Number of runs, from the first, that the sizes of hidden effects hold in.

    Raises
    ------
    OptionError
        If an effect is unknown, or cannot be hidden in these runs.
    """
    seeds = np.random.SeedSequence(settings.seed).spawn(len(programmes))
    plain = replace(settings, protocol="paper", runs=len(programmes))
    gone = [
        _run(plain, prepare(plain, number, seed), acts)
        for number, (seed, acts) in enumerate(zip(seeds, programmes, strict=True))
    ]
    total = sum(history.time for _, history, _, _ in gone[:hidden_in])
    operated = travelled = 0.0
    courses, cells = [], []
    for run, history, series, setups in gone:
        before = Before(
            run=run.number,
            clock=run.number * DAY,
            operated=operated,
            travelled=travelled,
            total=total,
        )
        journey = look_back(history, run.program.angles, first=series[0].start, before=before)
        trips = trips_of(run.program, run.joint.servo, series)
        course = RunCourse(run=run, history=history, series=series, trips=trips, journey=journey)
        courses.append(course)
        cells.append(_cells(course, setups))
        operated += history.time
        travelled += float(journey.travel[-1])
    planted = Planted()
    effects = asked(settings.effects)
    if effects:
        states = [part.state for parts in cells[:hidden_in] for part in parts]
        planted = plant(effects, settings.seed, states, settings.sign)
    return [table_of(course, parts, planted) for course, parts in zip(courses, cells, strict=True)]


def _run(
    settings: SynthesisSettings, run: SimulatedRun, acts: Sequence[Act]
) -> tuple[SimulatedRun, History, tuple[SeriesOfMoves, ...], tuple[Setup, ...]]:
    """Let one run take its course; its payloads are then its setups'."""
    setups = tuple(dict.fromkeys(_setup(act) for act in acts if isinstance(act, Measured)))
    share = settings.motor_heat_share[run.number % len(settings.motor_heat_share)]
    masses = tuple(settings.payload + more for more, _, _ in setups)
    joints = tuple(joint_of(settings.joint_kind, mass, share) for mass in masses)
    history = FastHistory(joints[0], run.ambient)
    series = []
    for act in acts:
        if isinstance(act, Stood):
            history.spend(act.seconds)
        elif isinstance(act, Moved):
            _move(history, run, act)
        else:
            number = setups.index(_setup(act))
            history.use(joints[number], {})
            program = replace(run.program, angles=(act.low, act.high))
            one = measure(joints[number], program, history, "sweep", act.speeds)
            series.append(replace(one, load=number, angles=program.angles))
    used = replace(run, payloads=masses, joints=joints)
    return used, history, tuple(series), setups


def _setup(act: Measured) -> Setup:
    return act.more, act.low, act.high


def _move(history: History, run: SimulatedRun, act: Moved) -> None:
    trips = replace(run.program, angles=(act.low, act.high)).trips(act.speed)
    sensor = run.joint.network.names.index(MOTOR)
    left = act.seconds
    while left > 0 and (act.until is None or history.state[sensor] < act.until):
        history.spend(min(_LOOK, left), trips)
        left -= _LOOK


def _cells(course: RunCourse, setups: Sequence[Setup]) -> list[Cells]:
    run = course.run
    return [
        cells_of(
            joint,
            replace(run.program, angles=(low, high)),
            course.history,
            replace(course.journey, angles=(low, high)),
            course.trips,
            load=number,
            interval=run.logger.interval,
        )
        for number, (joint, (_, low, high)) in enumerate(zip(run.joints, setups, strict=True))
    ]
