"""Equation (16) and its inverse, by hand and by algebra."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.model.friction import (
    PUBLISHED,
    FrictionParameters,
    carried_to_temperature,
    friction_torque,
    temperature_from_friction,
)


def test_published_joint_by_hand():
    """10.57 + 0.0014 * 50^2 + (3.48 + 15.66 * exp(-0.056 * 40)) * sqrt(64).

    exp(-2.24) = 0.106459, times 15.66 = 1.66714; plus 3.48 = 5.14714; times 8 = 41.1771;
    0.0014 * 2500 = 3.5.
    """
    found = friction_torque(PUBLISHED, load=-50.0, speed=64.0, temperature=40.0)
    assert found == pytest.approx(10.57 + 3.5 + 41.1771, abs=1e-3)


def test_temperature_takes_up_to_half_of_the_friction():
    """The paper, section 3.5; its parameters give 84 N·m at 25 °C and 50 N·m at 65 °C."""
    cold, hot = friction_torque(PUBLISHED, load=0.0, speed=101.2, temperature=[25.0, 65.0])
    assert (round(float(cold)), round(float(hot))) == (84, 50)


positive = st.floats(0.01, 20)


@given(
    tau_c=positive,
    alpha=st.floats(0, 0.01),
    beta=positive,
    gamma=st.floats(1.0, 50.0),
    delta=st.floats(0.01, 0.1),
    load=st.floats(-100, 100),
    speed=st.floats(1, 300),
    temperature=st.floats(0, 80),
)
def test_inversion_finds_the_temperature(
    tau_c, alpha, beta, gamma, delta, load, speed, temperature
):
    parameters = FrictionParameters(tau_c=tau_c, alpha=alpha, beta=beta, gamma=gamma, delta=delta)
    friction = friction_torque(parameters, load=load, speed=speed, temperature=temperature)
    found = temperature_from_friction(parameters, friction=friction, load=load, speed=speed)
    assert found == pytest.approx(temperature, abs=0.01)


def test_impossible_friction_has_no_temperature():
    """Below tau_c + beta sqrt(v) = 10.57 + 34.8 N·m no temperature is hot enough."""
    found = temperature_from_friction(
        PUBLISHED, friction=[40.0, 45.37, 50.0], load=0.0, speed=100.0
    )
    assert np.isnan(found).tolist() == [True, True, False]


def test_carrying_to_a_temperature_moves_along_the_viscous_law():
    """At 100 deg/s from 60 to 20 °C: 15.66 * 10 * (exp(-1.12) - exp(-3.36)) = 45.658."""
    carried = carried_to_temperature(
        PUBLISHED, friction=30.0, speed=100.0, temperature=60.0, target=20.0
    )
    assert carried == pytest.approx(30.0 + 156.6 * (0.326280 - 0.034735), abs=1e-2)
