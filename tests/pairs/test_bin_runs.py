"""Runs in one angle bin: what is compiled, numpy and a plain loop agree to the last bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.pairs import bins
from frictioncli.pairs.bins import bin_runs
from tests.compiler import has_compiler


@pytest.mark.skipif(not has_compiler(), reason="no C compiler")
def test_sums_are_compiled_where_a_compiler_is():
    assert bins._bin_runs is not None


def in_a_loop(*, position, torque, load, time, start, stop, width):
    """The runs as one would find them by hand."""
    runs, end = [], []
    for begin, past in zip(start, stop, strict=True):
        before = None
        for i in range(begin, past):
            number = np.floor(position[i] / width)
            if number != before:
                runs.append([number, 0.0, 0.0, 0.0, 0.0, 0])
                before = number
            run = runs[-1]
            for column, values in enumerate((position, torque, load, time), 1):
                run[column] += values[i]
            run[5] += 1
        end.append(len(runs))
    return np.array(runs).T, end


@st.composite
def recordings(draw):
    """Segments with gaps whose angles waver over the edges of bins, and lie on them exactly."""
    generator = np.random.default_rng(draw(st.integers(0, 10**6)))
    width = draw(st.sampled_from([5.0, 0.1, 1 / 3, 2e-7]))
    length = generator.integers(1, 40, 5)
    start = np.cumsum(length + generator.integers(0, 3, 5)) - length
    samples = int(start[-1] + length[-1] + generator.integers(0, 3))
    steps = generator.choice([-1.0, -0.5, 0.0, 0.2, 0.5, 1.0], samples)
    position = width * (draw(st.integers(-2000, 2000)) + np.cumsum(steps))
    torque, load, time = generator.normal(size=(3, samples))
    load[generator.uniform(size=samples) < draw(st.sampled_from([0.0, 0.1, 1.0]))] = np.nan
    return {
        "position": position,
        "torque": torque,
        "load": load,
        "time": time,
        "start": start,
        "stop": start + length,
        "width": width,
    }


@pytest.mark.parametrize("compiled", [True, False])
@given(recording=recordings())
def test_runs_are_those_of_a_plain_loop_to_the_last_bit(compiled, recording):
    with pytest.MonkeyPatch.context() as patch:
        if not compiled:
            patch.setattr(bins, "_bin_runs", None)
        found = bin_runs(**recording)
    (number, *sums, count), end = in_a_loop(**recording)
    assert found.bin.tolist() == number.tolist()
    assert found.count.tolist() == count.tolist()
    assert found.end.tolist() == end
    for values, expected in zip(
        (found.position, found.torque, found.load, found.time), sums, strict=True
    ):
        np.testing.assert_array_equal(values, expected)


@pytest.mark.skipif(bins._bin_runs is None, reason="installed without a C compiler")
@pytest.mark.parametrize(
    ("start", "stop"), [([0], [5]), ([-1], [3]), ([3], [3]), ([0, 2], [4]), ([2**62], [2**62 + 1])]
)
def test_segments_outside_the_samples_are_refused(start, stop):
    samples, room = np.zeros(4), 8
    sums, count, end = np.empty((5, room)), np.empty(room, np.int64), np.empty(len(start), np.int64)
    bounds = np.array(start, np.int64), np.array(stop, np.int64)
    with pytest.raises(ValueError, match="spans inside them"):
        bins._bin_runs.runs(*[samples] * 4, *bounds, 1.0, sums, count, end)
