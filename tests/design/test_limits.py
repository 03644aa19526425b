"""Limits of the motion and the options that set them."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.design.limits import Limits, limits_of
from frictioncli.design.settings import PlanSettings
from frictioncli.errors import OptionError


def torques(*, low=-40.0, high=80.0, speeds=(5.0, 50.0), warm=30.0):
    centres = np.arange(low + 2.5, high, 5.0)
    return pd.DataFrame(
        [
            {"position": centre, "speed": speed, "motor_temperature": warm}
            for speed in speeds
            for centre in centres
        ]
    )


def test_limits_are_those_of_the_data():
    found = limits_of(torques(), PlanSettings())
    assert (found.low, found.high) == (-40.0, 80.0)
    assert found.fastest == 50.0
    assert found.slowest == pytest.approx(50.0 / 60)  # slower moves endanger nothing
    assert found.hottest == 65.0
    assert limits_of(torques(warm=71.0), PlanSettings()).hottest == 71.0
    assert not found.beyond


def test_limits_beyond_the_data_are_said():
    asked = PlanSettings(low=-60.0, high=80.0, max_speed=75.0)
    found = limits_of(torques(), asked)
    assert (found.low, found.fastest) == (-60.0, 75.0)
    assert [text.split()[0] for text in found.beyond] == ["--from", "--max-speed"]


@pytest.mark.parametrize(
    "asked",
    [
        {"low": 50.0, "high": 50.0},
        {"low": 10.0, "high": -10.0},
        {"low": -361.0},
        {"high": 400.0},
        {"max_speed": 0.0},
        {"max_speed": 361.0},
        {"max_temperature": 120.0},
        {"minutes": 1.0},
        {"minutes": float("nan")},
        {"payload": (-1.0,)},
        {"to": "gcode"},
        {"to": "krl"},
        {"joint": 7},
    ],
)
def test_unsafe_or_senseless_options_are_refused(asked):
    with pytest.raises(OptionError):
        PlanSettings(**asked)


@pytest.mark.parametrize(
    "asked",
    [
        {"low": 75.0},  # five degrees are left
        {"rated_speed": 40.0},  # 50 deg/s were measured
    ],
)
def test_limits_that_contradict_the_data(asked):
    with pytest.raises(OptionError):
        limits_of(torques(), PlanSettings(**asked))


def test_the_highest_speed_may_be_below_all_that_were_measured():
    found = limits_of(torques(), PlanSettings(max_speed=2.0))
    assert found.slowest < found.fastest == 2.0


def test_the_fastest_of_a_series_has_room_to_hold_its_speed():
    """By hand: 90 deg at 200 deg/s² leave a third of the way at sqrt(200 * 60) = 109.5 deg/s."""
    limits = Limits(low=0.0, high=90.0, slowest=3.0, fastest=180.0, hottest=60.0)
    speeds = limits.speeds(4, slowest=9.0)
    assert len(speeds) == 4
    assert speeds[0] == pytest.approx(9.0, rel=0.01)
    assert speeds[-1] == pytest.approx(109.5, rel=0.01)
    assert np.diff(np.log(speeds)) == pytest.approx(np.log(109.5 / 9.0) / 3, rel=0.02)


@pytest.mark.parametrize("fastest", [1e-9, 0.4, float("nan")])
def test_a_highest_speed_that_no_program_can_state_is_refused(fastest):
    with pytest.raises(OptionError, match="highest speed"):
        Limits(low=0.0, high=90.0, slowest=1e-12, fastest=fastest, hottest=60.0)


def test_a_log_without_angles_tells_no_range_of_the_angle():
    with pytest.raises(OptionError, match="no position"):
        limits_of(torques(), PlanSettings(low=-90.0), angle_logged=False)
    found = limits_of(torques(), PlanSettings(low=-90.0, high=90.0), angle_logged=False)
    assert (found.low, found.high) == (-90.0, 90.0)
    assert all("not measured" in text for text in found.beyond)
    assert len(found.beyond) == 2
