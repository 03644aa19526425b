"""Columns of one file at the times of another, in step."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.logs.log_source import RawBatch
from frictioncli.logs.runs.merging import MergedLog, SecondaryFile

from .logs import REAL


class Columns:
    """A source in memory."""

    form = "memory"
    path = REAL / "nothing"
    files = (path,)

    def __init__(self, **columns):
        self.columns = tuple(columns)
        self.values = [np.asarray(values, float) for values in columns.values()]

    def batches(self, columns, size):
        for start in range(0, len(self.values[0]), size):
            part = slice(start, start + size)
            values = {column: self.values[column][part] for column in columns}
            lines = np.arange(len(self.values[0]))[part] + 1
            yield RawBatch(lines, values, np.empty(0, np.int64), ())


def merged(base, other, *, held=()):
    columns = tuple(range(1, len(other.columns)))
    secondary = SecondaryFile(other, 0, 1.0, 0.004, columns, frozenset(held))
    return MergedLog(base, 0, (secondary,), (*base.columns, *other.columns[1:]))


def rows_of(log, size):
    batches = list(log.batches(range(len(log.columns)), size))
    values = [np.concatenate([b.values[i] for b in batches]) for i in range(len(log.columns))]
    lines = np.concatenate([batch.lines for batch in batches])
    bad = np.concatenate([batch.bad_lines for batch in batches])
    return lines, bad, values


@settings(max_examples=40)
@given(
    size=st.integers(1, 400),
    shift=st.floats(-0.003, 0.003),
    wild=st.lists(
        st.tuples(st.integers(0, 199), st.sampled_from([-5.0, 0.0, 0.31, 1e9])), max_size=6
    ),
    gap=st.integers(0, 150),
)
def test_merging_is_interpolation_whatever_the_batches(size, shift, wild, gap):
    """Beside numpy's interpolation of the whole; damaged stamps cost their own rows only."""
    time = 0.1 + 0.012 * np.arange(200) + shift
    for row, stamp in wild:
        time[row] = stamp
    other_time = 0.004 * np.arange(650)
    keep = (np.arange(650) < 3 * gap) | (np.arange(650) > 3 * gap + 20)
    other_time = other_time[keep]
    wave = np.sin(other_time)
    steps = np.floor(other_time * 3)
    other = Columns(t=other_time, wave=wave, steps=steps)
    lines, bad, (t, value, held) = rows_of(merged(Columns(t=time), other, held=(2,)), size)
    after = np.searchsorted(other_time, time)
    inside = (time >= other_time[0]) & (time <= other_time[-1])
    around = np.clip(after, 1, len(other_time) - 1)
    spacing = other_time[around] - other_time[around - 1]
    at_row = np.min(np.abs(time[:, None] - other_time), axis=1) < 1e-9
    has = inside & ((spacing < 0.01) | at_row)
    unclear = np.min(np.abs(time[:, None] - other_time), axis=1) < 1e-5
    checked = has | ~unclear
    checked[[row for row, _ in wild]] = False
    np.testing.assert_array_equal(np.isin(np.arange(1, 201), lines)[checked], has[checked])
    np.testing.assert_array_equal(np.sort(np.concatenate((lines, bad))), np.arange(1, 201))
    np.testing.assert_allclose(value, np.interp(t, other_time, wave), atol=1e-12)
    last = np.searchsorted(other_time, t + 4e-6, side="right") - 1
    np.testing.assert_array_equal(held, steps[last])


def test_merging_holds_one_batch_of_each_file(tmp_path):
    """The base's first stamp lies far ahead: the other file is gone through, not kept."""
    alive = []

    class Watched(Columns):
        def batches(self, columns, size):
            for batch in super().batches(columns, size):
                alive.append(batch)
                yield batch
                alive.pop()

    time = np.concatenate(([1e9], 0.012 * np.arange(1000)))
    other = Watched(t=0.004 * np.arange(3000), wave=np.arange(3000.0))
    _, bad, (_, value) = rows_of(merged(Columns(t=time), other), 50)
    assert bad.tolist() == [1]
    np.testing.assert_allclose(value, 3.0 * np.arange(1000), atol=1e-6)
    assert len(alive) <= 2
