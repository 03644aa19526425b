"""Residuals in bins: means, standard errors over pairs, series."""

import numpy as np
import pandas as pd
import pytest

from frictioncli.report.binning import (
    bin_means,
    bin_numbers,
    group_boundaries,
    merge_close_values,
    residual_series,
)


def test_errors_are_taken_over_pairs():
    rows = pd.DataFrame(
        {
            "bin": [0, 0, 0, 0, 0, 0, 1, 1],
            "pair": [1, 1, 2, 2, 3, 3, 4, 4],
            "at": [1.0] * 6 + [2.0] * 2,
            "mean": [1.0, 3.0, 4.0, 4.0, 5.0, 7.0, 0.0, 2.0],
            "term": [0.5] * 8,
        }
    )
    found = bin_means(rows)
    np.testing.assert_allclose(found.mean, [4.0, 1.0])
    assert found.error[0] == pytest.approx(np.std([2, 4, 6], ddof=1) / np.sqrt(3))
    assert np.isnan(found.error[1])
    np.testing.assert_allclose(found.term, 0.5)


def test_bins_follow_what_was_measured():
    speed = np.array([10.0, 10.05, 50.0, 99.0])
    assert bin_numbers("speed", speed).tolist() == [0, 0, 1, 2]
    assert merge_close_values(speed)[0] == merge_close_values(speed)[1] == pytest.approx(10.025)
    assert bin_numbers("order", np.arange(10.0)).tolist() == [0, 1, 2, 3, 4, 4, 5, 5, 6, 6]
    assert group_boundaries(np.arange(5.0), 2).tolist() == [2.5]
    assert set(bin_numbers("temperature", np.linspace(20, 60, 500))) == set(range(12))


def test_rows_are_split_where_an_effect_would_cancel(diagnosis):
    table = diagnosis.seen.problem.table
    warm, cool = residual_series(table, "motor_temperature", "friction")
    assert not (warm.rows & cool.rows).any()
    hours = table.time / 3600
    assert warm.rows[(hours > 0.6) & (hours < 1.6)].all()
    assert cool.rows[(hours > 2.4) & (hours < 6.0)].all()
    above, below = residual_series(table, "clock", "load")
    assert (table.load[above.rows] > 0).all()
    assert (table.load[below.rows] <= 0).all()
    assert len(residual_series(table, "clock", "friction")) == 1
