"""Histories of changes: when they were there, the ones that are tried, and the one that fits."""

import numpy as np
import pytest

from frictioncli.effects.history import (
    distinct,
    history,
    presence,
    present,
    rescaled,
    run_spans,
    since_start,
    stretches,
    with_run,
)
from frictioncli.effects.history_search import histories, leaves_out, refined_history
from frictioncli.effects.history_text import history_text
from tests.effects.tables import small

DAYS = ("day1", "day2", "day3")


def days(runs=3, pairs=80, every=360.0):
    """Return runs of so many pairs, four to a series, one every six minutes."""
    number = np.arange(runs * pairs)
    return small(
        run=number // pairs,
        pair=number,
        order=number % 4.0,
        time=every * (number % pairs),
        clock=every * number,
    )


def there(table, shape):
    """Return the hours of each run in which a change is there, first and last of each run."""
    rows = presence(table, shape) > 0
    return [
        (table.time[rows & (table.run == run)] / 3600.0)[[0, -1]].tolist()
        if np.any(rows & (table.run == run))
        else None
        for run in np.unique(table.run)
    ]


def test_a_change_is_there_from_its_moment_up_to_its_end():
    share = np.arange(8) / 8
    assert present(share, {"moment": 0.25, "end": 0.5}).tolist() == [0, 0, 1, 1, 0, 0, 0, 0]
    assert present(share, {"moment": 0.5}).tolist() == [0, 0, 0, 0, 1, 1, 1, 1]
    twice = history([(0.75, 1.0), (0.0, 0.25)])
    assert present(share, twice).tolist() == [1, 1, 0, 0, 0, 0, 1, 1]
    assert not present(share, history([])).any()
    assert stretches(history([(0.5, 0.25)])) == []


def test_a_run_s_history_is_replaced_without_touching_that_of_the_others():
    shape = history([(0.1, 0.9)])
    assert stretches(with_run(shape, (0.25, 0.5), [])) == [(0.1, 0.25), (0.5, 0.9)]
    assert stretches(with_run(shape, (0.5, 1.0), [(0.7, 0.8)])) == [(0.1, 0.5), (0.7, 0.8)]
    assert stretches(with_run(history([]), (0.5, 1.0), [(0.5, 1.0)])) == [(0.5, 1.0)]


def test_a_lasting_change_goes_on_in_pairs_to_come_and_a_stretch_stays_where_it_is():
    assert rescaled(history([(0.2, 0.4), (0.6, 1.0)]), 0.5) == history([(0.1, 0.2), (0.3, 1.0)])


def test_what_is_there_at_first_counts_as_the_base():
    """Also where the first runs are not the ones at hand."""
    share = np.arange(4) / 8
    lasting = history([(0.25, 1.0)])
    assert since_start(lasting, share) == lasting
    assert since_start(history([(0.0, 0.25)]), share) == lasting
    twice = history([(0.0, 0.125), (0.25, 0.375), (0.5, 1.0)])
    assert stretches(since_start(twice, share)) == [(0.125, 0.25), (0.375, 0.5)]
    assert since_start(twice, share + 0.25) == history([(0.125, 0.25), (0.375, 0.5)])
    assert since_start(lasting, share + 0.5) == history([(0.0, 0.25)])


def test_runs_span_all_pairs():
    assert run_spans(days()) == [(0.0, 1 / 3), (1 / 3, 2 / 3), (2 / 3, 1.0)]
    assert run_spans(days(1)) == [(0.0, 1.0)]


@pytest.mark.parametrize("runs", [1, 2, 3, 12, 60])
def test_histories_tried_are_few_different_and_neither_everywhere_nor_nowhere(runs):
    table = days(runs, pairs=40)
    tried = histories(table)
    assert 0 < len(tried) <= 250
    columns = {presence(table, shape).tobytes() for shape in tried}
    assert len(columns) == len(tried)
    assert all(0 < presence(table, shape).mean() < 1 for shape in tried)


@pytest.mark.parametrize(("pairs", "most"), [(80, False), (4000, True)])
def test_a_grid_of_250_histories_leaves_out_series_of_long_runs_only(pairs, most):
    table = days(2, pairs=pairs)
    assert leaves_out(table, np.flatnonzero(table.run == 0), histories(table)) is most


