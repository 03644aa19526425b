"""Simulated table of torques, computed per angle bin without traces, for many runs."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.simulator.cells import Cells, cells_of
from frictioncli.simulator.noise import OUTLIER, HeteroscedasticNoise, SimulatedNoise
from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.nuisances.motion_and_torque import clock_factor, other_joint_torque
from frictioncli.simulator.planted.catalogue import requested_effects
from frictioncli.simulator.planted.planting import PlantedEffects, plant
from frictioncli.simulator.recording import registered
from frictioncli.simulator.run import SimulatedRun, run_setup, simulate
from frictioncli.simulator.run_files import generator_of
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import HOUSING, MOTOR
from tests.simulation.fast_history import FastHistory

REBUILT = 0.05
"""Standard deviation of a motor temperature that is rebuilt from its whole degrees [K]."""

REBUILT_CORRELATION_TIME = 600.0
"""Correlation time of that error [s]."""


@dataclass(frozen=True, slots=True)
class World:
    """A simulated experiment.

    Attributes
    ----------
    torques : DataFrame
        A row per round trip and angle bin, with the columns of the table ``torques``.
    planted : PlantedEffects
        Planted effects, and weak disturbances among the nuisances.
    nuisances : Nuisances
        What joint and log do besides, with true sizes.
    """

    torques: pd.DataFrame
    planted: PlantedEffects
    nuisances: Nuisances


def simulate_torques(settings: SynthesisSettings, *, rebuilt: bool = True) -> pd.DataFrame:
    """Return the table of torques of a synthesis; see :func:`simulate_world`."""
    return simulate_world(settings, rebuilt=rebuilt).torques


def simulate_world(settings: SynthesisSettings, *, rebuilt: bool = True) -> World:
    """Simulate runs bin by bin.

    Friction, load and planted effects are those of the traces; noise is drawn per bin with the
    variance that its samples' mean has. The random numbers differ from those of the traces.

    Parameters
    ----------
    settings : SynthesisSettings
        What to simulate; ``blind`` has no meaning here.
    rebuilt : bool
        Whether the motor temperature is as rebuilt from its whole degrees; else it is the reading.

    Raises
    ------
    OptionError
        If an effect is unknown or cannot be planted.
    """
    effects = requested_effects(settings.effects)
    seeds = np.random.SeedSequence(settings.seed).spawn(settings.runs)
    setups = [run_setup(settings, number, seed) for number, seed in enumerate(seeds)]
    runs = simulate(setups, FastHistory)
    cells = [run_cells(run) for run in runs]
    nuisances = setups[0].nuisances
    planted = PlantedEffects()
    if effects or nuisances:
        states = [part.state for parts in cells for part in parts]
        planted = plant(effects, settings.seed, states, settings.sign, nuisances)
    tables = [
        table_of(run, parts, planted, rebuilt) for run, parts in zip(runs, cells, strict=True)
    ]
    together = pd.concat(tables, ignore_index=True)
    for name, values in (
        ("run", [run.setup.name for run in runs]),
        ("phase", ["cool-down", "heat-up", "sweep"]),
    ):
        together[name] = pd.Categorical(together[name], categories=values)
    return World(together, planted, nuisances)


def run_cells(run: SimulatedRun) -> list[Cells]:
    """Return the cells of one run, payload by payload."""
    setup = run.setup
    return [
        cells_of(
            joint,
            setup.program,
            run.history,
            run.operation,
            run.trips,
            payload_index=index,
            interval=setup.logger.interval,
            nuisances=setup.nuisances,
        )
        for index, joint in enumerate(setup.joints)
    ]


def table_of(
    run: SimulatedRun, parts: list[Cells], planted: PlantedEffects, rebuilt: bool = True
) -> pd.DataFrame:
    """Return the torques of one run from its cells."""
    setup, trips = run.setup, run.trips
    sign = setup.logger.sign
    offset_seed, noise_seed, register_seed = (generator_of(seed) for seed in setup.seeds.spawn(3))
    offsets = setup.noise.pair_offsets(offset_seed, trips.begin)
    trip = np.concatenate([part.trip for part in parts])
    order = np.lexsort((np.concatenate([part.position for part in parts]), trip))
    torque = np.concatenate([_torque(run, part, planted) for part in parts], axis=1)[:, order]
    trip = trip[order]
    count = np.concatenate([part.count for part in parts])[order]
    way = sign * np.array([1.0, -1.0])[:, None]
    torque = torque + way * offsets[trip]
    torque = torque + _noise(
        setup.noise, noise_seed, torque, trips.speed[trip], trip, count, setup.logger.interval
    )
    middle = trips.begin + _middles(run)
    motor, reading, housing = _temperatures(run, middle, register_seed, rebuilt)
    phases = np.array([one.phase for one in run.series])[trips.series]
    return pd.DataFrame(
        {
            "run": setup.name,
            "joint": np.int16(setup.axis),
            "pair": trip,
            "speed": trips.speed[trip] * clock_factor(setup.nuisances),
            "time": (middle - run.series[0].start)[trip],
            "phase": phases[trip],
            "motor_temperature": motor[trip],
            "housing_temperature": housing[trip],
            "position": np.concatenate([part.position for part in parts])[order],
            "torque_forward": torque[0],
            "torque_reverse": torque[1],
            "n_forward": count,
            "n_reverse": count,
            "motor_temperature_reading": reading[trip],
            "load": np.nan,
            "payload": np.array(setup.payloads)[trips.payload_index][trip],
            "pose": None,
            "friction_torque": sign * (torque[0] - torque[1]) / 2.0,
            "load_torque": (torque[0] + torque[1]) / 2.0,
        }
    )


def _torque(run: SimulatedRun, part: Cells, planted: PlantedEffects) -> Array:
    """Return the mean torque per direction and cell, without noise [N·m].

    A bin that was passed in part has its mean off its centre; as from traces, the mean is carried
    there along the slope.
    """
    sign, nuisances = run.setup.logger.sign, run.setup.nuisances
    torque = np.zeros(part.logged.shape)
    for weight, state in part.earlier:
        added = planted.torque(state)
        friction = state.friction + added.friction
        load = state.load + added.load + state.inertial
        torque = torque + weight * (load + sign * state.direction * friction)
    if nuisances:
        torque = torque + _disturbance(run, part) + nuisances.size("torque_offset")
    from_mean = part.logged - np.mean(part.logged, axis=0)
    slope = np.sum(from_mean * torque, axis=0) / np.sum(np.square(from_mean), axis=0)
    away = part.position - np.mean(part.logged, axis=0)
    return np.asarray(np.mean(torque, axis=0) + slope * away)


def _disturbance(run: SimulatedRun, part: Cells) -> Array:
    """Return the torque of another joint at the beginning of recordings [N·m]."""
    nuisances, series = run.setup.nuisances, run.trips.series[part.trip]
    found = np.zeros(part.logged.shape)
    if nuisances.size("other_joint") == 0.0:
        return found
    for number in np.unique(series):
        at = series == number
        since = part.state.time[..., at] - run.series[number].start
        found[..., at] = other_joint_torque(nuisances, run.setup.number, int(number), since)
    return found


def _middles(run: SimulatedRun) -> Array:
    """Return the time from each round trip's begin to the middle of its pair [s]."""
    setup = run.setup
    durations = [
        setup.program.for_series(one).trip_durations(setup.joint.servo, one.speeds)
        for one in run.series
    ]
    return np.asarray((np.concatenate(durations) - setup.program.dwell) / 2.0 + 0.1)


