"""Simulation of any sequence of motions, run after run on one joint."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from frictioncli.simulator.cells import Cells, cells_of, round_trips_of
from frictioncli.simulator.paper_protocol import MeasuringSeries, measure
from frictioncli.simulator.planted.catalogue import requested_effects
from frictioncli.simulator.planted.operating_history import EarlierRuns, operating_history
from frictioncli.simulator.planted.planting import PlantedEffects, plant
from frictioncli.simulator.run import RunSetup, SimulatedRun, joint_of, run_setup
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import MOTOR, History
from tests.simulation.fast_history import FastHistory
from tests.simulation.torque_table import table_of

_CHECK_INTERVAL = 30.0
"""Interval at which heating moves check the motor temperature [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredMoves:
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
class UnrecordedMoves:
    """Unrecorded moves there and back for a time [s], or until the motor has a temperature [°C]."""

    speed: float
    low: float
    high: float
    seconds: float
    until: float | None = None


@dataclass(frozen=True, slots=True)
class Standstill:
    """Standing for a time [s]."""

    seconds: float


Motion = MeasuredMoves | UnrecordedMoves | Standstill
Configuration = tuple[float, float, float]
"""Payload above that of the settings [kg], and the angles [deg]: what a measured series needs."""


def simulate_programmes(
    settings: SynthesisSettings, programmes: Sequence[Sequence[Motion]], sizing_runs: int
) -> list[pd.DataFrame]:
    """Simulate runs of given motions, one per day, and return the table of torques of each.

    Planted effects are sized in the first runs and keep that size, so that further runs show what
    another experiment finds on the same joint.

    Parameters
    ----------
    settings : SynthesisSettings
        Joint, surroundings, noise and planted effects; the protocol and the number of runs are
        not used.
    programmes : sequence of sequence of Motion
        Motions of each run.
    sizing_runs : int
        Number of runs, from the first, in which planted effects are sized.

    Raises
    ------
    OptionError
        If an effect is unknown, or cannot be planted in these runs.
    """
    seeds = np.random.SeedSequence(settings.seed).spawn(len(programmes))
    plain = replace(settings, protocol="paper", runs=len(programmes))
    simulated = [
        _run(plain, run_setup(plain, number, seed), motions)
        for number, (seed, motions) in enumerate(zip(seeds, programmes, strict=True))
    ]
    total = sum(history.time for _, history, _, _ in simulated[:sizing_runs])
    operated = travelled = 0.0
    runs, cells = [], []
    for setup, history, series, configurations in simulated:
        earlier = EarlierRuns(
            operated=operated,
            travelled=travelled,
            total=total,
        )
        operation = operating_history(
            history, setup.program.angles, first=series[0].start, earlier=earlier
        )
        trips = round_trips_of(setup.program, setup.joint.servo, series)
        run = SimulatedRun(
            setup=setup, history=history, series=series, trips=trips, operation=operation
        )
        runs.append(run)
        cells.append(_cells(run, configurations))
        operated += history.time
        travelled += float(operation.travel[-1])
    planted = PlantedEffects()
    effects = requested_effects(settings.effects)
    nuisances = runs[0].setup.nuisances
    if effects or nuisances:
        states = [part.state for parts in cells[:sizing_runs] for part in parts]
        planted = plant(effects, settings.seed, states, settings.sign, nuisances)
    return [table_of(run, parts, planted) for run, parts in zip(runs, cells, strict=True)]


def _run(
    settings: SynthesisSettings, setup: RunSetup, motions: Sequence[Motion]
) -> tuple[RunSetup, History, tuple[MeasuringSeries, ...], tuple[Configuration, ...]]:
    """Simulate one run; the payloads of the returned setup are those of its configurations."""
    configurations = tuple(
        dict.fromkeys(
            _configuration(motion) for motion in motions if isinstance(motion, MeasuredMoves)
        )
    )
    share = settings.motor_heat_share[setup.number % len(settings.motor_heat_share)]
    masses = tuple(settings.payload + more for more, _, _ in configurations)
    joints = tuple(joint_of(settings.joint_kind, mass, share, setup.nuisances) for mass in masses)
    history = FastHistory(joints[0], setup.ambient)
    series = []
    for motion in motions:
        if isinstance(motion, Standstill):
            history.continue_for(motion.seconds)
        elif isinstance(motion, UnrecordedMoves):
            _move(history, setup, motion)
        else:
            number = configurations.index(_configuration(motion))
            history.use(joints[number], {})
            program = replace(setup.program, angles=(motion.low, motion.high))
            one = measure(joints[number], program, history, "sweep", motion.speeds)
            series.append(replace(one, payload_index=number, angles=program.angles))
    used = replace(setup, payloads=masses, joints=joints)
    return used, history, tuple(series), configurations


def _configuration(motion: MeasuredMoves) -> Configuration:
    return motion.more, motion.low, motion.high


def _move(history: History, setup: RunSetup, motion: UnrecordedMoves) -> None:
    trips = replace(setup.program, angles=(motion.low, motion.high)).trips(motion.speed)
    sensor = setup.joint.network.names.index(MOTOR)
    remaining = motion.seconds
    while remaining > 0 and (motion.until is None or history.state[sensor] < motion.until):
        history.continue_for(min(_CHECK_INTERVAL, remaining), trips)
        remaining -= _CHECK_INTERVAL


def _cells(run: SimulatedRun, configurations: Sequence[Configuration]) -> list[Cells]:
    setup = run.setup
    return [
        cells_of(
            joint,
            replace(setup.program, angles=(low, high)),
            run.history,
            replace(run.operation, angles=(low, high)),
            run.trips,
            payload_index=number,
            interval=setup.logger.interval,
            nuisances=setup.nuisances,
        )
        for number, (joint, (_, low, high)) in enumerate(
            zip(setup.joints, configurations, strict=True)
        )
    ]
