"""A lag of the gear behind a sensor that lags as well: its interval holds what is there."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import left_by, span_of
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.slow_sensor import behind_sensor
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
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


@pytest.fixture(scope="module")
def heated_gear():
    """Rows of a joint whose gear friction warms, and the gear's temperature in each pair."""
    return torques(Network(motor_heat=0.2, motor_gear=15.0, gear=5000.0))


@pytest.mark.parametrize("late", [0.0, 45.0, 90.0])
@pytest.mark.parametrize("gear_leads", [True, False])
def test_what_a_sensor_may_have_added_to_a_lag_is_in_its_interval(heated_gear, late, gear_leads):
    """What is seen is the sum; the gear has another temperature, after which no sensor lags."""
    rows, gear = heated_gear
    base, _ = build_problems(rows, "motor", "day1")
    table = base.table
    hidden = replace(base, table=replace(table, temperature=table.temperature[::-1].copy()))
    of_row = np.repeat(gear, len(BINS))[: len(table.speed)]
    ahead = table.temperature_slope * (of_row - table.temperature) * (1.0 if gear_leads else -1.0)
    sensor = BY_NAME["sensor_lag"].basis(table).friction[:, 0]
    seen = friction_only(ahead + late * sensor)
    effect = replace(BY_NAME["thermal_lag"], shape=(), basis=lambda table: seen)
    fit = EffectFit(effect, {}, np.ones(1), np.zeros((1, 1)), 0.0)
    span = span_of(base)
    size_of = partial(_size_of, span)
    alone = {"thermal_lag": 1.0}
    cause = Cause(
        fit=fit,
        test=None,
        effects=tuple(alone),
        probabilities=alone,
        size=1.0,
        visible=size_of(seen),
        visible_interval=(size_of(seen), size_of(seen)),
    )
    (stated,) = behind_sensor([cause], [], hidden, base, span)
    low, high = stated.visible_interval
    assert low - 1e-9 <= size_of(friction_only(ahead)) <= high + 1e-9
    assert high - low > 0.1


def _size_of(span, columns):
    left = left_by(span, columns)
    return float(np.sqrt(2 * np.mean(np.square(left))))