def test_lasting_recurring_and_single_stretches_are_tried():
    table = days()
    tried = [tuple(map(tuple, stretches(shape))) for shape in histories(table)]
    assert ((1 / 3, 1.0),) in tried  # from the second day on
    assert ((1 / 3, 2 / 3),) in tried  # on the second day
    noon = [there(table, history(parts)) for parts in tried if len(parts) == 3]
    assert [[4.0, 7.9]] * 3 in [[pytest.approx(own) for own in one] for one in noon]
    lunch = [one for one in noon if all(own[0] > 0 and own[1] < 7.9 for own in one)]
    assert lunch  # a recurring change that also ends


def test_one_history_of_each_column_is_kept():
    first_day = np.arange(10) / 30
    kept = distinct(
        [history([(0.1, 1.0)]), history([(0.1, 1 / 3)]), history([(0.5, 1.0)])], first_day
    )
    assert kept == [history([(0.1, 1.0)])]


def likeness(table, truth):
    """Return minus the number of pairs in which a history and the true one differ."""
    true = presence(table, truth)
    return lambda shape: -float(np.sum(presence(table, shape) != true))


@pytest.mark.parametrize(
    "moments", [(41, 57, 30), (3, 12, 66), (40, 40, 40)], ids=["differ", "far apart", "same"]
)
def test_moments_that_differ_from_run_to_run_are_found_to_the_pair(moments):
    table = days()
    truth = history(((80 * run + at) / 240, (run + 1) / 3) for run, at in enumerate(moments))
    score = likeness(table, truth)
    first = max(histories(table), key=score)
    found = refined_history(first, table, np.arange(240), score)
    np.testing.assert_array_equal(presence(table, found), presence(table, truth))


def test_a_change_on_every_second_run_is_found():
    table = days(5, 20)
    truth = history([(0.2, 0.4), (0.6, 0.8)])
    score = likeness(table, truth)
    first = max(histories(table), key=score)
    assert score(first) < 0
    assert refined_history(first, table, np.arange(100), score) == pytest.approx(truth)


def test_a_run_that_is_not_searched_keeps_its_history():
    table = days()
    truth = history([(0.21, 1 / 3)])
    found = refined_history(
        history([(0.25, 1.0)]), table, np.flatnonzero(table.run == 0), likeness(table, truth)
    )
    assert stretches(found)[0][0] == pytest.approx(51 / 240)
    assert present(np.arange(80, 240) / 240, found).all()


NOON = [(40 / 240, 80 / 240), (120 / 240, 160 / 240), (200 / 240, 1.0)]


@pytest.mark.parametrize(
    ("parts", "text"),
    [
        ([(1 / 3, 2 / 3)], "in run day2"),
        ([(1 / 3, 1.0)], "from run day2 on"),
        ([(2 / 3, 1.0)], "in run day3"),
        ([(40 / 240, 1.0)], "from 4.0 h of run day1 on"),
        ([(40 / 240, 1 / 3)], "in run day1 from 4.0 h on"),
        ([(200 / 240, 1.0)], "in run day3 from 4.0 h on"),
        ([(100 / 240, 111 / 240)], "in run day2 from 2.0 to 3.0 h"),
        ([(1 / 3, 91 / 240)], "in run day2 up to 1.0 h"),
        ([(40 / 240, 91 / 240)], "from 4.0 h of run day1 to 1.0 h of run day2"),
        ([(0.0, 2 / 3)], "from run day1 to the end of run day2"),
        (NOON, "from 4.0 h on in every run"),
        ([(begin, begin + 11 / 240) for begin, _ in NOON], "from 4.0 to 5.0 h in every run"),
        (NOON[:2], "in run day1 from 4.0 h on and in run day2 from 4.0 h on"),
        (
            [NOON[0], (150 / 240, 160 / 240), NOON[2]],
            "in run day1 from 4.0 h on and in run day2 from 7.0 h on and in run day3 from 4.0 h on",
        ),
        ([(0.0, 1 / 3), (2 / 3, 1.0)], "in runs day1 and day3"),
        ([], "in no run"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_history_in_words(parts, text):
    assert history_text(history(parts), days(), DAYS) == text


def test_a_single_run_needs_no_name_and_short_ones_have_minutes_or_seconds():
    shape = history([(0.5, 1.0)])
    assert history_text(shape, days(1), ["log"]) == "from 4.0 h on"
    assert history_text(history([(0.25, 0.7)]), days(1), ["log"]) == "from 2.0 to 5.5 h"
    assert history_text(shape, days(1, every=20.0), ["log"]) == "from 13 min on"
    assert history_text(shape, days(1, every=2.0), ["log"]) == "from 80 s on"
