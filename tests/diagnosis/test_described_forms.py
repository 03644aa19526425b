"""What is said of forms: within what was measured, and beside another form."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.empirical.describe import described, formula_with_numbers, is_near
from frictioncli.diagnosis.empirical.term import FormFunction
from frictioncli.effects.pair_series import rows_of
from tests.diagnosis.dense_noise import problem

LIFTING = FormFunction(
    kind="lifting",
    axes=("load",),
    channel="load",
    shape={"exponent": 2.0},
    coefficients={"torque": 8.0},
    formula="torque sign(L) (|L| / 50)^exponent",
)
MOVING = FormFunction(
    kind="moving_peak",
    axes=("speed", "temperature"),
    channel="friction",
    shape={"centre": 30.0, "width": 0.3, "shift": -0.03},
    coefficients={"peak": 2.0},
    formula="",
)
PEAK = FormFunction(
    kind="peak",
    axes=("position",),
    channel="load",
    shape={"centre": 60.0, "width": 5.0},
    coefficients={"peak": 3.0},
    formula="peak exp(-((q - centre) / width)^2 / 2)",
)


def one_row(**values):
    row = rows_of(problem(1).table, np.arange(1))
    return replace(row, **{name: np.array([one]) for name, one in values.items()})


@pytest.mark.parametrize(("most", "load"), [(20.0, 20.0), (90.0, 50.0)])
def test_lifting_is_stated_at_a_load_that_was_measured(most, load):
    there = LIFTING.at(one_row(load=load)).load[0]
    text = described(LIFTING, "N·m", ranges={"load": (1.0, most)})
    assert text.startswith(f"lifting that takes {there:.2g}")
    assert f"at a load of {load:g}" in text


def test_a_moving_peak_is_stated_at_a_temperature_that_was_measured():
    """It stands where the form is greatest at that temperature."""
    speeds = np.geomspace(10.0, 100.0, 2001)
    row = one_row(temperature=25.0)
    heights = [MOVING.at(replace(row, speed=np.array([one]))).friction[0] for one in speeds]
    text = described(MOVING, "N·m", ranges={"temperature": (15.0, 25.0)})
    assert f"at {speeds[np.argmax(heights)]:.1f} deg/s (at 25" in text
    assert "at 30" in described(MOVING, "N·m", ranges={"temperature": (15.0, 60.0)})


@pytest.mark.parametrize(("centre", "near"), [(75.0, True), (85.0, False)])
def test_a_form_at_the_flank_of_another_one_may_be_a_part_of_its_shape(centre, near):
    other = replace(PEAK, shape={"centre": centre, "width": 3.0})
    assert is_near(other, PEAK) is near
    assert ("shape of the former" in described(other, "N·m", beside=PEAK)) is near
    assert not is_near(replace(other, channel="friction"), PEAK)
    assert not is_near(replace(other, axes=("temperature",)), PEAK)


def test_a_formula_says_from_which_run_on_it_holds():
    assert formula_with_numbers(replace(PEAK, since="day2")).endswith(", from run day2 on")
    assert "run" not in formula_with_numbers(PEAK)
