"""What a programme is worth, against dense linear algebra and drawn noise."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.design.d_optimality import log_determinant
from frictioncli.design.decision_probability import NAMED, chances, decided, margins
from frictioncli.design.discrimination import Discrimination, discriminations, tried_shapes
from frictioncli.design.expected_evidence import Noises
from frictioncli.design.information import Information
from frictioncli.design.rivals import Question, Rival
from frictioncli.diagnosis.data.problem import build_problems
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.judgement import Score
from frictioncli.effects import BY_NAME
from frictioncli.model.noise import Noise
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.motion_programme import MeasuredMoves, UnrecordedMoves, simulate_programmes

NOISE = (
    Noise(point=0.3, pair=0.2, drift=0.4, drift_time=900.0),
    Noise(point=0.25, pair=0.1, drift=0.2, drift_time=700.0),
)


@pytest.fixture(scope="module")
def problem():
    """Few pairs, so that dense covariance matrices stay small."""
    series = MeasuredMoves(speeds=(30.0, 90.0), low=0.0, high=90.0)
    heat = UnrecordedMoves(speed=90.0, low=0.0, high=90.0, seconds=300.0)
    (table,) = simulate_programmes(
        SynthesisSettings(seed=3, joint_kind="plain"), [[series, heat] * 6], 1
    )
    return replace(build_problems(table, "motor")[0], temperature_error=0.0)


def score(name, shape, *coefficients):
    """An effect so clear that noise adds nothing to its size."""
    return Score(BY_NAME[name], shape, np.array(coefficients), np.zeros((0, 0)), 1e12)


def in_rows(left, pairs=10**9):
    """Noncentralities in rows whose noise is known but for its scale."""
    alone = Noises(
        friction=NOISE[:1],
        square=np.array([float(pairs)]),
        determinant=np.zeros(1),
        freedom=pairs,
    )
    return Discrimination(left[np.newaxis], alone)


def dense(problem, noise):
    """Covariance of all rows of one channel: white, shared by a pair, and drift."""
    pair = problem.layout.row_pair
    time = problem.layout.time[pair]
    same = pair[:, np.newaxis] == pair
    drift = np.exp(-np.abs(time[:, np.newaxis] - time) / noise.drift_time)
    return noise.point**2 * np.eye(len(pair)) + noise.pair**2 * same + noise.drift**2 * drift


def test_noncentrality_is_what_generalised_least_squares_leaves(problem):
    drift = score("drift", {"time_constant": 200.0}, 1.5)
    warm = score("coulomb_temperature", {}, -0.1)
    question = Question((Rival(drift, 0.0), Rival(warm, 0.0)))
    found = discriminations(Information(problem, NOISE, problem.whole), question, ()).left[0]
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
        own, other = question.rivals[i].score, question.rivals[j].score
        basis = problem.basis(own.effect, own.shape)
        signal = [part @ own.coefficients for part in basis]
        shapes = [other.shape, *other.effect.shapes(problem.whole)]
        # pooling neighbours loses a little of what differs inside pairs
        assert found[i, j] == pytest.approx(left(signal, other.effect, shapes), rel=0.03)
    assert found[1, 1] == pytest.approx(0.0, abs=1e-6)  # it has one shape, and is at work
    for i in (0, 1):  # the base alone leaves more than any rival beside it
        assert found[i, 2] >= max(found[i, :2])


def test_chances_are_those_of_drawn_likelihood_ratios():
    """The evidence of two known signals in white noise of known size, many times."""
    generator = np.random.default_rng(5)
    rows, start = 4000, 1.2
    signal = generator.standard_normal(rows) * 0.06
    noise = generator.standard_normal((3000, rows))
    # A against nothing: log ratio of signal + noise
    ratio = noise @ signal + signal @ signal / 2
    drawn = float(np.mean(start + ratio > NAMED))
    rival = Rival(score("drift", {"time_constant": 200.0}, 1.0), start)
    other = Rival(score("coulomb_temperature", {}, 1.0), 0.0)
    question = Question((rival, other))
    after = np.array([[0.0, signal @ signal, 0.0], [0.0, 0.0, 0.0]])
    found = chances(question, in_rows(np.zeros((2, 3))), in_rows(after))
    assert found[0, 1] == pytest.approx(drawn, abs=0.03)
    assert found[0, 0] == 1.0


def test_a_noise_of_unknown_size_takes_part_of_what_a_rival_leaves():
    """The log ratio of residual squares of two fits, many times."""
    question = Question(
        (
            Rival(score("drift", {"time_constant": 200.0}, 1.0), 0.0),
            Rival(score("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    generator = np.random.default_rng(9)
    for pairs, length in ((40, 12.0), (40, 60.0), (300, 20.0)):
        noise = generator.standard_normal((20000, pairs))
        signal = np.full(pairs, np.sqrt(length / pairs))
        squares = [np.sum(np.square(rest), axis=1) for rest in (noise + signal, noise)]
        odds = pairs / 2 * np.log(squares[0] / squares[1])
        after = np.array([[0.0, length, 1e9], [length, 0.0, 1e9]])
        found = chances(question, in_rows(np.zeros((2, 3)), pairs), in_rows(after, pairs))
        assert found[0, 1] == pytest.approx(np.mean(odds > NAMED), abs=0.03)
        assert decided(question, found) == pytest.approx(found[0, 1])


def test_a_size_that_is_not_sure_makes_names_less_sure():
    """Against sizes drawn from their own distribution, many times."""
    generator = np.random.default_rng(8)
    statistic, added = 16.0, 30.0
    size = np.maximum(1 + generator.standard_normal(200000) / np.sqrt(statistic), 0.0)
    shift = size**2 * added
    odds = shift / 2 + np.sqrt(shift) * generator.standard_normal(len(size))
    one = replace(score("drift", {"time_constant": 200.0}, 1.0), statistic=statistic)
    question = Question((Rival(one, 0.0), Rival(score("coulomb_temperature", {}, 1.0), 0.0)))
    after = np.array([[0.0, added, 1e9], [added, 0.0, 1e9]])
    found = chances(question, in_rows(np.zeros((2, 3))), in_rows(after))
    assert found[0, 1] == pytest.approx(np.mean(odds > NAMED), abs=0.02)
    assert found[1, 0] > found[0, 1]  # the other's size is known


def test_what_finds_its_own_shape_late_gains_less():
    """A rival that new rows force to one of eight shapes loses the others: log 8 of its odds."""
    question = Question(
        (
            Rival(score("drift", {"time_constant": 200.0}, 1.0), 0.0),
            Rival(score("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    own = 2 * np.log(8)
    before = np.zeros((2, 3))
    after = np.array([[own, 20.0, 1e9], [20.0, 0.0, 1e9]])
    found = margins(question, in_rows(before), in_rows(after), enough=15.0)
    late, early = (20.0 - own) / 2 - NAMED, 10.0 - NAMED
    assert found == pytest.approx([(late + 15.0) / 2, (early + 15.0) / 2], abs=1e-3)


def test_what_a_rival_may_be_taken_for_must_be_left_behind_too(problem):
    """Two identical effects can never be told apart, whether both are open or one is not yet."""
    drift = Rival(score("drift", {"time_constant": 200.0}, 1.5), 0.0)
    warm = Rival(score("coulomb_temperature", {}, -0.1), 0.0)
    sight = Information(problem, NOISE, problem.whole)
    whole = discriminations(sight, Question((drift, warm), (drift,)), ()).left[0]
    assert whole.shape == (2, 4)
    assert whole[:, 2] == pytest.approx(whole[:, 0])
    asked = Question((drift, warm), (drift,))
    chance = chances(asked, in_rows(np.zeros_like(whole)), in_rows(1e6 * whole))
    assert chance[0, 2] == pytest.approx(0.0, abs=0.05)
    assert decided(asked, chance) < 0.55


def test_moments_stay_where_they_were_when_rows_are_added(problem):
    """A change half-way through the rows at hand is one at a quarter of twice as many."""
    step = score("step_change", {"moment": 0.5}, 1.0)
    sight = Information(problem, NOISE, problem.whole, at_hand=0.5)
    shapes = [shape["moment"] for shape in tried_shapes(step, sight)]
    assert shapes[0] == 0.25
    assert 0.5 in shapes  # between the rows at hand and those to come


def test_without_new_rows_nothing_is_decided():
    question = Question(
        (
            Rival(score("drift", {"time_constant": 200.0}, 1.0), 1.0),
            Rival(score("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    same = in_rows(np.full((2, 3), 12.0), 50)
    assert decided(question, chances(question, same, same)) == pytest.approx(0.0, abs=1e-6)


def test_rows_spread_by_the_determinant_of_a_quadratic(problem):
    """By hand: inputs of a table, scaled to -1 ... 1, with squares and products."""
    table = problem.table
    half = type(table)(
        **{name: getattr(table, name)[table.time < 600.0] for name in type(table).__slots__}
    )
    low, high = log_determinant([half, table])
    rest = np.log1p(np.minimum(table.rest, 43200.0))
    inputs = [np.sqrt(table.speed), table.temperature, table.position, table.load]
    inputs += [np.sqrt(table.travel), np.sqrt(table.time), rest]
    unit = [2 * (one - one.min()) / np.ptp(one) - 1 for one in inputs if np.ptp(one) > 0]
    columns = [np.ones(len(rest)), *unit]
    columns += [a * b for i, a in enumerate(unit) for b in unit[i:]]
    design = np.column_stack(columns)
    strengths = np.linalg.svd(design, compute_uv=False)
    assert high == pytest.approx(0.5 * np.sum(np.log1p(strengths**2)), rel=1e-9)
    assert low < high
