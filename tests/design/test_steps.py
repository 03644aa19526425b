"""Durations and payload changes, by other routes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.design.steps import (
    ACCELERATION,
    DWELL,
    RestStep,
    SeriesStep,
    payload_changes,
    round_trip,
)


@given(speed=st.floats(1.0, 300.0), stroke=st.floats(5.0, 360.0))
def test_a_round_trip_lasts_as_long_as_its_speed_profile(speed, stroke):
    """Integrated in small steps: accelerate, hold, brake so that the end is reached standing."""
    step, at, velocity, elapsed = 2e-4 * stroke / min(speed, 20.0), 0.0, 0.0, 0.0
    while at < stroke * (1 - 1e-6):
        braking = np.sqrt(2 * ACCELERATION * (stroke - at))
        velocity = min(velocity + ACCELERATION * step, speed, braking)
        at += velocity * step
        elapsed += step
        if elapsed > 2 * stroke / speed + 20.0:
            break
    assert round_trip(speed, stroke) / 2 - DWELL == pytest.approx(elapsed, rel=0.03, abs=0.03)


def test_payload_changes_are_where_the_payload_changes():
    def series(payload):
        return SeriesStep(speeds=(10.0,), low=0.0, high=50.0, payload=payload)

    steps = [series(None), series(5.0), RestStep(10.0), series(5.0), series(0.0), series(None)]
    assert list(payload_changes(steps, 0.0)) == [False, True, False, False, True, False]
