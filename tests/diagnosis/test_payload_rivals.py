"""A payload is told from another scale of the torque by friction, from a new zero by its form."""

import numpy as np
import pytest

from frictioncli.diagnosis.search.payload_rivals import with_payload_rivals
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_standing import cause

SECOND_DAY = {"moment": 0.5, "end": 1.0}


def judged(friction, load, steps=()):
    """Return what is said of a payload that is found where torques change on the second day.

    ``friction`` is a share of it; ``load`` is a share of gravity and a torque at 90 deg [N·m].
    """

    def later(rows):
        return rows["run"] == "day2"

    share, across = load
    data = problem(
        3,
        lambda rows: friction * rows["friction_torque"] * later(rows),
        lambda rows: (
            later(rows)
            * (share * rows["load_torque"] + across * np.sin(np.radians(rows["position"])))
        ),
    )
    step = Step.of(Precomputed.of(data), [])
    causes = []
    for name in ("payload_change", *steps):
        fit = step.fitted(BY_NAME[name], SECOND_DAY)
        errors = np.sqrt(np.diag(fit.covariance))
        causes.append(cause(fit.effect, tuple(fit.coefficients), tuple(errors), shape=SECOND_DAY))
    found = Step.of(step.precomputed, [one.fit for one in causes])
    return with_payload_rivals(causes, found, [data]), found


def test_load_and_friction_that_change_alike_are_a_scale():
    found, before = judged(0.06, (0.06, 0.0))
    (scale,) = found.causes
    assert scale.effects[0] == "torque_scale"
    assert scale.fit.coefficients == pytest.approx([6.0], abs=0.5)
    assert [one.effect.name for one in found.step.accepted] == ["torque_scale"]
    # one coefficient explains both channels
    assert found.step.fit.objective < before.fit.objective - 10


def test_a_step_of_friction_at_that_moment_is_a_part_of_it():
    found, _ = judged(0.06, (0.06, 0.0), ["step_change"])
    (scale,) = found.causes
    (step,) = found.replaced
    assert (scale.effects[0], step.fit.effect.name) == ("torque_scale", "step_change")
    assert step.standing == "undetermined"


@pytest.mark.parametrize(
    ("friction", "load", "expected"),
    [
        # friction stays, or changes as much as days differ by
        (0.0, (0.06, 0.0), ("payload_change",)),
        (0.01, (0.06, 0.0), ("payload_change",)),
        # a mass elsewhere than that of the arm, whatever friction does
        (0.06, (0.04, 4.0), ("payload_change",)),
        # across the arm gravity turns, by 7 deg: few joints are mastered that wrongly
        (0.0, (0.0, 12.0), ("payload_change", "position_offset")),
        # between both
        (0.028, (0.06, 0.0), ("payload_change", "torque_scale")),
    ],
)
def test_a_payload_leaves_friction_as_it_was(friction, load, expected):
    found, before = judged(friction, load)
    (payload,) = found.causes
    assert payload.effects == expected
    assert payload.fit.effect.name == "payload_change"
    assert found.step is before
    assert sum(payload.probabilities.values()) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        # friction tells nothing of half a per cent, which is no payload that anybody puts on
        ((0.006, 0.0), {"torque_scale", "payload_change"}),
        # as large, at 45 deg to gravity
        ((0.0045, 0.45), {"payload_change"}),
    ],
)
def test_a_small_change_in_the_form_of_gravity_may_be_one_of_the_scale(load, expected):
    found, _ = judged(0.0, load)
    (change,) = found.causes
    assert set(change.effects) == expected
    assert (change.effects[0] == "torque_scale") == ("torque_scale" in expected)


@pytest.mark.parametrize(
    ("offset", "expected"),
    [
        (0.4, ("position_offset",)),
        # a mass of two per cent across the arm is rarer than a joint that is mastered anew
        (1.2, ("position_offset", "payload_change")),
    ],
)
def test_gravity_that_turns_may_be_another_zero_of_the_position(offset, expected):
    """Gravity of 95 N·m at the true angle, which is less than the logged one."""
    found, _ = judged(0.0, (np.cos(np.radians(offset)) - 1, 95.0 * np.sin(np.radians(offset))))
    (change,) = found.causes
    assert change.effects == expected
    assert change.fit.coefficients == pytest.approx([offset], rel=0.1)
    assert [one.effect.name for one in found.step.accepted] == ["position_offset"]
