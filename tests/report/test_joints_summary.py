"""A page of several joints opens with a summary."""

from types import SimpleNamespace

import pytest

from frictioncli.report.first_screen import Answer
from frictioncli.report.joints_summary import joints_summary
from frictioncli.report.page import write_report


def section(number, *levels):
    answers = [Answer(question="How much", value=f"{number} N·m", text="at 40 °C")]
    ratings = [SimpleNamespace(level=level) for level in levels]
    return SimpleNamespace(number=number, answers=answers, ratings=ratings)


def test_a_single_joint_needs_none():
    assert joints_summary([section(1, "good")]) is None


def test_a_line_per_joint_with_its_worst_rating():
    found = joints_summary(
        [section(1, "good", "good"), section(2, "poor", "fair", "fair"), section(3, "fair")]
    )
    assert found.questions == ("How much",)
    assert [(line.number, line.level, line.quality) for line in found.lines] == [
        (1, "good", "all good"),
        (2, "poor", "1 poor, 2 fair"),
        (3, "fair", "1 fair"),
    ]
    assert found.lines[1].answers == (("2 N·m", "at 40 °C"),)


@pytest.mark.usefixtures("without_figures")
def test_it_stands_before_the_first_joint(tmp_path, write_work):
    page = write_report(write_work(tmp_path, joints=(2, 3))).read_text(encoding="utf-8")
    summary, first = page.index('<section id="summary">'), page.index('<section id="joint2">')
    assert summary < first
    assert '<a href="#joint3">joint 3</a>' in page[summary:first]
