"""The thermal model, against its closed form."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.design.thermal_model import ThermalModel, thermal_model_of
from tests.design.examples import heating_runs


@pytest.fixture(scope="module")
def runs():
    return heating_runs()


def test_a_known_thermal_law_is_found_again():
    """Temperatures from the law's closed form, stretch by stretch, heating and cooling."""
    law = ThermalModel(ambient=20.0, time_constant=4000.0, heating=1e-6, housing_share=0.6)
    speed, friction, low, high = 100.0, 60.0, 0.0, 150.0
    warm, rows = 20.0, []
    for number in range(400):
        moves = number < 250
        rows.append((5.0 * number, warm, speed if moves else 150.0 / 1e6, friction if moves else 0))
        warm = law.after(warm, 5.0, power=speed * friction * (2 * 150.0 / speed / 5.0) * moves)
    table = pd.DataFrame(
        [
            {
                "run": "a",
                "pair": number,
                "time": time,
                "speed": 100.0,
                "motor_temperature": motor,
                "housing_temperature": 20.0 + 0.6 * (motor - 20.0),
                "friction_torque": tau,
                "position": position,
            }
            for number, (time, motor, _, tau) in enumerate(rows)
            for position in (low, high)
        ]
    )
    found = thermal_model_of(table)
    assert found.ambient == 20.0
    assert found.time_constant == pytest.approx(4000.0, rel=0.15)
    assert found.heating == pytest.approx(1e-6, rel=0.1)
    assert found.housing_share == pytest.approx(0.6, rel=1e-6)


def test_a_motor_heats_to_balance_and_cools_to_ambient():
    law = ThermalModel(ambient=20.0, time_constant=4000.0, heating=1e-6, housing_share=0.6)
    assert law.after(20.0, 1e7, power=5000.0) == pytest.approx(20.0 + 1e-6 * 5000.0 * 4000.0)
    assert law.after(60.0, 4000.0) == pytest.approx(20.0 + 40.0 / np.e)


def test_without_a_temperature_there_is_no_thermal_law(runs):
    assert thermal_model_of(runs[0].assign(motor_temperature=np.nan)) is None
