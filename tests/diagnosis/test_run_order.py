"""Runs are taken in the order of their numbers, whatever they are called."""

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.build_problem import build_problems
from tests.equation_16 import cycle_temperatures, torques


def test_runs_with_and_without_leading_zeros_make_the_same_problem():
    temperature, time, phase = (values[::4] for values in cycle_temperatures())
    runs = [torques(seed, temperatures=(temperature, time, phase)) for seed in (1, 2, 3)]

    def problems(*names):
        named = [rows.assign(run=name) for rows, name in zip(runs, names, strict=True)]
        rows = pd.concat(named, ignore_index=True).assign(load=np.nan)
        return build_problems(rows, "motor", names[-1])

    (seen, new), (padded, padded_new) = (
        problems("day8", "day9", "day10"),
        problems("day08", "day09", "day10"),
    )
    assert (seen.runs, new.runs) == (("day8", "day9"), ("day10",))
    assert padded.runs == ("day08", "day09")
    for one, other in ((seen, padded), (new, padded_new)):
        np.testing.assert_array_equal(one.friction_misfit, other.friction_misfit)
        np.testing.assert_array_equal(one.rows, other.rows)
