"""The page of a comparison tells what ``comparison.json`` holds."""

import re

import msgspec
import pytest

from frictioncli import __version__
from frictioncli.comparison.document import ParameterChangeRecord
from frictioncli.report.compare_page import compare_html, compare_page
from frictioncli.wording import change_text
from tests.report.page_numbers import Page, agrees, leaves, numbers
from tests.report.test_trend_figure import document

DATE = re.compile(r"\d{4}-\d\d-\d\d")

SVG = '<svg viewBox="0 0 1 1"></svg>'


def page_of(found, pages=None):
    return compare_page(found, SVG, pages or {})


@pytest.mark.parametrize(
    ("verdict", "begins"),
    [
        ("changed", "The joint has changed. "),
        ("no_evidence", "No change was found, and a change of "),
        ("undetermined", "Undetermined: "),
    ],
)
def test_the_verdict_comes_first_with_the_trend(verdict, begins):
    found = msgspec.structs.replace(document(), verdict=verdict)
    text = page_of(found).verdict
    trend = found.trend.percent
    assert text.startswith(begins)
    assert text.endswith(f"{change_text(trend.estimate, trend.ci95, '%')}.")


def test_every_run_and_condition_has_its_row():
    found = document()
    conditions, runs = page_of(found).tables
    assert [row[2] for row in conditions.rows] == [
        change_text(one.change, one.ci95, "") for one in found.friction
    ]
    assert [row[3] for row in runs.rows] == [
        change_text(run.level, run.ci95, "") for run in found.runs
    ]


def test_parameters_that_only_one_model_determines_have_no_change():
    one = ParameterChangeRecord(first=1.0, last=2.0, change=None, ci95=None, unit="N·m")
    found = msgspec.structs.replace(document(), parameters={"tau_c": one})
    page = page_of(found)
    assert page.tables[-1].rows[0][2:] == ("1.00", "2.00", "not in both models")
    assert "compensate each other" in page.parameters_note


def test_two_runs_and_a_threshold_are_said():
    found = msgspec.structs.replace(document(), weak=True, verdict="undetermined")
    first, second, third = page_of(found).caveats
    assert first.startswith("Two runs do not show")
    assert second.startswith("Measure more days")
    assert third.startswith("Threshold")


def test_the_page_holds_the_figure_and_links_to_reports():
    found = document()
    html = compare_html(found, SVG, {found.folders[0]: "../a%20b/report/index.html"})
    assert SVG in html
    assert f'<a href="../a%20b/report/index.html">{found.folders[0]}</a>' in html
    assert "default-src 'none'" in html


def test_every_number_has_a_source():
    parameters = {
        "tau_c": ParameterChangeRecord(first=10.2, last=11.7, change=None, ci95=None, unit="N·m")
    }
    found = msgspec.structs.replace(document(), parameters=parameters)
    page = Page(compare_html(found, SVG, {}))
    sources = [*leaves(msgspec.to_builtins(found)), len(found.runs), len(found.folders)]
    # confidence, and hours of a rate
    sources += [-one for one in sources] + [95.0, 1000.0]
    cells = [
        cell for tables in page.tables.values() for rows in tables for row in rows for cell in row
    ]
    walked = [
        (written, text)
        for text in (*cells, *page.tables, *(text for _, _, text in page.texts))
        for written in numbers(DATE.sub("", text.replace(__version__, "")))
    ]
    assert len(walked) > 30
    assert [one for one in walked if not agrees(one[0], sources)] == []
