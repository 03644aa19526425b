"""The figure of a comparison shows the numbers of its document."""

import html
import re
from datetime import datetime, timedelta

import numpy as np
import pytest

from frictioncli.comparison.document import (
    ComparisonDocument,
    ConditionRecord,
    EstimateRecord,
    MarginRecord,
    MeanFrictionRecord,
    PercentRecord,
    RunRecord,
    ScatterRecord,
    ThresholdRecord,
    TrendRecord,
)
from frictioncli.report.style import style_context
from frictioncli.report.trend_figure import trend_figure, trend_files


def percent(value, half):
    return PercentRecord(estimate=value, ci95=(value - half, value + half), unit="%", p_value=0.01)


def document(*, dated=True, conditions=True, threshold=True):
    start = datetime(2026, 1, 5)
    runs = [
        RunRecord(
            folder="work",
            run=f"day-{number}",
            started_at=(start + timedelta(days=7 * number)).isoformat() if dated else None,
            days=7.0 * number if dated else None,
            surroundings=None,
            measured=number - 1.0,
            level=0.5 * number - 1.0,
            ci95=(0.5 * number - 1.4, 0.5 * number - 0.6),
            unit="%",
        )
        for number in range(5)
    ]
    rows = [
        ConditionRecord(
            temperature=40.0,
            speed=speed,
            load=0.0,
            friction=20.0,
            change=0.8,
            ci95=(0.6, 1.0),
            unit="N·m",
            percent=percent(4.0, 1.0),
            extrapolated=hollow,
        )
        for speed, hollow in ((19.1, False), (101.2, True))
    ]
    rate = EstimateRecord(estimate=0.5, ci95=(0.1, 0.9), unit="%/run")
    return ComparisonDocument(
        verdict="changed",
        weak=False,
        joint=2,
        torque_unit="N·m",
        load_unit="N·m",
        temperature="motor",
        folders=("work",),
        mean_friction=MeanFrictionRecord(estimate=20.0, unit="N·m"),
        trend=TrendRecord(
            change=0.4,
            ci95=(0.1, 0.7),
            unit="N·m",
            percent=percent(2.0, 1.5),
            per_run=rate,
            per_1000_h=rate if dated else None,
        ),
        last_run=None,
        load=None,
        causes=(),
        friction=tuple(rows) if conditions else (),
        parameters={},
        runs=tuple(runs),
        scatter=ScatterRecord(day_to_day=1.0, assumed=1.0, unit="%", surroundings_from="the log"),
        margin=MarginRecord(value=3.0, unit="%"),
        threshold=ThresholdRecord(value=3.0, unit="%", exceeded=False) if threshold else None,
    )


def drawn(**how):
    with style_context("trend"):
        return trend_figure(document(**how))


def test_the_line_rises_by_the_change():
    above = drawn().axes[0]
    line = next(one for one in above.lines if one.get_label() == "trend")
    heights = line.get_ydata()
    assert heights[-1] - heights[0] == pytest.approx(2.0)


def test_the_points_are_the_levels_and_the_hollow_ones_as_measured():
    above = drawn().axes[0]
    hollow = next(one for one in above.lines if one.get_label() == "as measured")
    np.testing.assert_allclose(hollow.get_ydata(), [-1, 0, 1, 2, 3])
    filled = next(
        one for one in above.containers if one.get_label() == "at equal ambient conditions"
    )
    np.testing.assert_allclose(filled.lines[0].get_ydata(), [-1, -0.5, 0, 0.5, 1])


def test_the_threshold_lies_about_the_first_run():
    above = drawn().axes[0]
    limits = sorted(one.get_ydata()[0] for one in above.lines if one.get_linestyle() == "--")
    # the line begins 1 below the mean level, which is 0
    np.testing.assert_allclose(limits, [-1.0 - 3.0, -1.0 + 3.0])
    assert not any(one.get_linestyle() == "--" for one in drawn(threshold=False).axes[0].lines)


def test_conditions_are_named_and_hollow_where_not_measured():
    lower = drawn().axes[1]
    assert [label.get_text() for label in lower.get_yticklabels()] == [
        "40 °C, 19.1 deg/s",
        "40 °C, 101.2 deg/s",
    ]
    assert "hollow" in lower.get_xlabel()


def test_without_conditions_or_dates_there_is_one_panel_over_the_order():
    figure = drawn(dated=False, conditions=False)
    assert len(figure.axes) == 1
    assert figure.axes[0].get_xlabel() == "run, in the order given"


def test_points_show_their_values():
    shown = document()
    element, _ = trend_files(shown)
    titles = [html.unescape(one) for one in re.findall(r"<use [^>]*><title>(.*?)</title>", element)]
    assert len(titles) == len(shown.runs) + len(shown.friction)
    for title, run in zip(titles, shown.runs, strict=False):
        name, value = title.rsplit(": ", 1)
        assert name == f"{run.folder}, {run.run}"
        assert float(value.split(" %")[0].replace("−", "-")) == pytest.approx(run.level, abs=0.06)


def test_pictures_are_the_same_bytes_again():
    text, picture = trend_files(document())
    assert trend_files(document()) == (text, picture)
    assert text.startswith("<svg")
    assert picture.startswith(b"\x89PNG")
