"""A temperature that is no longer read, told from one that is steady."""

import numpy as np
import pytest

from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.model.stuck_reading import is_stuck
from tests.diagnosis.clean_joints import clean_days
from tests.equation_16 import TRUTH

TIME = 240.0 * np.arange(60)
WARMING = 25.0 + 25.0 * -np.expm1(-TIME / 3000.0)


def test_a_reading_that_keeps_its_value_and_then_jumps_is_stuck():
    reading = WARMING.round(1)
    reading[10:20] = reading[10]
    assert np.flatnonzero(is_stuck(TIME, reading)).tolist() == list(range(10, 20))


@pytest.mark.parametrize("step", [0.1, 0.5, 1.0, 2.0])
def test_a_coarse_reading_is_not(step):
    assert not is_stuck(TIME, np.round(WARMING / step) * step).any()


def test_nor_is_one_that_falls_in_a_pause_or_never_changes():
    time, reading = TIME.copy(), np.round(WARMING)
    time[45:] += 3600.0
    reading[45:] = 31.0
    assert reading[40] == reading[44]
    assert not is_stuck(time, reading).any()
    assert not is_stuck(TIME, np.full(60, 25.0)).any()


def test_neither_are_pairs_without_a_reading():
    reading = WARMING.round(1)
    reading[10:20] = np.nan
    assert not is_stuck(TIME, reading).any()
    assert not is_stuck(TIME, np.full(60, np.nan)).any()


def test_pairs_with_a_stuck_reading_do_not_bias_the_fit():
    torques = clean_days(2)
    of_pair = torques.groupby(["run", "pair"])["time"].first().loc["day1"]
    stuck = (torques["run"] == "day1") & torques["time"].between(*of_pair.quantile([0.55, 0.8]))
    known = fit_joint(torques[~stuck], {}, FitSettings())
    for column in ("motor_temperature", "motor_temperature_reading"):
        torques.loc[stuck, column] = torques.loc[stuck, column].iloc[0]
    found = fit_joint(torques, {}, FitSettings())
    count = torques[stuck].groupby("pair").ngroups
    assert next(one for one in found.notes if "stood still" in one).startswith(str(count))
    assert found.parameters["delta"].estimate == pytest.approx(known.parameters["delta"].estimate)
    assert found.parameters["delta"].estimate == pytest.approx(TRUTH["delta"], rel=0.1)
