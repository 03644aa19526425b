"""A joint with nuisances: a constant in its gravity, three friction zones, a slow sensor."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.arm import Arm
from frictioncli.simulator.friction_zones import LAW_TEMPERATURE, LubricatedZone, Zone
from frictioncli.simulator.joint import HeatEntry, SimulatedJoint, SplitHeatEntry
from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.plain_joint import JointFriction
from frictioncli.simulator.thermal_history import MOTOR
from frictioncli.simulator.thermal_network import ThermalLink, ThermalNetwork, ThermalNode

SHORTEST_LAG = 1.0
"""A sensor that is faster than this has no node of its own [s]."""

_SENSOR_CAPACITY = 5.0
"""Heat capacity of a slow sensor, too small to cool the motor [J/K]."""

_COULOMB_SHARES = (0.3, 0.4, 0.3)
_THINNING_SHARES = (0.8, 0.1, 0.1)
_FLOOR_SHARES = (0.1, 0.1, 0.8)
"""Shares of the friction zones in Coulomb torque and both parts of viscous torque [-]."""

_ZONE_EXPONENTS = (-1.0, 0.0, 1.0)
"""Speed exponents of the zones less 1/2, over their spread [-]."""

_ZONE_THINNING = (4.0, 0.0, -4.0)
"""Relative departure of their thinning rates, over the spread of the exponents [-]."""

_ZONE_SPEED = 40.0
"""Speed at which the zones together have the viscous torque of the joint [deg/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CounterbalancedArm(Arm):
    """Arm with a constant part of gravity, of a counterbalance or a tilted base.

    Attributes
    ----------
    constant : float
        Torque beside that of the bodies, which the gear carries as well. [N·m]
    """

    constant: float

    def gravity_torque(self, position: ArrayLike) -> Array:
        """Return the torque that holds the arm at an angle in deg [N·m]."""
        return np.asarray(Arm.gravity_torque(self, position) + self.constant)


def changed_joint(joint: SimulatedJoint, nuisances: Nuisances) -> SimulatedJoint:
    """Return the joint with the nuisances that are part of it."""
    constant = nuisances.size("gravity_constant")
    if constant != 0.0:
        arm = CounterbalancedArm(
            bodies=joint.arm.bodies,
            payload=joint.arm.payload,
            rotor_inertia=joint.arm.rotor_inertia,
            constant=constant,
        )
        joint = replace(joint, arm=arm)
    spread = nuisances.size("friction_zones")
    if spread > 0.0:
        zones = tuple(part for zone in joint.zones for part in _parts(zone, spread))
        joint = replace(joint, zones=zones)
    lag = nuisances.size("sensor_lag")
    return _with_sensor(joint, lag) if lag >= SHORTEST_LAG else joint


def _parts(zone: Zone, spread: float) -> Iterator[Zone]:
    """Return three zones in place of one that follows equation (16), all at its temperature."""
    if not isinstance(zone, JointFriction):
        yield zone
        return
    for number, (exponent, thinning) in enumerate(
        zip(_ZONE_EXPONENTS, _ZONE_THINNING, strict=True)
    ):
        scale = _ZONE_SPEED ** (-spread * exponent)
        hot = float(np.exp(-zone.delta * LAW_TEMPERATURE))
        yield LubricatedZone(
            name=f"zone {number + 1}",
            node=zone.node,
            coulomb=_COULOMB_SHARES[number] * zone.tau_c,
            load_square=_COULOMB_SHARES[number] * zone.alpha,
            viscous_floor=scale * _FLOOR_SHARES[number] * zone.beta,
            viscous=scale * _THINNING_SHARES[number] * zone.gamma * hot,
            thinning=zone.delta * (1.0 + spread * thinning),
            speed_exponent=0.5 + spread * exponent,
        )


def _with_sensor(joint: SimulatedJoint, lag: float) -> SimulatedJoint:
    """Return the joint with its registered motor temperature behind by a time constant in s."""
    names = joint.network.names
    inner = "motor" if "motor" not in names else "sensor seat"

    def renamed(name: str) -> str:
        return inner if name == MOTOR else name

    network = joint.network
    nodes = tuple(
        ThermalNode(name=renamed(one.name), capacity=one.capacity, to_ambient=one.to_ambient)
        for one in network.nodes
    )
    links = tuple(
        ThermalLink(
            first=renamed(one.first), second=renamed(one.second), conductance=one.conductance
        )
        for one in network.links
    )
    sensor = ThermalNode(name=MOTOR, capacity=_SENSOR_CAPACITY, to_ambient=0.0)
    contact = ThermalLink(first=MOTOR, second=inner, conductance=_SENSOR_CAPACITY / lag)
    return replace(
        joint,
        network=ThermalNetwork(nodes=(sensor, *nodes), links=(*links, contact)),
        heat=_renamed_heat(joint.heat, renamed),
        zones=tuple(
            replace(zone, node=inner) if zone.node == MOTOR else zone  # type: ignore[type-var]
            for zone in joint.zones
        ),
    )


def _renamed_heat(heat: HeatEntry, renamed: Callable[[str], str]) -> HeatEntry:
    """Return the entry of heat with other names of the nodes."""
    shares = {renamed(name): one for name, one in heat.shares.items()}
    if not isinstance(heat, SplitHeatEntry):
        return replace(heat, shares=shares)
    copper = {renamed(name): one for name, one in heat.copper_shares.items()}
    return replace(heat, shares=shares, copper_shares=copper)
