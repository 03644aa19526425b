"""The page of a comparison tells what ``comparison.json`` holds."""

import msgspec
import pytest

from frictioncli.comparison.document import ParameterChangeRecord
from frictioncli.report.compare_page import compare_html, compare_page
from frictioncli.wording import change_text
from tests.report.test_trend_figure import document

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
