"""The thermal network against hand calculation, the one-node exponential and the energy balance."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from frictioncli.simulator.arm import Arm, Body
from frictioncli.simulator.friction_zones import LubricatedZone
from frictioncli.simulator.joint import HeatEntry, MeanPower, RoundTripMotion, SimulatedJoint
from frictioncli.simulator.motion_profile import Servo
from frictioncli.simulator.thermal_history import MOTOR, ThermalHistory
from frictioncli.simulator.thermal_network import Ambient, ThermalLink, ThermalNetwork, ThermalNode

TRIPS = RoundTripMotion(speed=90.0, angles=(0.0, 180.0), dwell=0.5)
# 180 deg at 90 deg/s with ramps at 180 deg/s² take 2.5 s, the dwell makes it 3 s: pi rad each 3 s.
HEAT = 30.0 * np.pi / 3.0


def dry_joint(
    network: ThermalNetwork, shares: dict[str, float], copper_loss: float = 0.0
) -> SimulatedJoint:
    """Return a joint with 30 N·m of dry friction whatever happens, and no weight."""
    nothing = Body(name="nothing", mass=0.0, along=0.0, across=0.0)
    return SimulatedJoint(
        arm=Arm(bodies=(), payload=nothing, rotor_inertia=0.0),
        servo=Servo(acceleration=180.0, frequency=6.0, damping=0.4),
        zones=(
            LubricatedZone(
                name="dry",
                node=MOTOR,
                coulomb=30.0,
                viscous_floor=0.0,
                viscous=0.0,
                thinning=0.0,
                speed_exponent=1.0,
            ),
        ),
        network=network,
        heat=HeatEntry(copper_loss=copper_loss, shares=shares),
    )


ONE_NODE = ThermalNetwork(
    nodes=(ThermalNode(name=MOTOR, capacity=800.0, to_ambient=0.5),), links=()
)
CHAIN = ThermalNetwork(
    nodes=(
        ThermalNode(name=MOTOR, capacity=500.0, to_ambient=0.0),
        ThermalNode(name="middle", capacity=900.0, to_ambient=0.2),
        ThermalNode(name="end", capacity=1500.0, to_ambient=1.0),
    ),
    links=(
        ThermalLink(first=MOTOR, second="middle", conductance=2.0),
        ThermalLink(first="middle", second="end", conductance=4.0),
    ),
)


def test_friction_heat_is_torque_times_angle_per_time():
    joint = dry_joint(ONE_NODE, {MOTOR: 1.0})
    assert MeanPower(joint, TRIPS)({MOTOR: 20.0}) == pytest.approx(HEAT, rel=1e-12)


def test_copper_loss_is_added_while_torque_acts():
    # 30 N·m acts in 2.5 s of each 3 s.
    joint = dry_joint(ONE_NODE, {MOTOR: 1.0}, copper_loss=0.01)
    expected = HEAT + 0.01 * 900.0 * 2.5 / 3.0
    assert MeanPower(joint, TRIPS)({MOTOR: 20.0}) == pytest.approx(expected, rel=1e-12)


def test_one_node_heats_and_cools_exponentially():
    history = ThermalHistory(dry_joint(ONE_NODE, {MOTOR: 1.0}), Ambient(start=20.0))
    history.continue_for(2000.0, TRIPS)
    rise = HEAT / 0.5 * (1.0 - np.exp(-2000.0 / 1600.0))
    assert history.state[0] == pytest.approx(20.0 + rise, abs=1e-4)
    history.continue_for(1000.0)
    assert history.state[0] == pytest.approx(20.0 + rise * np.exp(-1000.0 / 1600.0), abs=1e-4)


def test_event_falls_on_the_exponential():
    history = ThermalHistory(dry_joint(ONE_NODE, {MOTOR: 1.0}), Ambient(start=20.0))
    assert history.continue_until(40.5, TRIPS)
    assert history.time == pytest.approx(-1600.0 * np.log(1.0 - 20.5 * 0.5 / HEAT), abs=0.01)


def test_temperature_out_of_reach_is_told():
    history = ThermalHistory(dry_joint(ONE_NODE, {MOTOR: 1.0}), Ambient(start=20.0))
    assert not history.continue_until(20.0 + HEAT / 0.5 + 1.0, TRIPS)
    assert history.time == 0.0


def test_steady_state_of_a_chain_by_hand():
    chain = ThermalNetwork(
        nodes=(
            ThermalNode(name="hot", capacity=1.0, to_ambient=0.0),
            ThermalNode(name="cold", capacity=1.0, to_ambient=2.0),
        ),
        links=(ThermalLink(first="hot", second="cold", conductance=5.0),),
    )
    # 60 W through 2 W/K to ambient and through 5 W/K before.
    assert chain.steady_state(power=[60.0, 0.0], ambient=18.0) == pytest.approx([60.0, 48.0])


def test_network_integrates_to_its_steady_state():
    history = ThermalHistory(dry_joint(CHAIN, {MOTOR: 0.6, "end": 0.4}), Ambient(start=15.0))
    history.continue_for(100_000.0, TRIPS)
    expected = CHAIN.steady_state(power=[0.6 * HEAT, 0.0, 0.4 * HEAT], ambient=15.0)
    assert history.state == pytest.approx(expected, abs=1e-3)


def test_energy_is_conserved():
    ambient = Ambient(start=15.0, drift=-1.5)
    history = ThermalHistory(dry_joint(CHAIN, {MOTOR: 0.6, "end": 0.4}), ambient)
    history.continue_for(3000.0, TRIPS)
    history.continue_for(2000.0)
    time = np.linspace(0.0, 5000.0, 20_001)
    temperatures = history.at(time)
    loss = sum(
        node.to_ambient * trapezoid(temperatures[node.name] - (15.0 - 1.5 * time / 3600.0), time)
        for node in CHAIN.nodes
    )
    stored = sum(node.capacity * (temperatures[node.name][-1] - 15.0) for node in CHAIN.nodes)
    assert stored + loss == pytest.approx(3000.0 * HEAT, rel=1e-5)


def test_heat_flows_back_and_forth_alike():
    matrix = CHAIN.conductance_matrix()
    assert matrix == pytest.approx(matrix.T)
    assert matrix.sum(axis=1) == pytest.approx([0.0, 0.2, 1.0])
