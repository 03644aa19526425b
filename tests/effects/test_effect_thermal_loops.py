"""The thermal lag explains loops of both signs that a network of two heat capacities makes."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import least_squares, lsq_linear

from frictioncli.effects.thermal_lag import EFFECT
from tests.effects.tables import small

SPEEDS = np.array([17.0, 50.0, 101.0, 290.0])


class Cycle(NamedTuple):
    """Pairs of one heating and cooling."""

    time: np.ndarray
    speed: np.ndarray
    motor: np.ndarray
    gear: np.ndarray
    warming: np.ndarray


def cycle(*, coupling, motor_power, gear_power) -> Cycle:
    """Return four pairs per degree of a motor of 2.6 kJ/°C at a gear of 5 kJ/°C, in W and W/°C."""
    motor = gear = last = 23.5
    time, heating, rows = 0.0, True, []
    while heating or motor > 27.0:
        flow = coupling * (motor - gear)
        motor += 5.0 / 2600.0 * (motor_power * heating - flow - 0.6 * (motor - 23.5))
        gear += 5.0 / 5000.0 * (gear_power * heating + flow - 0.55 * (gear - 23.5))
        time += 5.0
        heating = heating and motor < 65.0
        if abs(motor - last) >= 1.0:
            last = motor
            rows += [(time + i, speed, motor, gear, heating) for i, speed in enumerate(SPEEDS)]
    return Cycle(*np.array(rows, dtype=float).T)


def friction(parameters, speed, temperature):
    tau_c, beta, gamma, delta = parameters
    return tau_c + (beta + gamma * np.exp(-delta * temperature)) * np.sqrt(speed)


@pytest.mark.parametrize(
    ("powers", "loop"),
    [
        ({"coupling": 3.0, "motor_power": 40.0, "gear_power": 28.0}, 1),
        ({"coupling": 1.5, "motor_power": 20.0, "gear_power": 60.0}, -1),
        ({"coupling": 3.0, "motor_power": 2.0, "gear_power": 80.0}, -1),
    ],
    ids=["motor heated", "gear heated", "gear alone heated"],
)
def test_loops_of_both_signs_are_explained_within_the_bounds(powers, loop):
    """At least four fifths of what the refitted base model leaves."""
    pairs = cycle(**powers)
    measured = friction((12.0, 1.6, 7.0, 0.035), pairs.speed, pairs.gear)
    fitted = least_squares(
        lambda p: friction(p, pairs.speed, pairs.motor) - measured, (12.0, 1.6, 7.0, 0.035)
    )
    falling = fitted.x[2] * np.exp(-fitted.x[3] * pairs.motor) * np.sqrt(pairs.speed)
    table = small(
        time=pairs.time,
        speed=pairs.speed,
        motor_temperature=pairs.motor,
        moved=np.where(pairs.warming == 1, np.diff(pairs.time, prepend=0.0), 0.0),
        housing_temperature=np.nan,
        friction=friction(fitted.x, pairs.speed, pairs.motor),
        temperature_slope=-fitted.x[3] * falling,
    )
    misfit = -fitted.fun
    fast = pairs.speed == SPEEDS[-1]
    branch = misfit[fast & (pairs.warming == 1)].mean() - misfit[fast & (pairs.warming == 0)].mean()
    assert np.sign(branch) == loop
    base = np.linalg.qr(fitted.jac)[0]
    bounds = (
        [p.lower for p in EFFECT.coefficients[:2]],
        [p.upper for p in EFFECT.coefficients[:2]],
    )
    left = []
    for time_constant in EFFECT.shape[0].grid():
        columns = EFFECT.evaluate(table, {"time_constant": time_constant}).friction[:, :2]
        columns = columns - base @ (base.T @ columns)
        left.append(np.sqrt(2 * lsq_linear(columns, misfit, bounds=bounds).cost))
    assert min(left) < 0.2 * np.linalg.norm(misfit)
