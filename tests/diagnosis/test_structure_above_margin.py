"""Which axis is reported where several have structure."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.search.lack_of_fit import beside_others, structures
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.structure_above_margin import first_above
from tests.diagnosis.dense_noise import problem

DATA = problem(1)


def along(axis, p_value, size, least):
    return Structure(
        axes=(axis,),
        channel="friction",
        p_value=p_value,
        statistic=1.0,
        size=size,
        interval=(least, 2 * size),
    )


ANGLE = along("position", 1e-5, 0.30, 0.19)
TEMPERATURE = along("temperature", 1e-3, 0.43, 0.32)
FAINT = along("speed", 1e-6, 0.20, 0.15)
DOUBTFUL = along("time", 0.02, 0.50, 0.40)


ANYWAY = {"problem": DATA, "margin": 0.25, "level": 5e-3, "beside": lambda one, _: one}


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        # something is surely above 0.25 N·m; it is likeliest along the angle
        ([ANGLE, TEMPERATURE], ANGLE),
        # what is most probably below the margin is not what is left
        ([FAINT, TEMPERATURE], TEMPERATURE),
        # nothing is surely above it
        ([ANGLE, FAINT], None),
        # surely above it, but not significant
        ([ANGLE, DOUBTFUL], None),
        ([], None),
    ],
)
def test_the_likeliest_of_what_is_above_the_margin_is_reported(found, expected):
    assert first_above(found, **ANYWAY) == expected


@pytest.mark.parametrize(
    ("left", "expected"),
    [
        (TEMPERATURE, TEMPERATURE),
        (replace(TEMPERATURE, size=0.2), None),
        (replace(TEMPERATURE, p_value=0.1), None),
        (None, None),
    ],
)
def test_what_imitates_something_likelier_and_small_is_not_reported(left, expected):
    asked = []

    def beside(one, others):
        asked.append((one, tuple(others)))
        return left

    found = [replace(FAINT, statistic=9.0), TEMPERATURE]
    assert first_above(found, **ANYWAY | {"beside": beside}) == expected
    assert asked == [(TEMPERATURE, (found[0],))]


def test_beside_structure_its_imitations_are_gone():
    """A ripple that grows with temperature is partly one of the angle, the time and the load."""
    warm = (DATA.table.temperature - DATA.table.temperature.mean()) / 10.0
    torque = 0.8 * warm * np.sin(3 * np.radians(DATA.table.position))
    step = Step.of(Precomputed.of(replace(DATA, friction=DATA.friction + torque)), [])
    true, *others = structures(step)
    assert true.axes == ("position", "temperature")
    imitations = [one for one in others if one.p_value < 5e-3]
    assert imitations
    for one in imitations:
        left = beside_others(one, [true], step)
        assert left is None or left.p_value > 5e-3
    # none of them explains it
    left = beside_others(true, imitations, step)
    assert left.p_value < 1e-6
    assert left.size > 0.5 * true.size
