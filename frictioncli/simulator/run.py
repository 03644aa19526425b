"""Setup and simulation of one run."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from frictioncli.simulator import default_joint
from frictioncli.simulator.cells import RoundTrips, cells_of, round_trips_of
from frictioncli.simulator.enriched_protocol import PAYLOADS, SPEEDS, run_enriched
from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.network_joint import network_joint
from frictioncli.simulator.noise import SimulatedNoise, noise_of_kind
from frictioncli.simulator.nuisances.catalogue import requested_nuisances
from frictioncli.simulator.nuisances.changed_joint import changed_joint
from frictioncli.simulator.nuisances.daily_ambient import changed_ambient
from frictioncli.simulator.nuisances.definition import NO_NUISANCES, Nuisances
from frictioncli.simulator.paper_protocol import MeasuringSeries, PaperProgram, run_program
from frictioncli.simulator.plain_joint import plain_joint
from frictioncli.simulator.planted.operating_history import (
    EarlierRuns,
    OperatingHistory,
    operating_history,
)
from frictioncli.simulator.planted.state import State
from frictioncli.simulator.recording import Logger
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import History, ThermalHistory
from frictioncli.simulator.thermal_network import Ambient

FIRST_DAY = datetime(2019, 3, 4, 8, 0, 0)
"""Start of the first run; each further run starts a day later."""

_ORDER_STREAM = 1_000_000
"""Keeps the random numbers of an enriched protocol apart from those of the noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSetup:
    """Setup of one run.

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
        Masses at the flange in its series. [kg]
    joints : tuple of SimulatedJoint
        The joint with each of them.
    program : PaperProgram
        Motion program.
    ambient : Ambient
        Ambient temperature.
    logger : Logger
        Sampling and resolutions.
    noise : SimulatedNoise
        Random parts of torque and friction.
    seeds : numpy.random.SeedSequence
        Seeds of all its random parts.
    enriched : bool
        Whether the protocol is the enriched one.
    nuisances : Nuisances
        What joint and log do besides.
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
    nuisances: Nuisances = NO_NUISANCES

    @property
    def joint(self) -> SimulatedJoint:
        """The joint with the first payload."""
        return self.joints[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedRun:
    """A run that has been simulated.

    Attributes
    ----------
    setup : RunSetup
        What it was simulated with.
    history : History
        Temperatures.
    series : tuple of MeasuringSeries
        Recordings, in order of time.
    trips : RoundTrips
        Round trips of all recordings.
    operation : OperatingHistory
        Heat, travel and rests, earlier runs included.
    """

    setup: RunSetup
    history: History
    series: tuple[MeasuringSeries, ...]
    trips: RoundTrips
    operation: OperatingHistory

    def states(self) -> list[State]:
        """Return the states in the run's cells, for each payload."""
        return [
            cells_of(
                joint,
                self.setup.program,
                self.history,
                self.operation,
                self.trips,
                payload_index=index,
                interval=self.setup.logger.interval,
                nuisances=self.setup.nuisances,
            ).state
            for index, joint in enumerate(self.setup.joints)
        ]


def run_setup(settings: SynthesisSettings, number: int, seeds: np.random.SeedSequence) -> RunSetup:
    """Return the setup of run ``number``, counted from 0, of a synthesis."""

    def of_run(values: tuple[float, ...]) -> float:
        return values[number % len(values)]

    nuisances = requested_nuisances(settings.nuisances, settings.seed)
    if settings.joint_kind == "zones":  # has zones of its own
        nuisances = nuisances.without("friction_zones")
    enriched = settings.protocol == "enriched"
    payloads = tuple(settings.payload + more for more in (PAYLOADS if enriched else (0.0,)))
    program = replace(default_joint.PROGRAM, lowest=settings.lowest, highest=settings.highest)
    return RunSetup(
        name=f"day{number + 1}",
        number=number,
        day=FIRST_DAY + timedelta(days=number),
        axis=settings.joint,
        payloads=payloads,
        joints=tuple(
            joint_of(settings.joint_kind, payload, of_run(settings.motor_heat_share), nuisances)
            for payload in payloads
        ),
        program=replace(program, sweep_speeds=(), cycle_speeds=SPEEDS) if enriched else program,
        ambient=changed_ambient(
            Ambient(start=of_run(settings.ambient), drift=of_run(settings.ambient_drift)),
            nuisances,
        ),
        logger=replace(
            default_joint.LOGGER,
            sign=settings.sign,
            interval=default_joint.LOGGER.interval * settings.thin,
            motor_step=nuisances.size("sensor_step") or default_joint.LOGGER.motor_step,
        ),
        noise=_noise(settings, nuisances).scaled(settings.noise_scale),
        seeds=seeds,
        enriched=enriched,
        nuisances=nuisances,
    )


def _noise(settings: SynthesisSettings, nuisances: Nuisances) -> SimulatedNoise:
    """Return the noise of the settings' kind; noise along a move takes the place of its own."""
    noise = noise_of_kind(settings.noise_kind, default_joint.NOISE)
    size = nuisances.size("move_noise")
    if size == 0.0:
        return noise
    memory = nuisances.parameter("move_noise", "correlation_time")
    return replace(noise, correlated=size, correlation_time=memory)


def simulate(
    setups: list[RunSetup], history_type: type[History] = ThermalHistory
) -> list[SimulatedRun]:
    """Simulate runs, one after the other on the same joint.

    Parameters
    ----------
    setups : list of RunSetup
        Setups of the runs, in order of time.
    history_type : type of History
        Integrator of the temperatures.

    Returns
    -------
    list of SimulatedRun
        The simulated runs.
    """
    simulated = [_run(setup, history_type) for setup in setups]
    total = sum(history.time for history, _ in simulated)
    operated = travelled = 0.0
    runs = []
    for setup, (history, series) in zip(setups, simulated, strict=True):
        earlier = EarlierRuns(
            operated=operated,
            travelled=travelled,
            total=total,
        )
        operation = operating_history(
            history, setup.program.angles, first=series[0].start, earlier=earlier
        )
        runs.append(
            SimulatedRun(
                setup=setup,
                history=history,
                series=series,
                trips=round_trips_of(setup.program, setup.joint.servo, series),
                operation=operation,
            )
        )
        operated += history.time
        travelled += float(operation.travel[-1])
    return runs


def _run(
    setup: RunSetup, history_type: type[History]
) -> tuple[History, tuple[MeasuringSeries, ...]]:
    if not setup.enriched:
        return run_program(setup.joint, setup.program, setup.ambient, history_type)
    seed = np.random.SeedSequence(
        setup.seeds.entropy, spawn_key=(*setup.seeds.spawn_key, _ORDER_STREAM)
    )
    generator = np.random.Generator(np.random.PCG64(seed))
    return run_enriched(setup.joints, setup.program, setup.ambient, generator, history_type)


def joint_of(
    kind: str, payload: float, motor_heat_share: float, nuisances: Nuisances = NO_NUISANCES
) -> SimulatedJoint:
    """Return the joint of a kind with a payload [kg] and a share of heat at the motor."""
    joint = default_joint.joint(payload=payload, motor_heat_share=motor_heat_share)
    if kind != "zones":
        made = plain_joint if kind == "plain" else network_joint
        joint = made(arm=joint.arm, servo=joint.servo, motor_heat_share=motor_heat_share)
    return changed_joint(joint, nuisances)
