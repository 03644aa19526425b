"""Joints over ten days, as the simulator makes them: unchanged, worn, or changed otherwise.

Wear is put into the simulator's friction zones before a day is simulated, so a worn joint also
warms by its friction. The simulator has three zones at three temperatures and shares no code with
the model that is fitted.
"""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from frictioncli.simulator.joint import SimulatedJoint
from frictioncli.simulator.planted.planting import PlantedEffects
from frictioncli.simulator.run import RunSetup, run_setup, simulate
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.fast_history import FastHistory
from tests.simulation.torque_table import run_cells, table_of

LOWEST, HIGHEST = 38, 60
"""Motor temperatures of the thermal cycle: it must be warmer than the warmest surroundings. [°C]"""

SURROUNDINGS = (10.0, 35.0)
"""Between these the surroundings of each day are drawn. [°C]"""

SPEEDS = (19.1, 39.4, 67.5, 101.2)

KINDS = ("unchanged", "wear", "dry wear", "viscous wear", "sudden", "season", "payload", "sensor")
"""What happens to a joint; in ``season`` nothing does, but each day is warmer than the last."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Life:
    """A joint's life.

    Attributes
    ----------
    kind : str
        What happens to it, one of :data:`KINDS`.
    runs : int
        Days on which it is measured.
    change : float
        Friction of the last day beyond the first, as a share; of what is logged, for ``sensor``.
    seed : int
        Of everything random.
    joint_kind : str
        ``zones`` or ``plain``.
    even : bool
        Whether the surroundings are the same every day, within a degree.
    """

    kind: str
    runs: int = 10
    change: float = 0.0
    seed: int = 0
    joint_kind: str = "zones"
    even: bool = False


def torques_of(life: Life) -> pd.DataFrame:
    """Return the table of torques of all days, named ``day01`` and so on."""
    generator = np.random.default_rng([life.seed, KINDS.index(life.kind), life.runs, life.even])
    surroundings = generator.uniform(*SURROUNDINGS, life.runs)
    if life.even:
        surroundings = surroundings[0] + generator.uniform(-1.0, 1.0, life.runs)
    if life.kind == "season":
        surroundings = np.sort(surroundings)
    # heat enters the joint a little otherwise each day, as work before the measurement does it
    share = generator.uniform(0.4, 0.6) + 0.02 * generator.standard_normal(life.runs)
    settings = SynthesisSettings(
        seed=int(generator.integers(2**31)),
        runs=life.runs,
        payload=float(generator.uniform(1.0, 4.0)),
        lowest=LOWEST,
        highest=HIGHEST,
        ambient=tuple(surroundings),
        ambient_drift=tuple(generator.uniform(-0.3, 0.3, life.runs)),
        motor_heat_share=tuple(share),
        joint_kind=life.joint_kind,
    )
    courses = _course(life)
    seeds = np.random.SeedSequence(settings.seed).spawn(life.runs)
    runs = [
        _changed(run_setup(settings, number, seed), life, float(course))
        for number, (seed, course) in enumerate(zip(seeds, courses, strict=True))
    ]
    tables = [
        table_of(run, run_cells(run), PlantedEffects()) for run in simulate(runs, FastHistory)
    ]
    for number, table in enumerate(tables):
        table["run"] = f"day{number + 1:02d}"
        if life.kind == "sensor":
            factor = 1 + life.change * courses[number]
            table[["friction_torque", "load_torque"]] *= factor
    together = pd.concat(tables, ignore_index=True)
    # what a joint carries is not told here
    return together.assign(payload=np.nan)


def _course(life: Life) -> NDArray[np.float64]:
    """Return how much of the change each day has."""
    steady = np.linspace(0.0, 1.0, life.runs)
    return np.round(steady) if life.kind in ("sudden", "payload") else steady


def _changed(run: RunSetup, life: Life, course: float) -> RunSetup:
    more = life.change * course
    program = replace(run.program, sweep_speeds=SPEEDS)
    joints = run.joints
    if life.kind in ("wear", "sudden"):
        joints = tuple(_worn(joint, dry=more, viscous=more) for joint in joints)
    elif life.kind == "dry wear":
        joints = tuple(_worn(joint, dry=more / _dry_share(joint), viscous=0.0) for joint in joints)
    elif life.kind == "viscous wear":
        share = 1 - _dry_share(run.joint)
        joints = tuple(_worn(joint, dry=0.0, viscous=more / share) for joint in joints)
    elif life.kind == "payload":
        joints = tuple(_carrying(joint, 1 + more) for joint in joints)
    return replace(run, joints=joints, program=program)


def _worn(joint: SimulatedJoint, *, dry: float, viscous: float) -> SimulatedJoint:
    """Return a joint whose dry and viscous friction are greater by these shares."""
    zones = tuple(
        replace(
            zone,
            coulomb=zone.coulomb * (1 + dry),
            load_square=zone.load_square * (1 + dry),
            viscous_floor=zone.viscous_floor * (1 + viscous),
            viscous=zone.viscous * (1 + viscous),
        )
        if hasattr(zone, "coulomb")
        else replace(
            zone,
            tau_c=zone.tau_c * (1 + dry),
            alpha=zone.alpha * (1 + dry),
            beta=zone.beta * (1 + viscous),
            gamma=zone.gamma * (1 + viscous),
        )
        for zone in joint.zones
    )
    return replace(joint, zones=zones)


def _dry_share(joint: SimulatedJoint) -> float:
    """Return the share of dry friction at 45 °C and the mean of the speeds, load included."""
    at = {name: 45.0 for name in joint.network.names}
    angles = np.linspace(0, 180, 37)
    load = joint.arm.gravity_torque(angles)[:, np.newaxis]
    still = joint.friction(load=load, speed=np.array([1e-9]), temperatures=at)
    moving = joint.friction(load=load, speed=np.array(SPEEDS), temperatures=at)
    return float(np.mean(still) / np.mean(moving))


def _carrying(joint: SimulatedJoint, factor: float) -> SimulatedJoint:
    payload = replace(joint.arm.payload, mass=joint.arm.payload.mass * factor)
    return replace(joint, arm=replace(joint.arm, payload=payload))
