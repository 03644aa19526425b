"""The amplitude that one more random function starts with, beside the restricted likelihood."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.added_function import likely_amplitudes
from frictioncli.diagnosis.fit.mixed_model import evaluate
from frictioncli.diagnosis.fit.products import Products
from frictioncli.diagnosis.fit.transformed_columns import TransformedColumns
from tests.diagnosis.test_variance_components import (
    BASE,
    COUNT,
    DEVIATIONS,
    PRIOR,
    WIDTHS,
    World,
    variances,
)

KNOWN = BASE + sum(WIDTHS)


@pytest.mark.parametrize("scale", [0.2, 1.0, 30.0])
def test_amplitude_is_where_the_likelihood_is_greatest_with_all_other_components_held(scale):
    world, generator = World(5), np.random.default_rng(8)
    own = [
        (scale * generator.normal(size=(DEVIATIONS, 3)), scale * generator.normal(size=(COUNT, 3)))
        for _ in range(2)
    ]
    parts = world.transformed.parts
    products = Products.of(TransformedColumns((parts[0], world._part(own), parts[1])))
    beside = world.components.beside_function(slice(KNOWN, KNOWN + 3), PRIOR)
    start = variances(world, np.random.default_rng(3))
    without = evaluate(world.components, world.products, KNOWN, start)

    def cost(amplitude):
        every = np.append(start.amplitude, amplitude)
        return evaluate(beside, products, KNOWN + 3, replace(start, amplitude=every)).objective

    tried = PRIOR + np.linspace(-6, 6, 601)
    costs = [cost(one) for one in tried]
    best = tried[int(np.argmin(costs))]
    if cost(PRIOR) < min(costs) + 2:
        best = PRIOR
    (found,) = likely_amplitudes(beside, products, [without])
    assert found == pytest.approx(best, abs=0.04)
