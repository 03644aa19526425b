"""Named causes that explain little of what the base misses on a held-out run."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search import explained_share
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.explained_share import explains_little
from frictioncli.diagnosis.search.verdict import visible_causes
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem

FLOOR = 0.1
STEP = SimpleNamespace(predicting_fit=lambda: None)
BASE = SimpleNamespace(friction_misfit="missed", load_misfit="missed")
JUDGING = SimpleNamespace(problem="seen", new="new", measured=("seen", BASE), margin=0.1)


def cause(name, reason="", p_value=1e-20):
    width = len(BY_NAME[name].coefficients)
    return Cause(
        fit=EffectFit(BY_NAME[name], {}, np.ones(width), np.eye(width), 100.0),
        test=SimpleNamespace(p_value=p_value),
        effects=(name,),
        probabilities={name: 1.0},
        size=1.0,
        visible=1.0,
        standing="named",
        reason=reason,
        holds_on_new_run=True,
    )


def reason(monkeypatch, before, after, *names, judging=JUDGING):
    """Return the reason where the causes leave ``after`` of ``before``, whole and beside levels."""
    monkeypatch.setattr(explained_share, "_missed", lambda *_: ("left", "left"))
    monkeypatch.setattr(
        explained_share,
        "_rms",
        lambda new, friction, load: np.array(after if friction == "left" else before, float),
    )
    return explains_little([cause(one) for one in names], STEP, judging, FLOOR)


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        # (0.25 - 0.17) / (0.25 - 0.01) of the mean square
        ((0.5, 0.5), (np.sqrt(0.17), np.sqrt(0.17)), "33 %"),
        ((0.5, 0.5), (0.2, 0.2), ""),
        # days differ in their level, beside which the cause explains nearly all
        ((0.9, 0.5), (0.8, 0.15), ""),
        # what remains is below the margin
        ((0.15, 0.15), (0.14, 0.14), ""),
        # the base misses nothing but noise
        ((0.09, 0.09), (0.3, 0.3), ""),
    ],
)
def test_causes_that_leave_most_of_it_may_be_parts_of_something_else(
    monkeypatch, before, after, told
):
    found = reason(monkeypatch, before, after, "dress_pack", "torque_delay")
    assert told in found
    assert bool(found) == bool(told)


@pytest.mark.parametrize(
    "names", [("payload_change",), ("step_change", "drift"), ("torque_delay",)]
)
def test_changes_and_the_measurement_are_not_judged_so(monkeypatch, names):
    assert reason(monkeypatch, (0.5, 0.5), (0.45, 0.45), *names) == ""


def test_nothing_is_said_without_a_held_out_run(monkeypatch):
    alone = SimpleNamespace(problem="seen", new=None, measured=("seen", None), margin=0.1)
    assert reason(monkeypatch, (0.5, 0.5), (0.45, 0.45), "drift", judging=alone) == ""


def test_levels_by_which_days_differ_are_taken_off():
    """Coulomb friction by a constant, viscous friction by a share, and the zero of the load."""
    new = problem(1)
    wave = 0.3 * np.sin(np.arange(len(new.load)))
    viscous = new.table.viscous * np.sqrt(new.table.speed)
    friction, load = 0.7 + 0.05 * viscous + wave, np.full(len(new.load), 0.4)
    whole, beside = explained_share._rms(new, friction, load)
    assert whole == pytest.approx(np.sqrt(np.mean(np.square(friction) + 0.16)))
    design = np.column_stack([np.ones_like(viscous), viscous])
    left = wave - design @ np.linalg.lstsq(design, wave, rcond=None)[0]
    assert beside == pytest.approx(np.sqrt(np.mean(np.square(left))))


def test_an_effect_that_was_refused_and_then_stands_beside_fewer_has_one_line():
    beside, refused = cause("sensor_lag", "too small"), cause("sensor_lag", "impossible")
    other = replace(cause("torque_filter", "impossible"), visible=0.5)
    shown = visible_causes([beside], [refused, other], [], problem(1))
    assert [one.reason for one in shown] == ["too small", "impossible"]
