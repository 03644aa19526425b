"""A bump that one direction of motion has, and the other one less of, or not at all."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.empirical.describe import described
from frictioncli.diagnosis.empirical.estimate import empirical_term
from frictioncli.diagnosis.empirical.form import is_special_case
from frictioncli.diagnosis.empirical.forms import forms_of
from frictioncli.diagnosis.empirical.term import FormFunction, ranges_seen
from frictioncli.diagnosis.fit.extension import extend
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from tests.diagnosis.dense_noise import problem

SHAPE = {"centre": 70.0, "width": 8.0, "lag": 0.05}


def at(position, height):
    return height * np.exp(-np.square((position - SHAPE["centre"]) / SHAPE["width"]) / 2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("kind", "channel", "heights"),
    [
        ("uneven_bump", "friction", (3.0, -0.5)),
        ("bump", "friction", (2.0, 2.0)),
        ("bump", "load", (2.0, 2.0)),
    ],
)
def test_it_adds_what_the_separation_makes_of_torques_logged_late(kind, channel, heights, sign):
    table = problem(1).table
    names = ("forward", "reverse") if kind == "uneven_bump" else ("peak",)
    form = FormFunction(
        kind=kind,
        axes=("position",),
        channel=channel,
        shape=SHAPE,
        coefficients=dict(zip(names, heights, strict=False)),
        formula="",
        sign=sign,
    )
    moved = SHAPE["lag"] * table.speed
    # friction acts against the motion: in the log it has this sign forward, the other in reverse
    forward, reverse = (
        at(table.position - moved, heights[0]),
        at(table.position + moved, heights[1]),
    )
    if channel == "friction":
        forward, reverse = sign * forward, -sign * reverse
    added = form.at(table)
    np.testing.assert_allclose(added.friction, sign * (forward - reverse) / 2, atol=1e-12)
    np.testing.assert_allclose(added.load, (forward + reverse) / 2, atol=1e-12)


def test_it_is_found_and_described_with_both_heights():
    """A tooth that is damaged on one flank: in the pairs half of it is friction, half load."""
    data = problem(
        3,
        every=16,
        friction=lambda rows: at(rows.position, 4.0) / 2,
        load=lambda rows: at(rows.position, 4.0) / 2,
    )
    step = Step.of(Precomputed.of(data), [])
    beside = extend(data, step.predicting_fit(), [])
    term = empirical_term(step, (data, beside), None, margin=0.2, floor=0.3, seed=0).term
    (form,) = term.forms
    assert form.kind == "uneven_bump"
    assert form.shape["centre"] == pytest.approx(70.0, abs=1.0)
    assert form.coefficients["forward"] == pytest.approx(4.0, rel=0.15)
    assert form.coefficients["reverse"] == pytest.approx(0.0, abs=0.6)
    text = described(form, "N·m")
    assert text.startswith("friction that is another one in each direction at ")
    assert "more in forward motion" in text


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_load_at_an_angle_that_adds_friction_is_said_to_be_a_load(sign):
    """The heights that the form has at its centre in both channels; the torque is not late."""
    form = FormFunction(
        kind="uneven_bump",
        axes=("position",),
        channel="friction",
        shape={"centre": 70.0, "width": 8.0, "lag": 0.0},
        coefficients={"forward": 4.3, "reverse": -2.5},
        formula="",
        sign=sign,
    )
    table = problem(1).table
    at_centre = form.at(replace(table, position=np.full_like(table.position, 70.0)))
    assert at_centre.load[0] == pytest.approx(sign * 3.4)
    assert at_centre.friction[0] == pytest.approx(0.9)
    what = "bump" if sign > 0 else "dent"
    assert described(form, "N·m") == (
        f"a {what} of the load of 3.4 N·m at 70.0 deg, 8.0 deg wide (standard deviation), where"
        " friction is 0.90 N·m more"
    )


def test_a_bump_and_a_load_at_an_angle_are_its_special_cases():
    """Neither is in doubt because of it: as high in both directions, or with opposite signs."""
    forms = forms_of(ranges_seen(problem(1).table))
    (uneven,) = (one for one in forms if one.kind == "uneven_bump")
    special = [one for one in forms if is_special_case(one, uneven)]
    assert [(one.kind, one.axes, one.channel) for one in special] == [
        ("bump", ("position",), "friction"),
        ("bump", ("position",), "load"),
    ]
    assert not any(is_special_case(uneven, one) for one in forms)


def test_a_load_at_an_angle_in_a_late_torque_is_one_of_both_directions():
    """What hangs there pulls in both; that the log is late shows in friction, too."""

    def halves(rows):
        moved = 0.1 * rows.speed
        return at(rows.position - moved, 3.0) / 2, at(rows.position + moved, 3.0) / 2

    data = problem(
        3,
        every=16,
        friction=lambda rows: np.subtract(*halves(rows)),
        load=lambda rows: np.add(*halves(rows)),
    )
    step = Step.of(Precomputed.of(data), [])
    beside = extend(data, step.predicting_fit(), [])
    term = empirical_term(step, (data, beside), None, margin=0.2, floor=0.3, seed=0).term
    (form,) = term.forms
    assert (form.kind, form.channel) == ("bump", "load")
    assert form.coefficients["peak"] == pytest.approx(3.0, rel=0.15)
    assert form.shape["lag"] == pytest.approx(0.1, abs=0.02)
    assert described(form, "N·m").startswith("a bump of the load of ")


@pytest.mark.parametrize(
    ("forward", "reverse", "said"),
    [
        (7.9, 8.0, "a bump of friction of 8.0 N·m at 70.0 deg, nearly the same in both directions"),
        (
            -7.9,
            -8.0,
            "a dent of friction of 8.0 N·m at 70.0 deg, nearly the same in both directions",
        ),
        (4.0, 0.0006, "4.0 N·m more in forward motion, none in reverse"),
        (4.0, -1.0, "4.0 N·m more in forward motion, 1.0 N·m less in reverse"),
    ],
)
def test_what_is_nearly_the_same_in_both_directions_or_none_in_one_is_said_so(
    forward, reverse, said
):
    form = FormFunction(
        kind="uneven_bump",
        axes=("position",),
        channel="friction",
        shape={"centre": 70.0, "width": 8.0, "lag": 0.0},
        coefficients={"forward": forward, "reverse": reverse},
        formula="",
        sign=1.0,
    )
    assert said in described(form, "N·m")
