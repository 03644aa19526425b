"""Tasks done ahead in threads: order of results, number of waiting tasks, errors."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.logs.log_source import ReadTask
from frictioncli.logs.samples.read_ahead import _grouped, in_order


@given(st.lists(st.integers(), max_size=40))
def test_results_come_in_the_order_of_the_tasks(numbers):
    assert list(in_order([lambda n=n: 3 * n for n in numbers])) == [3 * n for n in numbers]


def test_a_slow_first_task_does_not_let_others_overtake():
    gate = threading.Event()

    def slow():
        assert gate.wait(10)
        return "slow"

    def fast():
        gate.set()
        return "fast"

    assert list(in_order([slow, fast])) == ["slow", "fast"]


def test_only_a_few_tasks_are_taken_ahead():
    taken = []

    def tasks():
        for number in range(100):
            taken.append(number)
            yield lambda: None

    results = in_order(tasks())
    next(results)
    assert len(taken) <= 8
    results.close()


def test_an_error_comes_where_its_result_would():
    def wrong():
        raise ValueError("wrong")

    results = in_order([lambda: 1, wrong, lambda: 3])
    assert next(results) == 1
    with pytest.raises(ValueError, match="wrong"):
        next(results)


def test_few_results_of_tiny_files_wait():
    """Their size in the file tells nothing of what their rows take."""
    files = 3000
    taken = []

    def tasks():
        for number in range(files):
            taken.append(number)
            yield ReadTask(lambda n=number: n, 1)

    groups = _grouped(tasks())
    assert next(groups)() == list(range(256))
    assert len(taken) == 257
    assert [n for group in groups for n in group()] == list(range(256, files))
