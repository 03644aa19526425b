"""The change since the runs before, against shifts that were put in."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.comparison.change import change_of_last_run
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings

ANGLES = np.array([-40.0, -20.0, 0.0, 20.0, 40.0])
SPEEDS = (20.0, 45.0, 90.0)


def torques(
    shifts, *, seed=0, pair_noise=0.1, point_noise=0.2, temperatures=None, names="d{}", proportion=0
):
    """Rows of torques of equation (16), each run shifted by so much. [N·m]."""
    generator = np.random.default_rng(seed)
    rows = []
    for run, shift in enumerate(shifts):
        warmth = np.linspace(22, 48, 8) if temperatures is None else temperatures[run]
        for place, temperature in enumerate(warmth):
            for number, speed in enumerate(SPEEDS):
                load = 80 * np.cos(np.radians(ANGLES))
                viscous = 3 + 15 * np.exp(-0.05 * temperature)
                friction = (10 + 0.0014 * load**2 + viscous * np.sqrt(speed)) * (1 + proportion)
                friction = friction + shift + pair_noise * generator.standard_normal()
                friction = friction + point_noise * generator.standard_normal(len(ANGLES))
                rows.append(
                    pd.DataFrame(
                        {
                            "run": names.format(run + 1),
                            "joint": 2,
                            "pair": 3 * place + number,
                            "speed": speed,
                            "time": 600.0 * place + 20 * number,
                            "phase": "heat-up",
                            "motor_temperature": temperature,
                            "housing_temperature": np.nan,
                            "position": ANGLES,
                            "friction_torque": friction,
                            "load_torque": load,
                        }
                    )
                )
    return pd.concat(rows, ignore_index=True)


def change(table):
    model = fit_joint(table, {}, FitSettings())
    return change_of_last_run(table, model)


def test_a_shift_of_the_last_run_is_found_with_its_size():
    found = change(torques([0, 0, 0, 0, 0, 1.5]))
    assert found.ci95[0] < 1.5 < found.ci95[1]
    assert found.ci95[1] - found.ci95[0] < 0.4


def test_with_one_earlier_run_the_noise_within_the_two_is_the_measure():
    found = change(torques([0, 1.5]))
    # 24 pairs each, whose means spread by sqrt(0.1² + 0.2²/5) N·m
    least = 1.96 * np.sqrt(2 * (0.1**2 + 0.2**2 / 5) / 24)
    assert found.ci95[0] < 1.5 < found.ci95[1]
    assert 0.7 * least < (found.ci95[1] - found.ci95[0]) / 2 < 3 * least


def test_without_noise_it_is_the_shift_less_the_mean_of_the_others():
    found = change(torques([0.3, 0.6, 0.9, -1.4], pair_noise=0, point_noise=1e-4))
    assert found.estimate == pytest.approx(-1.4 - 0.6, abs=1e-3)
    # the mean of all four is 0.1
    assert found.by_run == pytest.approx([0.2, 0.5, 0.8, -1.5], abs=1e-3)


def test_other_temperatures_on_the_last_day_are_no_change():
    winter, summer = np.linspace(18, 40, 8), np.linspace(30, 55, 8)
    found = change(torques([0, 0, 0], temperatures=[winter, winter, summer], seed=4))
    assert found.ci95[0] < 0 < found.ci95[1]


def test_earlier_runs_that_differ_widen_the_interval():
    quiet = change(torques([0, 0, 0, 0, 0], seed=1))
    restless = change(torques([0, 1, -1, 0.5, 0], seed=1))
    # standard deviation 0.85 of the earlier four, t with 3 degrees of freedom, one run against four
    expected = 3.18 * np.std([0, 1, -1, 0.5], ddof=1) * np.sqrt(1 + 1 / 4)
    assert quiet.ci95[1] - quiet.ci95[0] < 0.4
    assert (restless.ci95[1] - restless.ci95[0]) / 2 == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("earlier", [pytest.param(one, marks=pytest.mark.long) for one in (2, 5)])
def test_intervals_hold_the_truth_as_often_as_they_say(earlier):
    generator = np.random.default_rng(11)
    held = 0
    for seed in range(12):
        shifts = 0.3 * generator.standard_normal(earlier + 1)
        shifts[-1] += 1.0
        found = change(torques(shifts, seed=100 + seed))
        held += found.ci95[0] < 1.0 < found.ci95[1]
    assert held >= 10  # of 12 at 95 %: fewer has a chance of 1 in 50


def test_the_last_run_is_the_last_in_natural_order():
    table = torques([0, 0, 0, 0, 0, 0, 0, 0, 0, 2.0])
    assert change(table).estimate == pytest.approx(2.0, abs=0.2)


def test_one_run_has_no_run_before():
    assert change(torques([0.0])) is None


def test_runs_that_share_no_temperature_cannot_be_compared():
    """A shift and the fall with temperature are the same thing there."""
    table = torques([0, 0, 0], temperatures=[np.full(8, 20.0), np.full(8, 20.0), np.full(8, 45.0)])
    one_speed = table[table["speed"] == 45.0]
    model = fit_joint(table, {}, FitSettings())
    assert model.parameters["gamma"].ci95 is not None
    assert change_of_last_run(one_speed, model) is None
