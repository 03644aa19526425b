"""Running-in where the distance between recordings is a guess: both distances are rivals."""

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import hypothesis_of
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.guessed_travel import is_guessed, likelier_travel, variants
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.run_in import OF_LOGGED
from tests.diagnosis.dense_noise import problem

RUN_IN = BY_NAME["run_in"]
LIKELY = 1e3
"""Log Bayes factor of a cause that is far more likely than any rival."""


def strokes(rows):
    """Return the distance of the strokes recorded before each row over both days [deg]."""
    pairs = rows.groupby(["run", "pair"])["position"].agg(lambda one: 2 * (one.max() - one.min()))
    before = pairs.cumsum() - pairs
    return before.to_numpy()[rows.groupby(["run", "pair"]).ngroup().to_numpy()]


def run_in(rows):
    """Return 4 N·m that fall to 37 % over a fifth of the recorded strokes."""
    travel = strokes(rows)
    return 4.0 * np.exp(-5.0 * travel / travel.max())


def judged(joint):
    """Return a step of the search, and the test of running-in there."""
    step = Step.of(Precomputed.of(joint), [])
    tests = step.tested(Catalogue.of(step.precomputed, [hypothesis_of(RUN_IN, joint)]))
    return step, tests


@pytest.fixture(scope="module")
def joint():
    """A joint that runs in by its recorded strokes, though its motor is heated between them."""
    return problem(4, friction=run_in, every=3)


def test_travel_is_a_guess_where_the_motor_was_heated_between_recordings(joint):
    assert is_guessed(joint.all_runs)
    assert variants(RUN_IN, joint.all_runs) == (RUN_IN, OF_LOGGED)
    drift = BY_NAME["drift"]
    assert variants(drift, joint.all_runs) == (drift,)


def test_running_in_by_recorded_strokes_explains_more_than_by_the_guessed_travel(joint):
    step, tests = judged(joint)
    chosen, effects = likelier_travel(step, tests, LIKELY)
    assert effects == {"run_in": OF_LOGGED}
    assert chosen["run_in"].log_bayes_factor > tests["run_in"].log_bayes_factor + 3.0
    assert 0.1 < chosen["run_in"].shape["distance"] / (strokes_in_all(joint) / 5.0) < 3.0


def strokes_in_all(joint):
    pairs = joint.layout.row_pair
    width = [np.ptp(joint.table.position[pairs == number]) for number in range(pairs.max() + 1)]
    return 2 * float(np.sum(width))


def test_a_distance_that_is_chosen_refutes_no_cause(joint):
    """It is at most as likely as the cause of which it is a rival."""
    step, tests = judged(joint)
    most = tests["run_in"].log_bayes_factor + 0.5
    chosen, _ = likelier_travel(step, tests, most)
    assert chosen["run_in"].log_bayes_factor == most


def test_where_nothing_runs_in_no_distance_is_chosen():
    step, tests = judged(problem(4))
    chosen, effects = likelier_travel(step, tests, LIKELY)
    assert effects == {} or chosen["run_in"].log_bayes_factor < 3.0
