"""Effects in separated torques that are late, against moves that are sampled, filtered and shifted.

The response is applied to samples over time, here, and to the columns of an effect over the angle,
in the program.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from frictioncli.diagnosis.data.late_torque import LateTorque, late_basis
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.effects.tables import small

PERIOD = 1e-4
POSITION = np.arange(20.0, 77.5, 2.5)


def logged(torque, *, speed: float, way: int, delay: float, time_constant: float):
    """Return the torque that a log shows at each position of a move at constant speed."""
    time = np.arange(0.0, 190.0 / speed, PERIOD)
    angle = -50.0 + speed * time if way > 0 else 140.0 - speed * time
    samples = torque(angle, way)
    if time_constant:
        memory = np.exp(-PERIOD / time_constant)
        samples = lfilter([1 - memory], [1, -memory], samples, zi=[memory * samples[0]])[0]
    samples = np.interp(time - delay, time, samples)
    return np.interp(POSITION, angle[::way], samples[::way])


def separated(torque, counted: int, **response):
    """Return friction and load of two moves."""
    forward, reverse = (logged(torque, way=way, **response) for way in (1, -1))
    return counted * (forward - reverse) / 2, (forward + reverse) / 2


@pytest.mark.parametrize("counted", [1, -1])
@pytest.mark.parametrize(
    ("speed", "delay", "time_constant"),
    [(20.0, 0.02, 0.0), (100.0, 0.012, 0.04), (160.0, 0.012, 0.06)],
)
def test_a_ripple_of_friction_shows_in_both_channels(speed, delay, time_constant, counted):
    def torque(angle, way):
        return counted * way * np.sin(9 * np.radians(angle))

    friction, load = separated(
        torque, counted, speed=speed, delay=delay, time_constant=time_constant
    )
    table = small(position=POSITION, speed=speed)
    late = LateTorque(delay=delay + time_constant, variance=time_constant**2)
    basis = late_basis(
        BY_NAME["position_ripple"],
        table,
        {"order": 9.0},
        late,
        counted=float(counted),
        alpha=0.0,
        separate_load=False,
    )
    assert basis.friction[:, 0] == pytest.approx(friction, abs=2e-3)
    assert basis.load[:, 0] == pytest.approx(load, abs=2e-3)


@pytest.mark.parametrize("counted", [1, -1])
def test_a_change_of_gravity_shows_in_friction(counted):
    """With a load of friction that grows with its square, at any angle of the moves."""
    alpha, late = 0.004, LateTorque(delay=0.05, variance=0.0)

    def gravity(angle, mass):
        return (40.0 + mass) * np.sin(np.radians(angle) + 0.3)

    def simulated(mass):
        def torque(angle, way):
            load = gravity(angle, mass)
            return load + counted * way * alpha * load**2

        return separated(torque, counted, speed=60.0, delay=0.05, time_constant=0.0)

    step = 1e-3
    friction, load = (
        (heavier - lighter) / step
        for heavier, lighter in zip(simulated(step), simulated(0.0), strict=True)
    )
    angle = np.radians(POSITION) + 0.3
    per_degree = np.radians(1.0)
    table = small(
        position=POSITION,
        speed=60.0,
        load=40.0 * np.sin(angle),
        load_gradient=counted * 40.0 * per_degree * np.cos(angle),
        load_curvature=-40.0 * per_degree**2 * np.sin(angle),
        load_slope=2 * alpha * 40.0 * np.sin(angle),
        friction=alpha * (40.0 * np.sin(angle)) ** 2,
    )
    effect = BY_NAME["payload_change"]
    shape = {"moment": -1.0, "end": 2.0}
    basis = late_basis(
        effect, table, shape, late, counted=float(counted), alpha=alpha, separate_load=False
    )
    mix = np.array([np.sin(0.3), np.cos(0.3)])
    assert basis.load @ mix == pytest.approx(load, abs=2e-3)
    assert basis.friction @ mix == pytest.approx(friction, abs=2e-3)


def test_what_does_not_depend_on_the_angle_is_the_same():
    table = small(position=POSITION, speed=np.linspace(5, 100, len(POSITION)))
    effect = BY_NAME["stribeck"]
    shape = {axis.name: axis.lower for axis in effect.shape}
    late = LateTorque(delay=0.05, variance=0.001)
    basis = late_basis(effect, table, shape, late, counted=1.0, alpha=0.0, separate_load=False)
    assert np.array_equal(basis.friction, effect.evaluate(table, shape).friction)


@pytest.mark.parametrize("late", [None, LateTorque(delay=0.03, variance=0.0004)])
@pytest.mark.parametrize("name", ["payload_change", "step_change"])
def test_a_change_has_the_columns_of_its_effect_in_each_stretch(name, late):
    """Of some rows of a joint, whose history counts all pairs."""
    data, effect = replace(problem(0), late=late), BY_NAME[name]
    for shape in (
        {"moment": 0.3, "end": 1.0},
        {"moment": 0.1, "end": 0.2, "moment_2": 0.5, "end_2": 0.75},
        {"moment": 1.0, "end": 1.0},
    ):
        expected = effect.evaluate(data.all_runs, shape)
        if late is not None:
            expected = late_basis(
                effect,
                data.all_runs,
                shape,
                late,
                counted=data.counted,
                alpha=data.parameters.alpha,
                separate_load=data.has_load_channel,
            )
        for found, one in zip(data.basis(effect, shape), expected, strict=True):
            np.testing.assert_allclose(found, one[data.rows], rtol=1e-12, atol=1e-15)


def test_nodes_have_the_moments_of_a_filter_behind_a_delay():
    weights, times = np.array(LateTorque(delay=0.05, variance=0.0009).nodes()).T
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ times == pytest.approx(0.05)
    assert weights @ (times - 0.05) ** 2 == pytest.approx(0.0009)
    assert weights @ (times - 0.05) ** 3 == pytest.approx(2 * 0.03**3)