def _temperatures(
    run: SimulatedRun, time: Array, generator: np.random.Generator, rebuilt: bool
) -> tuple[Array, Array, Array]:
    """Return motor temperature, its reading and housing temperature per round trip [°C]."""
    logger, noise = run.setup.logger, run.setup.noise
    true = run.history.at(time)
    reading = registered(true[MOTOR], logger.motor_step)
    housing = registered(true[HOUSING], logger.housing_step)
    if not rebuilt:
        return reading, reading, housing
    quiet = noise.white == noise.slow == noise.per_pair == 0.0
    error = SimulatedNoise(
        white=0.0,
        correlated=0.0,
        correlation_time=1.0,
        slow=0.0 if quiet else REBUILT,
        slow_time=REBUILT_CORRELATION_TIME,
        per_pair=0.0,
    )
    return true[MOTOR] + error.pair_offsets(generator, time), reading, housing


def _noise(
    noise: SimulatedNoise,
    generator: np.random.Generator,
    torque: Array,
    speed: Array,
    trip: Numbers,
    count: Numbers,
    interval: float,
) -> Array:
    """Return the noise of the means per direction and cell, cells in order of trip and angle."""
    shape = torque.shape
    spread, loud = np.ones(shape), np.zeros(shape)
    if isinstance(noise, HeteroscedasticNoise):
        spread = noise.spread(torque, speed)
        loud = generator.binomial(np.broadcast_to(count, shape), noise.outliers).astype(float)
    white = noise.white * spread * np.sqrt(count + loud * (OUTLIER**2 - 1.0)) / count
    total = white * generator.standard_normal(shape)
    if noise.correlated == 0.0:
        return total
    # The mean over a bin of noise with memory, and its correlation from bin to bin of a move.
    bins = count * interval / noise.correlation_time
    memory = np.exp(-bins)
    kept = 2.0 / bins * (1.0 - (1.0 - memory) / bins)
    first = np.concatenate([[True], trip[1:] != trip[:-1]])
    return total + noise.correlated * np.sqrt(kept) * _correlated(generator, memory, first)


def _correlated(generator: np.random.Generator, memory: Array, first: Flags) -> Array:
    """Return numbers of variance 1 for both directions, correlated by ``memory`` along moves."""
    drive = generator.standard_normal((2, len(memory)))
    place = np.arange(len(memory)) - np.maximum.accumulate(
        np.where(first, np.arange(len(memory)), 0)
    )
    found = drive.copy()
    for step in range(1, int(place.max(initial=0)) + 1):
        at = np.flatnonzero(place == step)
        found[:, at] = memory[at] * found[:, at - 1] + np.sqrt(1.0 - memory[at] ** 2) * drive[:, at]
    return found
