"""The recommended setting of the corrections, on phases with known errors."""

import numpy as np

from frictioncli.report.grid_replay import Events, ReplayedPhase
from frictioncli.report.recommendation import recommended_setting


def phase(uncorrected, errors, counts):
    nothing = np.zeros(0)
    return ReplayedPhase(
        run="day-1",
        name="heat-up",
        delta=0.05,
        time=nothing,
        speed=nothing,
        temperature=nothing,
        term=nothing,
        error=nothing,
        uncorrected=uncorrected,
        epsilon=np.array(errors),
        events=tuple(
            Events(time=np.zeros(n), correction=np.zeros(n), failed=np.zeros(n, bool))
            for n in counts
        ),
    )


def test_the_fewest_corrections_that_reach_the_target_in_every_phase():
    heating = phase(7.0, [0.5, 1.9, 1.8, 3.0], [20, 8, 8, 3])
    cooling = phase(6.0, [0.4, 1.5, 1.7, 1.9], [20, 7, 7, 3])
    # the last reaches it in cooling only; of the two with 15 the third has the smaller worst error
    assert recommended_setting([heating, cooling], "N·m") == 2


def test_no_correction_where_the_target_is_reached_without():
    assert recommended_setting([phase(1.9, [0.1], [5])], "N·m") is None
    assert recommended_setting([phase(2.1, [0.1], [5])], "N·m") == 0


def test_the_smallest_error_where_no_setting_reaches_the_target():
    assert recommended_setting([phase(9.0, [4.0, 3.0, 8.0], [5, 9, 3])], "N·m") == 1


def test_no_correction_where_all_settings_make_it_worse():
    assert recommended_setting([phase(3.0, [3.5, 4.0], [5, 9])], "N·m") is None


def test_in_amperes_the_target_is_a_quarter_of_the_uncorrected_error():
    assert recommended_setting([phase(0.8, [0.1, 0.19, 0.21], [9, 4, 2])], "A") == 1
