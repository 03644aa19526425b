"""Moves of which packets were lost: what is left of them accelerates as the whole move did."""

import numpy as np
import pytest

from frictioncli.pairs.constant_speed import ConstantSpeedSegments, constant_speed_segments
from frictioncli.pairs.moves import directions, moves, running_sum
from frictioncli.pairs.settings import SteadySettings

_PERIOD = 0.01
_RAMP, _HOLD = 0.33, 0.97


def _velocity(time: np.ndarray) -> np.ndarray:
    corners = np.cumsum([0.5, _RAMP, _HOLD, _RAMP])
    return np.interp(time, corners, [0.0, 100.0, 100.0, 0.0])


def _segments(time: np.ndarray) -> ConstantSpeedSegments:
    velocity, settings = _velocity(time), SteadySettings()
    total = running_sum(velocity)
    found = moves(directions(total, 2, settings), time, _PERIOD)
    return constant_speed_segments(time, velocity, total, *found, settings)


@pytest.mark.parametrize("lost", [(0.84, 0.06), (0.95, 0.1), (1.5, 0.15), (1.74, 0.06)])
def test_pieces_of_a_move_settle_as_long_as_the_whole(lost: tuple[float, float]) -> None:
    whole = np.arange(0.0, 2.6, _PERIOD)
    for shift in range(10):
        begin = lost[0] + shift * _PERIOD
        time = whole[(whole < begin) | (whole > begin + lost[1])]
        found = _segments(time)
        used = np.concatenate([time[i:j] for i, j in zip(found.start, found.stop, strict=True)])
        assert used.min() >= 0.5 + _RAMP + SteadySettings().settling - _PERIOD
        assert used.max() <= 0.5 + _RAMP + _HOLD - 0.03 + 1e-9


def test_rests_that_are_not_logged_cut_nothing_off() -> None:
    """A rest left out of the log is a gap, too, but beside it the joint stands."""
    time = np.arange(0.0, 2.6, _PERIOD)
    moving = np.flatnonzero(_velocity(time) > 0)
    whole = _segments(time)
    without_rests = np.concatenate([[0.0], time[moving], [10.0]])
    alone = _segments(without_rests)
    assert alone.stop - alone.start == pytest.approx(whole.stop - whole.start)
    np.testing.assert_allclose(without_rests[alone.start], time[whole.start])
