"""The response behind which torque was logged, from ripples that are sampled, filtered, shifted."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from frictioncli.diagnosis.data.late_torque import LateTorque
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.late_ripple import shown_by_ripple
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_late_torque import PERIOD

DELAY, FILTER = 0.012, 0.04


def logged_ripple(rows, order: float) -> dict[int, np.ndarray]:
    """Return a ripple of friction of 1.5 N·m as each row logs it forward and in reverse."""
    found = {way: np.zeros(len(rows)) for way in (1, -1)}
    for speed, own in rows.groupby("speed"):
        reach = 10 * FILTER * speed
        time = np.arange(0.0, (360.0 + 2 * reach) / speed, PERIOD)
        for way, values in found.items():
            angle = -reach + speed * time if way > 0 else 360.0 + reach - speed * time
            samples = 1.5 * way * np.sin(order * np.radians(angle) + 0.7)
            memory = np.exp(-PERIOD / FILTER)
            start = [memory * samples[0]]
            samples = lfilter([1 - memory], [1, -memory], samples, zi=start)[0]
            samples = np.interp(time - DELAY, time, samples)
            values[rows.index.get_indexer(own.index)] = np.interp(
                own["position"], angle[::way], samples[::way]
            )
    return found


def step_with_ripple(order: float, late: LateTorque | None) -> Step:
    """Return the step at which a ripple is accepted, behind a response that is believed."""

    def friction(rows):
        both = logged_ripple(rows, order)
        return (both[1] - both[-1]) / 2

    def load(rows):
        both = logged_ripple(rows, order)
        return (both[1] + both[-1]) / 2

    data = replace(problem(3, friction, load), late=late)
    ripple = EffectFit(
        BY_NAME["position_ripple"], {"order": order}, np.zeros(4), np.zeros((4, 4)), 0.0
    )
    return Step.of(Precomputed.of(data), [ripple])


def test_a_fast_ripple_tells_the_filter_from_the_delay():
    late = shown_by_ripple(step_with_ripple(15.0, LateTorque(delay=0.045)), [])
    assert late.delay == pytest.approx(DELAY + FILTER, abs=0.003)
    assert late.variance**0.5 == pytest.approx(FILTER, rel=0.1)


def test_a_response_that_is_right_stays():
    true = LateTorque(delay=DELAY + FILTER, variance=FILTER**2)
    assert shown_by_ripple(step_with_ripple(15.0, true), []) is None


def test_a_slow_ripple_tells_nothing():
    assert shown_by_ripple(step_with_ripple(4.0, LateTorque(delay=0.03)), []) is None
    assert shown_by_ripple(step_with_ripple(15.0, None), []) is None
