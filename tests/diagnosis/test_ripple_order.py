"""The order of a ripple that also is the second harmonic of one of half its order."""

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem

RIPPLE = BY_NAME["position_ripple"]


def refined_from(order, waves, seed):
    """Return the ripple that is found from an order; waves: amplitude by order [N·m]."""

    def friction(rows):
        angle = np.radians(rows["position"])
        return sum(size * np.sin(own * angle + 0.7 * own) for own, size in waves.items())

    step = Step.of(Precomputed.of(problem(seed, friction)), [])
    first = EffectFit(RIPPLE, {"order": order}, np.zeros(4), np.zeros((4, 4)), 0.0)
    return step.refined(first)


@pytest.mark.parametrize("seed", range(3))
def test_a_single_wave_has_its_own_order_and_not_half_of_it(seed):
    found = refined_from(7.0, {14: 1.0}, seed)
    assert found.shape["order"] == pytest.approx(14.0, abs=0.1)
    assert np.hypot(*found.coefficients[:2]) == pytest.approx(1.0, abs=0.1)
    assert np.hypot(*found.coefficients[2:]) < 0.2


def test_two_waves_keep_the_lower_order():
    found = refined_from(7.0, {7: 0.6, 14: 1.0}, 0)
    assert found.shape["order"] == pytest.approx(7.0, abs=0.1)
    assert np.hypot(*found.coefficients[:2]) == pytest.approx(0.6, abs=0.1)
    assert np.hypot(*found.coefficients[2:]) == pytest.approx(1.0, abs=0.1)


def test_an_order_that_the_bins_do_not_resolve_is_not_doubled():
    """Twice 18 is beyond the orders of the catalogue."""
    found = refined_from(18.0, {18: 1.0}, 1)
    assert found.shape["order"] == pytest.approx(18.0, abs=0.1)
