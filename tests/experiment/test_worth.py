"""What a programme is worth, against dense linear algebra and drawn noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from frictioncli.diagnosis.columns import base_rows
from frictioncli.diagnosis.judged import Score
from frictioncli.diagnosis.problem import build_problems
from frictioncli.effects import BY_NAME
from frictioncli.experiment.rivals import Question, Rival
from frictioncli.experiment.spread import spread
from frictioncli.experiment.worth import NAMED, Sight, chances, decided, noncentralities
from frictioncli.model.noise import Noise
from frictioncli.simulator.programme import Measured, Moved, simulate_programmes
from frictioncli.simulator.settings import SynthesisSettings

NOISE = (
    Noise(point=0.3, pair=0.2, drift=0.4, drift_time=900.0),
    Noise(point=0.25, pair=0.1, drift=0.2, drift_time=700.0),
)


@pytest.fixture(scope="module")
def problem():
    """Few pairs, so that dense covariance matrices stay small."""
    series = Measured(speeds=(30.0, 90.0), low=0.0, high=90.0)
    heat = Moved(speed=90.0, low=0.0, high=90.0, seconds=300.0)
    (table,) = simulate_programmes(
        SynthesisSettings(seed=3, joint_kind="plain"), [[series, heat] * 6], 1
    )
    return replace(build_problems(table, "motor")[0], temperature_error=0.0)


def score(name, shape, *coefficients):
    """An effect so clear that noise adds nothing to its size."""
    return Score(BY_NAME[name], shape, np.array(coefficients), np.zeros((0, 0)), 1e12)


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
    found = noncentralities(Sight(problem, NOISE, problem.whole), question, ())
    base = base_rows(problem)

    def left(signal, rival, shapes):
        best = np.inf
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
            best = min(best, float(rest @ rest))
        return best

    for i, j in ((0, 1), (1, 0)):
        own, other = question.rivals[i].score, question.rivals[j].score
        basis = problem.basis(own.effect, own.shape)
        signal = [part @ own.coefficients for part in basis]
        shapes = [other.shape, *other.effect.shapes(problem.whole)]
        # pooling neighbours loses a little of what differs inside pairs
        assert found[i, j] == pytest.approx(left(signal, other.effect, shapes), rel=0.03)
    assert found[0, 0] == found[1, 1] == 0.0
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
    found = chances(question, np.zeros((2, 3)), after, pairs=10**9)
    assert found[0, 1] == pytest.approx(drawn, abs=0.03)
    assert found[0, 0] == 1.0


def test_a_noise_of_unknown_size_makes_evidence_grow_with_its_logarithm():
    question = Question(
        (
            Rival(score("drift", {"time_constant": 200.0}, 1.0), 0.0),
            Rival(score("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    pairs, after = 40, np.array([[0.0, 60.0, 1e9], [60.0, 0.0, 1e9]])
    found = chances(question, np.zeros((2, 3)), after, pairs)
    added = 40 * np.log(1 + 60 / 40)
    assert found[0, 1] == pytest.approx(norm.cdf((added / 2 - np.log(19)) / np.sqrt(added)))
    assert decided(question, found) == pytest.approx(found[0, 1])


def test_without_new_rows_nothing_is_decided():
    question = Question(
        (
            Rival(score("drift", {"time_constant": 200.0}, 1.0), 1.0),
            Rival(score("coulomb_temperature", {}, 1.0), 0.0),
        )
    )
    same = np.full((2, 3), 12.0)
    assert decided(question, chances(question, same, same, 50)) == pytest.approx(0.0, abs=1e-6)


def test_rows_spread_by_the_determinant_of_a_quadratic(problem):
    """By hand: inputs of a table, scaled to -1 ... 1, with squares and products."""
    table = problem.table
    half = type(table)(
        **{name: getattr(table, name)[table.time < 600.0] for name in type(table).__slots__}
    )
    low, high = spread([half, table])
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
