"""Noncentralities of rivals, against dense linear algebra."""

import numpy as np
import pytest

from frictioncli.design.decision_probability import (
    decision_probability,
    rule_out_probabilities,
)
from frictioncli.design.discrimination import discrimination_of, tried_shapes
from frictioncli.design.information import Information
from frictioncli.design.rivals import Question, Rival
from frictioncli.diagnosis.fit.columns import base_rows
from tests.design.examples import NOISE, discrimination_in_rows, few_pairs, fit


@pytest.fixture(scope="module")
def problem():
    return few_pairs()


def dense(problem, noise):
    """Covariance of all rows of one channel: white, shared by a pair, and drift."""
    pair = problem.layout.row_pair
    time = problem.layout.time[pair]
    same = pair[:, np.newaxis] == pair
    drift = np.exp(-np.abs(time[:, np.newaxis] - time) / noise.drift_time)
    return noise.point**2 * np.eye(len(pair)) + noise.pair**2 * same + noise.drift**2 * drift


def test_noncentrality_is_what_generalised_least_squares_leaves(problem):
    drift = fit("drift", {"time_constant": 200.0}, 1.5)
    warm = fit("coulomb_temperature", {}, -0.1)
    question = Question((Rival(drift, 0.0), Rival(warm, 0.0)))
    found = discrimination_of(
        Information(problem, NOISE, problem.all_runs), question, ()
    ).noncentrality[0]
    base = base_rows(problem)

    def left(signal, rival, shapes):
        """The likelihoods' mean over shapes, as a length."""
        found = []
        for shape in shapes:
            basis = problem.basis(rival, shape)
            total_, design_ = [], []
            for channel in (0, 1):
                root = np.linalg.cholesky(np.linalg.inv(dense(problem, NOISE[channel])))
                design_.append(root.T @ np.hstack([base[channel], basis[channel]]))
                total_.append(root.T @ signal[channel])
            design, target = np.vstack(design_), np.concatenate(total_)
            size = np.linalg.norm(design, axis=0)
            design = design[:, size > 1e-12] / size[size > 1e-12]
            rest = target - design @ np.linalg.lstsq(design, target, rcond=1e-11)[0]
            found.append(float(rest @ rest))
        return -2 * np.log(np.mean(np.exp(-np.array(found) / 2)))

    for i, j in ((0, 0), (0, 1), (1, 0)):
        own, other = question.rivals[i].fit, question.rivals[j].fit
        basis = problem.basis(own.effect, own.shape)
        signal = [part @ own.coefficients for part in basis]
        shapes = [other.shape, *other.effect.shapes(problem.all_runs)]
        # pooling neighbours loses a little of what differs inside pairs
        assert found[i, j] == pytest.approx(left(signal, other.effect, shapes), rel=0.03)
    assert found[1, 1] == pytest.approx(0.0, abs=1e-6)  # it has one shape, and is at work
    for i in (0, 1):  # the base alone leaves more than any rival beside it
        assert found[i, 2] >= max(found[i, :2])


def test_confounders_must_be_ruled_out_too(problem):
    """Two identical effects can never be told apart, whether both are open or one is not yet."""
    drift = Rival(fit("drift", {"time_constant": 200.0}, 1.5), 0.0)
    warm = Rival(fit("coulomb_temperature", {}, -0.1), 0.0)
    information = Information(problem, NOISE, problem.all_runs)
    whole = discrimination_of(information, Question((drift, warm), (drift,)), ()).noncentrality[0]
    assert whole.shape == (2, 4)
    assert whole[:, 2] == pytest.approx(whole[:, 0])
    asked = Question((drift, warm), (drift,))
    chance = rule_out_probabilities(
        asked, discrimination_in_rows(np.zeros_like(whole)), discrimination_in_rows(1e6 * whole)
    )
    assert chance[0, 2] == pytest.approx(0.0, abs=0.05)
    assert decision_probability(asked, chance) < 0.55


def test_moments_stay_where_they_were_when_rows_are_added(problem):
    """A change half-way through the rows at hand is one at a quarter of twice as many."""
    step = fit("step_change", {"moment": 0.5}, 1.0)
    information = Information(problem, NOISE, problem.all_runs, observed_share=0.5)
    shapes = [shape["moment"] for shape in tried_shapes(step, information)]
    assert shapes[0] == 0.25
    assert 0.5 in shapes  # between the rows at hand and those to come
