"""A lag of the gear behind a sensor that lags as well: its interval holds what is there."""

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.fit.left_by_base import left_by, span_of
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects.base import friction_only
from tests.diagnosis.thermal_joint import BINS, Network, friction, torques

SENSOR = 75.0
"""Delay of the sensor. [s]"""


@pytest.mark.long
def test_what_a_slow_sensor_hides_of_a_lag_is_in_its_interval():
    table, gear = torques(Network(motor_heat=1.0, motor_gear=25.0, gear=5000.0))
    of_row = np.repeat(gear, len(BINS))
    late = table.copy()
    for _, rows in table.groupby("run", observed=True):
        late.loc[rows.index, "motor_temperature"] = np.interp(
            rows["time"] - SENSOR, rows["time"], rows["motor_temperature"]
        )
    diagnosis = diagnose_joint(late, "motor", "N·m", DiagnosisSettings())
    cause = next(one for one in diagnosis.causes if one.effects == ("thermal_lag",))
    seen, _ = build_problems(late, "motor", "day1")
    rows = table[table["run"] == "day0"].sort_values(["time", "pair", "position"])
    torque = friction(rows["speed"], of_row[rows.index]) - friction(
        rows["speed"], rows["motor_temperature"]
    )
    left = left_by(span_of(seen), friction_only(torque.to_numpy()))
    true = float(np.sqrt(2 * np.mean(np.square(left))))
    low, high = cause.visible_interval
    assert cause.visible < 0.95 * true
    assert low < true < high
