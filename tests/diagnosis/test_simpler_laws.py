"""Causes that another law explains as well: misread torque, a kink, and how fast a joint warms."""

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.simpler_laws import simpler_law
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from tests.diagnosis.clean_joints import clean_days
from tests.diagnosis.dense_noise import problem
from tests.equation_16 import SPEEDS


def found_in(torques):
    found = diagnose_joint(torques, "motor", "N·m", DiagnosisSettings())
    return {one.fit.effect.name for one in found.causes if not one.fit.effect.measurement}


def warming(torques, time_constant):
    """Return by how much each pair is above its mean temperature of the last minutes [°C]."""
    of_pair = torques.groupby(["run", "pair"], sort=False)[["time", "motor_temperature"]].first()
    ahead = []
    for _, run in of_pair.groupby(level="run", sort=False):
        clock = np.arange(run["time"].iloc[0], run["time"].iloc[-1] + 2.0)
        temperature = np.interp(clock, run["time"], run["motor_temperature"])
        mean = temperature.copy()
        for now in range(1, len(clock)):
            mean[now] += (mean[now - 1] - mean[now]) * np.exp(-1.0 / time_constant)
        ahead.append(np.interp(run["time"], clock, temperature - mean))
    return np.repeat(np.concatenate(ahead), torques.groupby(["run", "pair"], sort=False).size())


@pytest.mark.long
def test_friction_that_follows_how_fast_the_joint_warms_is_no_step():
    """Steps as the joint turns to cool down, on every day, would fit it in part."""
    torques = clean_days(1, days=3, noise=0.1, pair=0.05, drift=0.05)
    torques["friction_torque"] += 0.6 * warming(torques, 900.0)
    found = diagnose_joint(torques, "motor", "N·m", DiagnosisSettings())
    (step,) = [one for one in found.visible if one.effects == ("step_change",)]
    assert step.reason.startswith("it comes as the joint turns from warming up to cooling down")
    assert found.causes == ()


@pytest.mark.long
def test_a_step_as_the_joint_turns_to_cool_down_keeps_its_name():
    torques = clean_days(1, days=3, noise=0.1, pair=0.05, drift=0.05)
    torques.loc[torques["phase"] == "cool-down", "friction_torque"] += 2.0
    assert found_in(torques) == {"step_change"}


def misread(torques, share, power):
    """Return the torques as a motor shows them that needs more current at high torque."""
    ways = torques[["torque_forward", "torque_reverse"]].to_numpy()
    ways = ways * (1.0 + share * np.abs(ways / np.abs(ways).max()) ** power)
    return torques.assign(
        torque_forward=ways[:, 0],
        torque_reverse=ways[:, 1],
        friction_torque=(ways[:, 0] - ways[:, 1]) / 2,
        load_torque=(ways[:, 0] + ways[:, 1]) / 2,
    )


@pytest.mark.parametrize("power", [1, 2])
def test_torque_that_is_misread_when_it_is_high_is_no_asymmetry(power):
    torques = clean_days(4, noise=0.1, pair=0.05, drift=0.05)
    named = found_in(misread(torques[torques["position"] < 80.0], 0.06, power))
    assert named.isdisjoint({"direction_asymmetry", "dress_pack"})


def test_an_asymmetry_keeps_its_name():
    torques = clean_days(4, noise=0.1, pair=0.05, drift=0.05)
    torques["load_torque"] += 4.0 * np.sqrt(torques["speed"] / max(SPEEDS))
    assert found_in(torques) == {"direction_asymmetry"}


RIPPLE = BY_NAME["position_ripple"]


def fitted_ripple(friction):
    """Return the ripple of at most three periods in the stroke that fits best, and its joint."""
    joint = problem(3, friction=friction)
    step = Step.of(Precomputed.of(joint), [])
    stroke = float(np.ptp(joint.table.position))
    fits = [step.fitted(RIPPLE, {"order": 360.0 * n / stroke}) for n in (1.6, 1.9, 2.2, 2.6, 2.9)]
    return max(fits, key=lambda one: one.statistic), joint


def test_a_ripple_of_two_periods_that_a_kink_at_zero_load_explains_is_none():
    ripple, joint = fitted_ripple(lambda rows: 0.15 * np.abs(rows.load_torque))
    assert "kink at zero load" in simpler_law(ripple, joint)


def test_a_ripple_of_few_periods_that_is_one_is_no_kink():
    ripple, joint = fitted_ripple(lambda rows: 1.5 * np.sin(np.radians(6.5 * rows.position + 40)))
    assert simpler_law(ripple, joint) == ""
