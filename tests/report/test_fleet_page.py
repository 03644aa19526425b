"""The page of a fleet: what its rows hold, and in which order."""

import json
import re

import pytest

from frictioncli.report.fleet_page import fleet_html, fleet_page

DONE = {
    "robot": "A",
    "joint": 2,
    "runs": 3,
    "status": "done",
    "message": "",
    "torque_unit": "N·m",
    "verdict": "no_evidence",
    "causes": "",
    "friction_40": 30.123456789,
    "change": 0.2,
    "change_low": -0.5,
    "change_high": 0.9,
    "friction_by_run": [-0.1, -0.1, 0.2],
}
WORN = DONE | {"joint": 3, "change": 2.0, "change_low": 1.0, "change_high": 3.0}
NAMED = DONE | {"joint": 4, "verdict": "named", "causes": "thermal_lag; drift or run_in"}
FAILED = {"robot": "A", "joint": 5, "status": "failed", "message": "000.csv: 'abc'"}
ROWS = [DONE, NAMED, WORN, FAILED]


def column(page, key):
    keys = [one["key"] for one in page.data["columns"]]
    return [row[keys.index(key)] for row in page.data["rows"]]


def test_failed_and_changed_joints_come_first():
    page = fleet_page(ROWS, ["", "", "", ""])
    assert column(page, "joint") == ["5", "3", "4", "2"]
    assert column(page, "changed") == [False, True, False, False]
    assert column(page, "verdict") == ["failed", "no evidence", "named", "no evidence"]


def test_groups_count_the_joints():
    page = fleet_page(ROWS, ["", "", "", ""])
    assert {choice.name: choice.count for choice in page.choices} == {
        "all joints": 4,
        "changed": 1,
        "failed": 1,
        "named": 1,
        "no evidence": 2,
    }
    assert {number.name: number.value for number in page.key_numbers} == {
        "done": "3 of 4",
        "changed since the earlier runs": "1 of 3",
        "cause named": "1 of 3",
    }


def test_cells_are_those_of_the_row():
    page = fleet_page([NAMED, FAILED], ["robot=A/joint=4/report/index.html", ""])
    assert column(page, "page") == [None, "robot=A/joint=4/report/index.html"]
    assert column(page, "causes") == ["000.csv: 'abc'", "thermal lag; drift or run-in"]
    assert column(page, "change")[1] == [0.2, -0.5, 0.9]
    assert column(page, "friction_40")[1] == pytest.approx(DONE["friction_40"], rel=1e-6)
    points, band = column(page, "friction_by_run")[1]
    assert points == DONE["friction_by_run"]
    assert band == pytest.approx(0.05 * DONE["friction_40"], rel=1e-6)


def test_a_year_of_days_is_drawn_as_sixty_means():
    days = [float(day) for day in range(360)]
    points, _ = column(fleet_page([DONE | {"friction_by_run": days}], [""]), "friction_by_run")[0]
    assert points == [2.5 + 6 * number for number in range(60)]


def test_units_stand_in_the_headings_or_in_the_rows():
    def titles(rows):
        page = fleet_page(rows, [""] * len(rows))
        return {one["key"]: one["title"] for one in page.data["columns"]}

    assert titles([DONE])["change"] == "change [N·m]"
    mixed = titles([DONE, DONE | {"torque_unit": "A"}])
    assert mixed["change"] == "change"
    assert mixed["torque_unit"] == "unit"


def test_the_reference_is_the_temperature_that_most_joints_reach():
    cold = [DONE | {"friction_40": None, "friction_20": 40.0} for _ in range(2)]
    titles = [one["title"] for one in fleet_page([DONE, *cold], [""] * 3).data["columns"]]
    assert "friction at 20\N{NO-BREAK SPACE}°C [N·m]" in titles


def test_a_huge_fleet_is_cut_and_says_so(monkeypatch):
    monkeypatch.setattr("frictioncli.report.fleet_page._MOST_ROWS", 2)
    page = fleet_page(ROWS, [""] * 4)
    assert column(page, "joint") == ["5", "3"]
    assert "fleet.parquet has all" in page.left_out


def test_names_of_robots_are_harmless():
    hostile = "</script><script>alert(1)</script>\u202e"
    html = fleet_html([DONE | {"robot": hostile}], [""])
    block = re.search(r'<script type="application/json" id="fleet">(.*?)</script>', html, re.DOTALL)
    assert not set("<>\u202e") & set(block[1])
    assert json.loads(block[1])["rows"][0][0].startswith("</script>")
    assert html.count("<script") == 2
