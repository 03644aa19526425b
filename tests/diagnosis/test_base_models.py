"""The base model beside something hidden: what bends it must not be taken for a second cause."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.margin import margin_of
from frictioncli.diagnosis.search.standing import with_standing
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, EFFECTS
from tests.equation_16 import TRUTH, friction, torques

RATE = 6.0  # [N·m/h]


def warming(seed, *, speeds, hours, minutes, rise):
    """Return a run in which the motor warms while friction grows, as in the hours before."""
    time = np.arange(0.0, 60.0 * minutes, 240.0)
    temperature = 16.0 + rise * (1 - np.exp(-time / 2600.0))
    rows = torques(
        seed, temperatures=(temperature, time, np.full(len(time), "heat-up")), speeds=speeds
    )
    return rows.assign(
        friction_torque=rows["friction_torque"] + RATE * (hours + rows["time"] / 3600.0),
        housing_temperature=16.0 + 0.75 * (rows["motor_temperature"] - 16.0),
        load=np.nan,
    )


def grown_while_warmed(seed):
    """Return two days on which the joint warmed while friction grew by 7 N·m."""
    first = warming(2 * seed, speeds=(20.0, 40.0, 70.0, 101.0), hours=0.0, minutes=45, rise=33.0)
    speeds = (5.0, 9.0, 15.0, 22.0, 36.0, 58.0, 75.0, 93.0, 120.0, 151.0)
    second = warming(2 * seed + 1, speeds=speeds, hours=0.73, minutes=30, rise=16.0)
    rows = pd.concat([first.assign(run="day1"), second.assign(run="day2")], ignore_index=True)
    return build_problems(rows, "motor")[0]


def test_growth_hides_beta_from_the_fit_and_not_from_the_diagnosis():
    problem = grown_while_warmed(2)
    assert problem.parameters.beta == 0
    assert abs(problem.parameters.delta / TRUTH["delta"] - 1) > 0.3
    assert problem.names == ("tau_c", "alpha", "beta", "gamma", "delta")
    derivative = problem.friction_base[:, problem.names.index("beta")]
    np.testing.assert_array_equal(derivative, np.sqrt(problem.table.speed))


@pytest.mark.parametrize("size", [1.0, 6.0])
def test_a_ripple_hides_alpha_from_the_fit_and_not_from_the_diagnosis(size):
    """Friction by the square of the load would be another effect of the load, or a ripple."""
    rows = pd.concat(
        [torques(seed, load=20.0).assign(run=f"day{seed}", load=np.nan) for seed in (1, 2)],
        ignore_index=True,
    ).assign(housing_temperature=np.nan)
    rows["friction_torque"] += size * np.sin(np.radians(10.0 * rows["position"]))
    problem = build_problems(rows, "motor")[0]
    assert problem.parameters.alpha == 0
    derivative = problem.friction_base
    change = np.linalg.lstsq(derivative, problem.friction_misfit, rcond=None)[0]
    assert change[problem.names.index("alpha")] == pytest.approx(TRUTH["alpha"], rel=0.05)


@pytest.mark.parametrize(
    "seed", [2, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 4))]
)
def test_no_second_cause_is_named_for_what_the_first_one_hid(seed):
    problem, settings = grown_while_warmed(seed), DiagnosisSettings()
    margin = margin_of(problem, "N·m", settings)
    found = find_causes(problem, EFFECTS, settings, margin).causes
    (cause,) = with_standing(found, problem, margin, settings.alpha)
    assert cause.effects == ("drift",)
    # slow noise may do as much on days as short as these
    assert cause.standing in ("named", "undetermined")
    rate, hours = cause.fit.coefficients[0], cause.fit.shape["time_constant"]
    assert rate * hours * -np.expm1(-1.2 / hours) == pytest.approx(RATE * 1.2, rel=0.25)


@pytest.mark.parametrize("delay", [0.02, 0.06])
def test_a_late_torque_bends_no_base_model(delay):
    """Torques of both directions where the joint was that long before, by equation (16)."""
    rows = torques(3, point=0.05, pair=0.1, drift=0.1)
    angle, way = np.radians(rows["position"]), np.radians(rows["speed"]) * delay

    def logged(sign):
        load = 95.0 * np.cos(angle - sign * way)
        own = {"speed": rows["speed"], "temperature": rows["motor_temperature"]}
        exact = friction(TRUTH, load=load, **own)
        noise = rows["friction_torque"] - friction(TRUTH, load=rows["load_torque"], **own)
        return load + sign * (exact + noise)

    forward, reverse = logged(1), logged(-1)
    late = rows.assign(
        friction_torque=(forward - reverse) / 2, load_torque=(forward + reverse) / 2, load=np.nan
    )
    problem = build_problems(late, "motor")[0]
    assert problem.parameters.alpha == pytest.approx(TRUTH["alpha"], rel=0.04)
    # about the right one, delay and filter are what they are in the load alone, too
    smeared, shifted = (
        problem.basis(BY_NAME[name], {}).load for name in ("torque_filter", "torque_delay")
    )
    known = np.column_stack([problem.load_base, smeared, shifted])
    found = np.linalg.lstsq(known, problem.load, rcond=None)[0][-2:]
    assert found == pytest.approx([delay**2 / 2, delay], rel=0.1)
