"""Probabilities of decisions, against drawn likelihood ratios."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.design.decision_probability import (
    DECISIVE_LOG_ODDS,
    decision_probability,
    log_odds_margins,
    rule_out_probabilities,
)
from frictioncli.design.rivals import Question, Rival
from tests.design.examples import discrimination_in_rows, fit


def test_probabilities_are_those_of_drawn_likelihood_ratios():
    """The evidence of two known signals in white noise of known size, many times."""
    generator = np.random.default_rng(5)
    rows, start = 4000, 1.2
    signal = generator.standard_normal(rows) * 0.06
    noise = generator.standard_normal((3000, rows))
    # A against nothing: log ratio of signal + noise
    ratio = noise @ signal + signal @ signal / 2
    drawn = float(np.mean(start + ratio > DECISIVE_LOG_ODDS))
    rival = Rival(fit("drift", {"time_constant": 200.0}, 1.0), start)
    other = Rival(fit("coulomb_temperature", {}, 1.0), 0.0)
    question = Question((rival, other))
    after = np.array([[0.0, signal @ signal, 0.0], [0.0, 0.0, 0.0]])
    found = rule_out_probabilities(
        question, discrimination_in_rows(np.zeros((2, 3))), discrimination_in_rows(after)
    )
    assert found[0, 1] == pytest.approx(drawn, abs=0.03)
    assert found[0, 0] == 1.0


def test_a_noise_of_unknown_size_weakens_the_evidence():
    """The log ratio of residual squares of two fits, many times."""
    question = Question(
        (
            Rival(fit("drift", {"time_constant": 200.0}, 1.0), 0.0),
            Rival(fit("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    generator = np.random.default_rng(9)
    for pairs, length in ((40, 12.0), (40, 60.0), (300, 20.0)):
        noise = generator.standard_normal((20000, pairs))
        signal = np.full(pairs, np.sqrt(length / pairs))
        squares = [np.sum(np.square(rest), axis=1) for rest in (noise + signal, noise)]
        odds = pairs / 2 * np.log(squares[0] / squares[1])
        after = np.array([[0.0, length, 1e9], [length, 0.0, 1e9]])
        found = rule_out_probabilities(
            question,
            discrimination_in_rows(np.zeros((2, 3)), pairs),
            discrimination_in_rows(after, pairs),
        )
        assert found[0, 1] == pytest.approx(np.mean(odds > DECISIVE_LOG_ODDS), abs=0.03)
        assert decision_probability(question, found) == pytest.approx(found[0, 1])


def test_an_uncertain_size_makes_decisions_less_certain():
    """Against sizes drawn from their own distribution, many times."""
    generator = np.random.default_rng(8)
    statistic, added = 16.0, 30.0
    size = np.maximum(1 + generator.standard_normal(200000) / np.sqrt(statistic), 0.0)
    shift = size**2 * added
    odds = shift / 2 + np.sqrt(shift) * generator.standard_normal(len(size))
    one = replace(fit("drift", {"time_constant": 200.0}, 1.0), statistic=statistic)
    question = Question((Rival(one, 0.0), Rival(fit("coulomb_temperature", {}, 1.0), 0.0)))
    after = np.array([[0.0, added, 1e9], [added, 0.0, 1e9]])
    found = rule_out_probabilities(
        question, discrimination_in_rows(np.zeros((2, 3))), discrimination_in_rows(after)
    )
    assert found[0, 1] == pytest.approx(np.mean(odds > DECISIVE_LOG_ODDS), abs=0.02)
    assert found[1, 0] > found[0, 1]  # the other's size is known


def test_a_cause_whose_shape_is_found_late_gains_less():
    """A rival that new rows force to one of eight shapes loses the others: log 8 of its odds."""
    question = Question(
        (
            Rival(fit("drift", {"time_constant": 200.0}, 1.0), 0.0),
            Rival(fit("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    own = 2 * np.log(8)
    before = np.zeros((2, 3))
    after = np.array([[own, 20.0, 1e9], [20.0, 0.0, 1e9]])
    found = log_odds_margins(
        question, discrimination_in_rows(before), discrimination_in_rows(after), bound=15.0
    )
    late, early = (20.0 - own) / 2 - DECISIVE_LOG_ODDS, 10.0 - DECISIVE_LOG_ODDS
    assert found == pytest.approx([(late + 15.0) / 2, (early + 15.0) / 2], abs=1e-3)


def test_without_new_rows_nothing_is_decided():
    question = Question(
        (
            Rival(fit("drift", {"time_constant": 200.0}, 1.0), 1.0),
            Rival(fit("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    same = discrimination_in_rows(np.full((2, 3), 12.0), 50)
    assert decision_probability(
        question, rule_out_probabilities(question, same, same)
    ) == pytest.approx(0.0, abs=1e-6)
