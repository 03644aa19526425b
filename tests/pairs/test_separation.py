"""Equation (8) undoes the superposition of load and friction."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.pairs.separation import (
    half_differences,
    inferred_sign,
    separate_torques,
    sign_conventions,
)
from frictioncli.pairs.separation import separate as separate_batch
from tests.moves import batches

torque = st.floats(-1e4, 1e4)


@given(friction=torque, load=torque, sign=st.sampled_from([1, -1]))
def test_separation_undoes_superposition(friction, load, sign):
    separated = separate_torques(
        torque_forward=[load + sign * friction], torque_reverse=[load - sign * friction], sign=sign
    )
    np.testing.assert_allclose(separated.friction, [friction], atol=1e-9)
    np.testing.assert_allclose(separated.load, [load], atol=1e-9)


def test_the_papers_convention():
    """Equation (7): u+ = lg - tau, u- = lg + tau, here with lg = 40 and tau = 15."""
    separated = separate_torques(torque_forward=25.0, torque_reverse=55.0, sign=-1)
    assert separated == (15.0, 40.0)


def test_shapes_must_agree():
    with pytest.raises(ValueError, match="differ in shape"):
        separate_torques(torque_forward=[1.0], torque_reverse=[1.0, 2.0])


def separate(pairs, sign=None, rows=7):
    """Separate pairs that come so many rows at a time."""
    signs = sign_conventions(batches(pairs, rows), sign)
    parts = [separate_batch(batch, signs) for batch in batches(pairs, rows)]
    return pa.Table.from_batches(parts).to_pandas(), signs


def pairs(friction, run="a", joint=2):
    load = np.linspace(-50, 50, len(friction))
    return pd.DataFrame(
        {
            "run": run,
            "joint": joint,
            "pair": range(len(friction)),
            "torque_forward": load + friction,
            "torque_reverse": load - friction,
            "load": np.nan,
        }
    ).astype({"joint": np.int16})


@pytest.mark.parametrize("sign", [1, -1])
def test_sign_is_inferred_so_that_friction_opposes_motion(sign):
    friction = np.random.default_rng(1).normal(10.0, 3.0, 30)
    torques, signs = separate(pairs(sign * friction))
    assert signs == {2: sign}
    np.testing.assert_allclose(torques["friction_torque"], friction)


def test_a_forced_sign_is_obeyed():
    torques, signs = separate(pairs(np.full(5, 10.0)), sign=-1)
    assert signs == {2: -1}
    assert (torques["friction_torque"] == -10.0).all()


def test_contradicting_runs_are_refused():
    both = pairs(np.repeat([10.0, -10.0], 5)).assign(run=np.repeat(["a", "b"], 5))
    with pytest.raises(NotEnoughData, match="contradict"):
        inferred_sign(2, half_differences(batches(both, 3))[2])


def test_a_load_channel_takes_the_place_of_the_half_sum():
    torques, _ = separate(pairs(np.full(4, 3.0)).assign(load=[7.0, np.nan, 7.0, 7.0]))
    np.testing.assert_allclose(torques["load_torque"], [7.0, -50 / 3, 7.0, 7.0])


def test_other_signs_are_refused():
    with pytest.raises(OptionError):
        separate(pairs(np.full(4, 3.0)), sign=2)


@given(rows=st.integers(1, 60), seed=st.integers(0, 100))
def test_half_differences_are_means_of_pairs_however_the_rows_come(rows, seed):
    generator = np.random.default_rng(seed)
    bins = generator.integers(1, 6, 12)
    table = pairs(generator.normal(10, 3, bins.sum()))
    table["pair"] = np.repeat(np.arange(12), bins)
    table["run"] = np.repeat(["a", "a", "b"], [bins[:4].sum(), bins[4:8].sum(), bins[8:].sum()])
    half = (table["torque_forward"] - table["torque_reverse"]) / 2
    expected = half.groupby([table["run"], table["pair"]]).mean().groupby(level=0)
    found = half_differences(batches(table, rows))[2]
    assert {run: tally.count for run, tally in found.items()} == {"a": 8, "b": 4}
    for run, tally in found.items():
        assert tally.mean == pytest.approx(expected.mean()[run])
        deviation = np.sqrt(tally.squares / (tally.count - 1))
        assert deviation == pytest.approx(expected.std()[run])
