"""Gravity, friction zones and equation (1), against hand calculation."""

import numpy as np
import pytest

from frictioncli.simulator import default_joint
from frictioncli.simulator.arm import Arm, Body
from frictioncli.simulator.friction_zones import LubricatedZone, friction_torque
from frictioncli.simulator.motion_profile import MotionProfile
from frictioncli.simulator.noise import SimulatedNoise
from frictioncli.simulator.recording import control_torque, registered

ARM = Arm(
    bodies=(Body(name="link", mass=2.0, along=0.5, across=0.1, own_inertia=0.05),),
    payload=Body(name="load", mass=1.0, along=1.0, across=-0.1),
    rotor_inertia=0.7,
)
ZONE = LubricatedZone(
    name="zone",
    node="gear",
    coulomb=2.0,
    load_square=0.001,
    viscous_floor=1.0,
    viscous=3.0,
    thinning=0.05,
    speed_exponent=0.5,
)
TEMPERATURES = {"motor sensor": 45.0, "motor": 46.0, "gear": 42.0, "housing": 35.0}


def test_gravity_by_hand():
    # Level: 9.81*(2*0.5 + 1*1); upright: -9.81*(2*0.1 - 1*0.1).
    assert ARM.gravity_torque([0.0, 90.0, 180.0]) == pytest.approx([19.62, -0.981, -19.62])


def test_gravity_is_the_slope_of_the_potential_energy():
    def energy(angle):
        a = np.radians(angle)
        link = 2.0 * 9.81 * (0.5 * np.sin(a) + 0.1 * np.cos(a))
        return link + 1.0 * 9.81 * (1.0 * np.sin(a) - 0.1 * np.cos(a))

    angles = np.linspace(0.0, 180.0, 19)
    slope = (energy(angles + 1e-3) - energy(angles - 1e-3)) / np.radians(2e-3)
    assert ARM.gravity_torque(angles) == pytest.approx(slope, abs=1e-6)


def test_inertia_by_hand():
    # 0.05 + 2*(0.25 + 0.01) + 1*(1 + 0.01) + 0.7
    assert ARM.inertia() == pytest.approx(2.28)


def test_default_arm_loads_the_joint_as_in_the_paper():
    arm = default_joint.joint(payload=2.0, motor_heat_share=0.5).arm
    amplitude = np.hypot(*arm.gravity_coefficients())
    assert 90.0 <= amplitude <= 100.0
    mesh = next(zone for zone in default_joint.ZONES if zone.name == "gear mesh")
    assert mesh.load_square * amplitude**2 == pytest.approx(12.0, abs=1.5)


def test_zone_by_hand():
    # 2 + 0.001*400 + (1 + 3)*5 at 40 °C; at 60 °C the 3 becomes 3/e.
    found = ZONE.torque(load=20.0, speed=25.0, temperature=[40.0, 60.0])
    assert found == pytest.approx([22.4, 2.4 + 5.0 * (1.0 + 3.0 / np.e)])


def test_zones_add_up_each_at_its_own_temperature():
    found = friction_torque((ZONE, ZONE), load=20.0, speed=25.0, temperatures={"gear": 40.0})
    assert found == pytest.approx(44.8)


@pytest.mark.parametrize("sign", [1, -1])
def test_equation_one(sign):
    joint = default_joint.joint(payload=2.0, motor_heat_share=0.5)
    position = np.array([0.0, 60.0, 60.0, 120.0])
    velocity = np.array([0.0, 67.5, -67.5, 40.0])
    acceleration = np.array([0.0, 0.0, 0.0, -300.0])
    torque = control_torque(
        joint,
        MotionProfile(position, velocity, acceleration),
        temperatures={node: np.full(4, value) for node, value in TEMPERATURES.items()},
        sign=sign,
    )
    weight = 9.81 * sum(
        body.mass
        * (body.along * np.cos(np.radians(position)) - body.across * np.sin(np.radians(position)))
        for body in (*joint.arm.bodies, joint.arm.payload)
    )
    friction = sum(
        zone.coulomb
        + zone.load_square * weight**2
        + (
            zone.viscous_floor
            + zone.viscous * np.exp(-zone.thinning * (TEMPERATURES[zone.node] - 40.0))
        )
        * np.abs(velocity) ** zone.speed_exponent
        for zone in default_joint.ZONES
    )
    inertial = joint.arm.inertia() * np.pi / 180.0 * acceleration
    assert torque == pytest.approx(inertial + weight + sign * np.sign(velocity) * friction)
    assert torque[0] == pytest.approx(weight[0])
    assert sign * (torque[1] - torque[2]) / 2.0 == pytest.approx(friction[1])
    assert (torque[1] + torque[2]) / 2.0 == pytest.approx(weight[1])


def test_sensor_registers_the_nearest_step():
    assert registered([24.49, 24.5, 25.49, 25.5], 1.0).tolist() == [24.0, 25.0, 25.0, 26.0]
    assert registered(36.26, 0.1) == pytest.approx(36.3)


def test_noise_has_the_stated_deviation_and_memory():
    noise = SimulatedNoise(
        white=0.6, correlated=0.8, correlation_time=0.12, slow=0.0, slow_time=1.0, per_pair=0.0
    )
    drawn = noise.stationary_noise(np.random.default_rng(7), count=200_000, interval=0.012)
    assert drawn.std() == pytest.approx(1.0, rel=0.02)
    # Only the correlated part survives a lag of ten samples, one correlation time: 0.64/e.
    assert np.mean(drawn[10:] * drawn[:-10]) == pytest.approx(0.64 / np.e, abs=0.03)


def test_friction_wanders_slowly_between_round_trips():
    noise = SimulatedNoise(
        white=0.0, correlated=0.0, correlation_time=1.0, slow=0.5, slow_time=600.0, per_pair=0.2
    )
    times = np.arange(100_000) * 60.0
    drawn = noise.pair_offsets(np.random.default_rng(7), times)
    assert drawn.var() == pytest.approx(0.25 + 0.04, rel=0.05)
    assert np.mean(drawn[10:] * drawn[:-10]) == pytest.approx(0.25 / np.e, abs=0.02)
    assert not noise.scaled(0.0).pair_offsets(np.random.default_rng(7), times).any()
