"""Forms that data can show: measured in width and height, and no dent deeper than friction."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.empirical.form_columns import columns_of
from frictioncli.diagnosis.empirical.resolved import is_resolved
from frictioncli.diagnosis.empirical.term import FormFunction
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.test_empirical import found

DATA = problem(3)
BIN = float(np.min(np.diff(DATA.table.angles)))
FRICTION = float(np.mean(DATA.friction))


def peak(axis, centre, width, height):
    shape = {"centre": centre, "width": width}
    if axis == "position":
        shape["lag"] = 0.0
    return FormFunction(
        kind="bump" if axis == "position" else "peak",
        axes=(axis,),
        channel="friction",
        shape=shape,
        coefficients={"peak": height},
        formula="",
    )


@pytest.mark.parametrize(
    ("share", "height", "expected"),
    [(0.2, 2.0, False), (0.45, 2.0, False), (0.55, 2.0, True), (2.0, -2.0, True)],
)
def test_a_bump_is_at_least_half_a_bin_wide(share, height, expected):
    middle = float(np.median(DATA.table.angles))
    assert is_resolved(peak("position", middle, share * BIN, height), DATA) is expected


def test_at_half_a_bin_the_height_is_seen_wherever_a_bump_is():
    shown = []
    for centre in np.linspace(60.0, 60.0 + BIN, 21):
        shape = {"centre": centre, "width": BIN / 2, "lag": 0.0}
        friction, _ = columns_of("bump", ("position",), "friction", DATA.table, shape)
        shown.append(friction.max())
    assert min(shown) == pytest.approx(np.exp(-1 / 2), abs=0.01)


@pytest.mark.parametrize(("between", "expected"), [(0.0, True), (0.5, False)])
def test_a_narrow_peak_has_a_height_where_its_speed_was_measured(between, expected):
    speeds = np.unique(DATA.table.speed)
    speed = speeds[1] + between * (speeds[2] - speeds[1])
    assert is_resolved(peak("speed", speed, 0.1, 3.0), DATA) is expected


@pytest.mark.parametrize(("share", "expected"), [(-1.3, False), (-0.5, True), (1.3, True)])
def test_no_dent_is_deeper_than_friction(share, expected):
    assert is_resolved(peak("position", 60.0, 2 * BIN, share * FRICTION), DATA) is expected


def test_friction_in_a_single_bin_is_located_without_a_form():
    """As a chipped tooth: how wide and how high it is between the bins, the bins do not tell."""
    angles = DATA.table.angles
    single = DATA.table.position == angles[len(angles) // 2]
    empirical = found(replace(DATA, friction=DATA.friction + 4.0 * single))
    assert empirical is None or not empirical.term.forms
