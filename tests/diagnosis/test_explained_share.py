"""Named causes that explain little of what the base misses on a held-out run."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli.diagnosis.explained_share import explains_little, without_small_parts
from frictioncli.diagnosis.fit.gain import Gain, _rms_beside_days
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.verdict import visible_causes
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem

FLOOR = 0.1
GAIN = Gain(
    basis="new_run",
    before=0.5,
    after=np.sqrt(0.17),
    reduction=0.2,
    interval=(0.1, 0.3),
    floor=FLOOR,
    beside_days=(0.5, np.sqrt(0.17)),
)
"""The causes explain (0.25 - 0.17) / (0.25 - 0.01) of the mean square beside the noise."""


def cause(name, reason="", holds=True):
    width = len(BY_NAME[name].coefficients)
    return Cause(
        fit=EffectFit(BY_NAME[name], {}, np.ones(width), np.eye(width), 100.0),
        test=SimpleNamespace(p_value=1e-20),
        effects=(name,),
        probabilities={name: 1.0},
        size=1.0,
        visible=1.0,
        standing="named",
        reason=reason,
        holds_on_new_run=holds,
    )


def diagnosis(*causes, gain=GAIN, structure=None):
    return SimpleNamespace(causes=causes, gain=gain, floor=FLOOR, margin=0.1, structure=structure)


PACK, DELAY = cause("dress_pack"), cause("torque_delay")


@pytest.mark.parametrize(
    ("whole", "beside_days", "told"),
    [
        ((0.5, np.sqrt(0.17)), (0.5, np.sqrt(0.17)), "33 %"),
        # what they make worse is no share
        ((0.5, 0.6), (0.5, 0.6), "0 %"),
        ((0.5, 0.2), (0.5, 0.2), ""),
        # days differ in their level, beside which the cause explains nearly all
        ((0.9, 0.8), (0.5, 0.15), ""),
        # what remains is below the margin
        ((0.15, 0.14), (0.15, 0.14), ""),
        # the base misses nothing but noise
        ((0.09, 0.3), (0.09, 0.3), ""),
    ],
)
def test_causes_that_leave_most_of_it_may_be_parts_of_something_else(whole, beside_days, told):
    gain = replace(GAIN, before=whole[0], after=whole[1], beside_days=beside_days)
    found = explains_little(diagnosis(PACK, DELAY, gain=gain))
    assert told in found
    assert bool(found) == bool(told)


@pytest.mark.parametrize(
    "causes",
    [
        (),
        (DELAY,),
        # a change has its history there
        (cause("payload_change"),),
        (cause("step_change"), PACK),
        # what did not last explains nothing there
        (cause("drift", holds=False),),
    ],
)
def test_the_measurement_and_changes_are_not_judged_so(causes):
    assert explains_little(diagnosis(*causes)) == ""


def test_nor_is_a_diagnosis_with_structure_or_without_a_held_out_run():
    assert explains_little(diagnosis(PACK)) != ""
    assert explains_little(diagnosis(PACK, structure="along time")) == ""
    assert explains_little(diagnosis(PACK, gain=None)) == ""
    assert explains_little(diagnosis(PACK, gain=replace(GAIN, basis="within_run"))) == ""


def test_the_diagnosis_is_repeated_without_their_names():
    asked = []

    def diagnose(without_name):
        asked.append(without_name)
        return diagnosis(PACK, DELAY) if not without_name else diagnosis(DELAY)

    found = without_small_parts(diagnose)
    assert found.causes == (DELAY,)
    (none, names) = asked
    assert none == {}
    assert list(names) == ["dress_pack"]
    assert "33 %" in names["dress_pack"]


def test_levels_by_which_days_differ_are_taken_off():
    """Coulomb friction by a constant, viscous friction by a share, and the zero of the load."""
    new = problem(1)
    wave = 0.3 * np.sin(np.arange(len(new.load)))
    viscous = new.table.viscous * np.sqrt(new.table.speed)
    beside = _rms_beside_days(new, 0.7 + 0.05 * viscous + wave, np.full(len(new.load), 0.4))
    design = np.column_stack([np.ones_like(viscous), viscous])
    left = wave - design @ np.linalg.lstsq(design, wave, rcond=None)[0]
    assert beside == pytest.approx(np.sqrt(np.mean(np.square(left))))


def test_an_effect_that_was_refused_and_then_stands_beside_fewer_has_one_line():
    beside, refused = cause("sensor_lag", "too small"), cause("sensor_lag", "impossible")
    other = replace(cause("torque_filter", "impossible"), visible=0.5)
    shown = visible_causes([beside], [refused, other], [], problem(1))
    assert [one.reason for one in shown] == ["too small", "impossible"]
