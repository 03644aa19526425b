"""Bins in which a delayed or filtered torque still shows the start of the move."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.diagnosis.ramps.settling import settled, settling_time


def torques(speed):
    """Return the bins of one pair from 10 to 150 deg."""
    position = np.arange(10.0, 151.0, 5.0)
    return pd.DataFrame(
        {"run": "a", "joint": 1, "pair": 0, "position": position, "speed": float(speed)}
    )


@pytest.mark.parametrize("time_constant", [0.01, 0.04, 0.1])
def test_of_a_step_behind_a_first_order_filter_a_twentieth_is_left(time_constant):
    delay = 0.012
    wait = settling_time(shift=delay + time_constant, smear=time_constant**2)
    assert np.exp(-(wait - delay) / time_constant) == pytest.approx(0.05, rel=0.01)


def test_a_delay_alone_is_waited_for():
    assert settling_time(shift=0.012, smear=0.0) == 0.012


@pytest.mark.parametrize(("speed", "kept"), [(10.0, (15.0, 145.0)), (100.0, (25.0, 135.0))])
def test_bins_passed_before_the_time_in_either_direction_are_left_out(speed, kept):
    """In 0.13 s a joint at 100 deg/s covers 13 deg from either end."""
    rows = torques(speed)
    position = rows["position"][settled(rows, 0.13)]
    assert (position.min(), position.max()) == kept


@pytest.mark.parametrize(("seconds", "kept"), [(0.02, 4), (0.08, 2), (0.3, 0)])
def test_a_short_stroke_counts_on_the_time_after_the_acceleration(seconds, kept):
    """Of four bins both ends are the first of a direction, 0.11 s after it at 45 deg/s."""
    rows = torques(45.0).iloc[:4]
    assert settled(rows, seconds).sum() == kept


@pytest.mark.parametrize(("delay", "time_constant"), [(0.01, 0.0), (0.005, 0.01), (0.012, 0.04)])
def test_of_the_acceleration_the_outermost_bins_have_a_share_of_less_than_a_hundredth(
    delay, time_constant
):
    """Even where it ended 0.1 s before them and not 0.2 s: else they are left out."""
    rows = torques(20.0)
    wait = settling_time(shift=delay + time_constant, smear=time_constant**2)
    kept = settled(rows, wait)
    shares = [
        np.exp(-(0.1 - delay) / time_constant) if time_constant else float(delay > 0.1)
        for _ in rows.index[[0, -1]][kept[[0, -1]]]
    ]
    assert all(share < 0.01 for share in shares)
    # only a slow filter costs them
    assert kept.all() == (time_constant < 0.04)


def test_without_a_delay_nothing_is_left_out():
    assert settled(torques(200.0), 0.0).all()


def test_a_pair_too_fast_to_settle_within_its_stroke_is_left_out():
    assert not settled(torques(2000.0), 0.13).any()
