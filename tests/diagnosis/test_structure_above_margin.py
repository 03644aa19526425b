"""Which axis is reported where several have structure."""

import pytest

from frictioncli.diagnosis.search.lack_of_fit import Structure, first_above
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
    assert first_above(found, DATA, 0.25, 0.05) == expected


def test_what_is_known_is_not_reported():
    found = first_above([ANGLE, TEMPERATURE], DATA, 0.25, 0.05, lambda one: one is TEMPERATURE)
    assert found is None
    found = first_above([ANGLE, TEMPERATURE], DATA, 0.25, 0.05, lambda one: one is ANGLE)
    assert found == TEMPERATURE
