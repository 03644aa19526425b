"""A step of friction that a form of structure without a name makes needless."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from frictioncli.diagnosis.needless_steps import without_needless_steps
from frictioncli.effects import EFFECTS
from frictioncli.effects.run_in import EFFECT as RUN_IN
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE


@dataclass(frozen=True)
class OneCause:
    """A cause with its standing."""

    fit: SimpleNamespace
    standing: str = "named"
    reason: str = ""


@dataclass(frozen=True)
class Found:
    """What of a diagnosis counts: causes, and a term with forms beside which they are refitted."""

    causes: tuple[OneCause, ...]
    empirical: SimpleNamespace | None
    visible: tuple[OneCause, ...] = ()
    tried: tuple = field(default=tuple(EFFECTS))


def form(*, in_channel="friction", zero=()):
    """Return a term with a form, and which effects may be zero beside it."""
    fits = [SimpleNamespace(effect=one) for one in (RUN_IN, STEP_CHANGE)]
    beside = SimpleNamespace(effects=fits, may_be_zero=lambda number: fits[number].effect in zero)
    part = SimpleNamespace(channel=in_channel, form="a step at 31 °C")
    return SimpleNamespace(parts=(part,), beside=beside)


def diagnosed(first, without_step):
    """Return the diagnosis, if one without the step is as given."""
    return without_needless_steps(
        lambda effects: first if STEP_CHANGE in effects else without_step, EFFECTS
    )


def step_and(term):
    return Found(causes=(OneCause(SimpleNamespace(effect=STEP_CHANGE)),), empirical=term)


def test_a_step_that_may_be_zero_beside_a_form_has_no_name():
    without = Found(causes=(), empirical=form())
    found = diagnosed(step_and(form(zero=[STEP_CHANGE])), without)
    assert found.causes == ()
    (left,) = found.visible
    assert (left.fit.effect, left.standing) == (STEP_CHANGE, "undetermined")


@pytest.mark.parametrize(
    ("term", "alone"),
    [
        (form(), form()),
        (None, form()),
        (form(in_channel="load", zero=[STEP_CHANGE]), form()),
        (form(zero=[STEP_CHANGE]), None),
    ],
    ids=["is there beside it", "no form", "form in the load", "no form without the step"],
)
def test_another_step_keeps_its_name(term, alone):
    first = step_and(term)
    assert diagnosed(first, Found(causes=(), empirical=alone)) is first
