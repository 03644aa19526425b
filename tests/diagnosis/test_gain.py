"""The gain on a run: of the whole misfit, and apart from what is the same over the whole run."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.extension import extend
from frictioncli.diagnosis.fit.gain import gain_of, measured_gain
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem


def carried(rows):
    """Friction that grows with the load: an effect of the catalogue."""
    return 0.08 * np.abs(rows.load_torque)


def test_a_gain_apart_from_the_level_of_a_run_does_not_depend_on_it():
    """Friction is higher on the whole of a run, by more than the effect."""
    data = problem(3, friction=carried)
    fit = Step.of(Precomputed.of(data), []).fitted(BY_NAME["load_linear"], {})
    step = Step.of(Precomputed.of(data), [fit])
    extension = extend(data, step.predicting_fit(), [fit])

    def gain_at(level):
        plain = problem(4, friction=carried)
        other = replace(plain, friction=plain.friction + level)
        return measured_gain(other, extension, base=other, basis="new_run", floor=0.1, seed=0)

    plain, higher, lower = (gain_at(level) for level in (0.0, 9.0, -9.0))
    before, after = plain.without_level
    assert after < 0.9 * before
    for other in (higher, lower):
        assert other.without_level == pytest.approx((before, after))
    # with m the mean of the misfit, the mean squares are (m + 9)^2 and (m - 9)^2 above that
    both = (higher.after**2 + lower.after**2) / 2 - 9.0**2
    assert both == pytest.approx(plain.after**2)


@pytest.mark.parametrize("pairs", [6, 12, 20])
def test_the_gain_on_a_run_of_few_pairs_has_an_interval(pairs):
    """A weekly check has a dozen pairs: the gain differs from pair to pair."""
    data = problem(3)
    chosen = data.layout.row_pair < pairs
    part = data.part(chosen)
    generator = np.random.default_rng(0)
    before = np.square(generator.normal(1.0, 0.3, pairs))[part.layout.row_pair]
    after = np.square(generator.normal(0.4, 0.2, pairs))[part.layout.row_pair]
    gain = gain_of(part, before, after, basis="new_run", floor=0.1, seed=0)
    low, high = gain.interval
    assert low < gain.reduction < high
    assert 0.02 < high - low < 0.9
