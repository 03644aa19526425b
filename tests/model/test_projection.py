"""The global minimum, from the data alone, of few and of many equations."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.model.equations import COEFFICIENTS, Equations, jacobian, summarised
from frictioncli.model.friction import FrictionParameters
from frictioncli.model.variable_projection import DELTA_BOUNDS, minimise
from tests.studies.bench_fit import NAMES, SAME, minimum, observed
from tests.studies.minimum import compared, misfit, oracle, random_joint


def values(parameters):
    return np.array([getattr(parameters, name) for name in NAMES])


def plain(observations):
    """Return the equations of observations of equal weight."""
    temperature, speed, load, friction = observations
    return Equations(
        constant=np.ones_like(friction),
        squared_load=np.square(load),
        root_speed=np.sqrt(speed),
        temperature=temperature,
        friction=friction,
    )


@pytest.mark.parametrize(
    "seed",
    [
        *range(20_000, 20_005),
        *(pytest.param(seed, marks=pytest.mark.long) for seed in range(20_005, 20_050)),
    ],
)
def test_no_other_point_is_lower(seed):
    """Against a dense grid and many polished starts; ``tests.studies.minimum`` does 10,000."""
    *_, same = compared(seed)
    assert same


@pytest.mark.parametrize("seed", [1289, 4084, 5354, 7521])
def test_a_minimum_is_found_beyond_a_level_stretch(seed):
    """Without gamma the misfit is level over delta; it falls at the end of the range only."""
    *_, same = compared(seed)
    assert same


def test_many_equations_have_the_minimum_of_extended_precision():
    observations = observed(30_000)
    exact, error = minimum(observations)
    found = values(minimise(plain(observations), COEFFICIENTS))
    assert np.max(np.abs(found - exact) / error) < SAME


def test_many_exact_equations_give_the_truth():
    equations = plain(observed(5_000))
    truth = FrictionParameters(tau_c=4.0, alpha=0.002, beta=1.5, gamma=9.0, delta=0.03)
    modelled = jacobian(equations, COEFFICIENTS, truth)[:, :4] @ values(truth)[:4]
    found = minimise(replace(equations, friction=modelled), COEFFICIENTS)
    np.testing.assert_allclose(values(found), values(truth), rtol=1e-9)


@pytest.mark.parametrize(
    "truth",
    [
        {"tau_c": -3.0},
        {"alpha": -0.001},
        {"beta": -2.0},
        {"gamma": -5.0},
        {"beta": 0.0, "gamma": 0.0},
        {"delta": 0.5},
        {"delta": 1e-4},
    ],
    ids=str,
)
def test_many_equations_whose_minimum_is_at_a_bound(truth):
    """The best coefficient is zero, or delta at an end of its range."""
    equations = plain(observed(4_000))
    noise = np.random.default_rng(3).normal(0, 0.3, len(equations))
    law = {"tau_c": 10.0, "alpha": 0.001, "beta": 3.0, "gamma": 15.0, "delta": 0.05} | truth
    at = FrictionParameters(**law)
    modelled = jacobian(equations, COEFFICIENTS, at)[:, :4] @ values(at)[:4]
    bounded = replace(equations, friction=modelled + noise)
    found = values(minimise(bounded, COEFFICIENTS))
    assert (found >= 0).all()
    assert DELTA_BOUNDS[0] <= found[-1] <= DELTA_BOUNDS[1]
    assert misfit(bounded, found) <= oracle(bounded, 0) * (1 + 1e-9)


def test_some_terms_only():
    """Without gamma the fit is linear: the same as a plain solution by least squares."""
    equations = plain(observed(3_000))
    columns = np.column_stack([equations.constant, equations.root_speed])
    expected, *_ = np.linalg.lstsq(columns, equations.friction, rcond=None)
    found = minimise(equations, ("tau_c", "beta"))
    np.testing.assert_allclose([found.tau_c, found.beta], expected, rtol=1e-9)
    assert found.alpha == found.gamma == found.delta == 0.0


@settings(max_examples=50)
@given(
    seed=st.integers(0, 10**6),
    levels=st.integers(1, 6),
    at=st.tuples(
        st.floats(0, 30), st.floats(0, 0.01), st.floats(0, 9), st.floats(0, 40), st.floats(0, 0.3)
    ),
)
def test_a_summary_has_the_same_misfit_where_bins_have_one_temperature(seed, levels, at):
    """With a few whole degrees the summary is exact, for whatever parameters."""
    joint = random_joint(seed)
    degrees = np.random.default_rng(seed).choice(np.arange(levels) * 7.0 + 20, len(joint))
    joint = replace(joint, temperature=degrees)
    few = summarised(joint)
    assert len(few) <= levels + 3
    scale = float(joint.friction @ joint.friction)
    assert misfit(few, np.array(at)) == pytest.approx(misfit(joint, np.array(at)), abs=1e-9 * scale)


def test_a_summary_of_spread_temperatures_is_close():
    """Bins of 0.2 °C hide a part of the fall with temperature that is small beside the noise."""
    equations = plain(observed(50_000))
    few = summarised(equations)
    assert len(few) < 300
    exact, error = minimum(observed(50_000))
    assert np.max(np.abs(values(minimise(few, COEFFICIENTS)) - exact) / error) < 0.5
