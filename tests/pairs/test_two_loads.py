"""Moves that carry a load in turns, which no channel tells, are told by their torques."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

from frictioncli.pairs.two_loads import loads_in_turns, two_loads

PAIRS = 80


def pairs_of(forward, reverse, seed=0, drift=0.0, speeds=(10.0, 30.0, 60.0), carrying=None):
    """Return pairs of a joint of 20 N·m of gravity, whose moves carry shares of it besides.

    Where ``carrying`` is a speed, moves at another one carry nothing.
    """
    generator = np.random.default_rng(seed)
    parts = []
    for pair in range(PAIRS):
        low = generator.uniform(-60.0, 20.0)
        angle = np.arange(low, low + 50.0, 5.0)
        speed, warm = generator.choice(speeds), 20.0 + pair / 4
        torque = []
        for way, more in ((1, forward[pair]), (-1, reverse[pair])):
            more *= carrying in (None, speed)
            load = 20.0 * (1 + more) * np.cos(np.radians(angle))
            friction = 4.0 + 0.006 * load**2 + (0.2 + 1.2 * np.exp(-0.05 * warm)) * speed**0.5
            torque.append(load + way * (friction + drift * pair / PAIRS))
        columns = {"torque_forward": torque[0], "torque_reverse": torque[1]}
        noisy = {name: one + 0.1 * generator.normal(size=10) for name, one in columns.items()}
        told = {"run": "day", "joint": 3, "pair": pair, "speed": speed, "motor_temperature": warm}
        parts.append(pd.DataFrame({**told, "position": angle, **noisy}))
    return pd.concat(parts, ignore_index=True)


def in_turns(seed=1):
    return 0.25 * np.random.default_rng(seed).integers(0, 2, (2, PAIRS))


def test_a_load_that_comes_and_goes_is_found():
    forward, reverse = in_turns()
    rows = pairs_of(forward, reverse)
    found = two_loads(rows, 1)
    assert found is not None
    assert found.mixed == pytest.approx(np.mean(forward != reverse))
    weight = 5.0 * np.cos(np.radians(rows["position"]))
    assert found.difference == pytest.approx(np.sqrt(np.mean(weight**2)), rel=0.05)
    batches = pa.Table.from_pandas(rows.assign(joint=3)).to_batches(max_chunksize=300)
    ((joint, text),) = loads_in_turns(batches, {3: 1}, "A").items()
    assert joint == 3
    assert text.startswith("its moves carry two loads in turns")
    assert "column payload" in text


def test_the_other_sign_convention_is_as_good():
    rows = pairs_of(*in_turns())
    turned = rows.assign(
        torque_forward=rows["torque_reverse"], torque_reverse=rows["torque_forward"]
    )
    one, other = two_loads(rows, 1), two_loads(turned, -1)
    assert one is not None
    assert other is not None
    assert other.mixed == pytest.approx(one.mixed)


def test_a_load_that_goes_with_speed_and_direction_may_be_friction():
    """Fast moves forward carry 5 N·m, and of two speeds nothing tells how friction goes on."""
    rows = pairs_of(np.full(PAIRS, 0.25), np.zeros(PAIRS), speeds=(20.0, 60.0), carrying=60.0)
    found = two_loads(rows, 1)
    assert found is not None
    assert found.mixed > 0.4
    assert ("may carry" in found.text("A")) == (not found.sure)


@pytest.mark.parametrize("drift", [0.0, 3.0])
def test_one_load_is_one(drift):
    nothing = np.zeros(PAIRS)
    assert two_loads(pairs_of(nothing, nothing, drift=drift), 1) is None


def test_a_payload_for_the_second_half_does_not_come_in_turns():
    later = np.where(np.arange(PAIRS) < PAIRS / 2, 0.0, 0.25)
    assert two_loads(pairs_of(later, later), 1) is None


def test_moves_that_are_paired_by_their_payload_give_no_warning():
    """Two loads, but no pair has both."""
    forward, _ = in_turns()
    batches = pa.Table.from_pandas(pairs_of(forward, forward)).to_batches()
    assert not loads_in_turns(batches, {3: 1}, "N·m")
