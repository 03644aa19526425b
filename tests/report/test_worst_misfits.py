"""Misfits of opposite sign in heating and cooling are listed, not averaged away."""

from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.data.temperature_direction import temperature_direction
from frictioncli.diagnosis.data.worst_misfits import worst_misfits


def test_direction_follows_the_made_thermal_cycle(diagnosis):
    table = diagnosis.seen.problem.table
    direction = temperature_direction(table)
    # pairs are 600 s apart: the turn lies inside the window of its neighbours
    heating = (table.time > 1600) & (table.time < 6000)
    cooling = (table.time > 7800) & (table.time < 20000)
    assert (direction[heating] == 1).all()
    assert (direction[cooling] == -1).all()


def test_a_loop_that_cancels_in_common_means_is_listed_by_phase(diagnosis):
    problem = diagnosis.seen.problem
    loop = 5.0 * temperature_direction(problem.table)
    shifted = replace(problem, friction=problem.friction - problem.friction_misfit + loop)
    np.testing.assert_allclose(shifted.friction_misfit, loop, atol=1e-9)
    found = worst_misfits(shifted)
    assert len(found) == 5
    for place in found:
        assert place.channel == "friction"
        np.testing.assert_allclose(place.misfit, {"heat-up": 5.0, "cool-down": -5.0}[place.phase])
