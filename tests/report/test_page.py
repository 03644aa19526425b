"""The page is complete, self-contained, safe against hostile names and the same at every call."""

import json
import re
import xml.etree.ElementTree as ElementTree
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import TableError
from frictioncli.report import downloads
from frictioncli.report.page import write_report

HOSTILE = "<script>alert(1)</script>&\"'$\\frac{kr10$\u202e=1+1\x1b"


@pytest.fixture(scope="module")
def hostile_page(tmp_path_factory, write_work):
    work = write_work(tmp_path_factory.mktemp("hostile"), runs=(HOSTILE,))
    model = json.loads((work / "model.json").read_text())
    model["parameters"]["tau_c"]["reason"] = "<img src=x onerror=alert(2)>"
    (work / "model.json").write_text(json.dumps(model))
    return write_report(work, png=True)


def test_folder_holds_the_page_and_two_files_per_figure(hostile_page):
    figures = ["overview", *(f"fig{n}" for n in range(3, 12)), "residuals"]
    wanted = {"index.html", "data"} | {f"{f}.{kind}" for f in figures for kind in ("svg", "png")}
    assert {path.name for path in hostile_page.parent.iterdir()} == wanted
    for path in hostile_page.parent.glob("*.svg"):
        ElementTree.parse(path)
    for path in hostile_page.parent.glob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")


def test_page_escapes_names(hostile_page):
    page = hostile_page.read_text(encoding="utf-8")
    assert "<script>alert" not in page
    assert not re.findall("[\u202a-\u202e\u2066-\u2069\x1b]", page)
    assert "=1+1" in page
    assert "<img" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "&lt;img src=x onerror=alert(2)&gt;" in page


def test_page_needs_nothing_from_elsewhere(hostile_page):
    page = hostile_page.read_text(encoding="utf-8")
    # a link to the paper asks for nothing until it is followed
    paper = "https://doi.org/10.1155/2019/6931563"
    links = set(re.findall(r'(?:src|href)="(?!#)([^"]*)"', page))
    # nor does one to a file that lies beside the page
    assert {link for link in links if not link.startswith("data/")} == {paper}
    for link in links - {paper}:
        assert (hostile_page.parent / link).is_file()
    assert "default-src 'none'" in page
    assert not re.findall(r"url\((?!#)", page)
    assert "@import" not in page
    assert "<link" not in page


def test_headings_skip_no_level(hostile_page):
    levels = [int(level) for level in re.findall(r"<h(\d)", hostile_page.read_text("utf-8"))]
    assert levels[0] == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))


def test_identifiers_are_unique_and_references_hit(hostile_page):
    page = hostile_page.read_text(encoding="utf-8")
    known = re.findall(r'\bid="([^"]+)"', page)
    assert len(known) == len(set(known))
    assert set(re.findall(r'href="#([^"]+)"', page)) <= set(known)
    assert set(re.findall(r"url\(#([^)]+)\)", page)) <= set(known)


def test_same_inputs_give_the_same_bytes_and_replace_the_whole_folder(hostile_page):
    folder = hostile_page.parent
    work = folder.parent
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    (folder / "stale.svg").write_text("old")
    write_report(work, png=True)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert [path.name for path in work.iterdir() if path.name.startswith(".")] == []


@pytest.mark.parametrize(
    ("file", "command"),
    [("torques.parquet", "frictioncli separate"), ("model.json", "frictioncli fit")],
)
def test_missing_inputs_are_named_with_the_command(tmp_path, write_work, file, command):
    work = write_work(tmp_path, runs=("day-1",))
    (work / file).unlink()
    with pytest.raises(TableError, match=file) as caught:
        write_report(work)
    assert command in str(caught.value)
    assert not (work / "report").exists()


def test_damaged_model_is_refused(tmp_path, write_work):
    work = write_work(tmp_path, runs=("day-1",))
    (work / "model.json").write_text("{}")
    with pytest.raises(TableError, match=r"model\.json"):
        write_report(work)


def test_each_joint_has_its_section_and_files(tmp_path, write_work):
    work = write_work(tmp_path, runs=("day-1",), joints=(2, 3), temperature=False)
    page = write_report(work, png=True)
    names = {path.name for path in page.parent.iterdir()}
    assert {"joint2-fig3.svg", "joint3-fig3.svg", "joint3-fig8.png"} <= names
    assert "fig3.svg" not in names
    text = page.read_text(encoding="utf-8")
    assert "Friction of joints 2 and 3" in text
    assert text.count("<h2>Joint ") == 2
    # figures that lack the same are told together
    lacking = re.findall(r"<b>Not drawn: ([^<]*)</b> ([^<]*)", text)
    assert sum(titles.count("Figure ") for titles, _ in lacking) == 14
    assert len(lacking) == 10


@pytest.mark.usefixtures("without_figures")
def test_page_tells_what_became_of_the_data(tmp_path, write_work):
    work = write_work(tmp_path, runs=("day-1",), temperature=False)
    text = write_report(work).read_text(encoding="utf-8")
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", text)
    rows = " | ".join(cells)
    assert "day-1 | 3 | 3,000 | 2,994 | 6" in rows
    assert "not a number | 2 | too few columns | 1" in rows
    assert "not at constant speed | 1,234" in rows
    assert "2.3 deg/s | 0 | 0 | 1 | 1" in rows
    assert "19.1 deg/s | 10 | 30 | 1 | 41" in rows
    assert text.count("sign +1 found") == 1
    assert "ef" * 32 in text
    assert "the log has no temperature; merged into beta" in text


def test_downloads_are_the_tables_of_the_folder(tmp_path, write_work):
    work = write_work(tmp_path, runs=("day-1",))
    data = write_report(work).parent / "data"
    assert (data / "torques.parquet").read_bytes() == (work / "torques.parquet").read_bytes()
    for table in (schemas.TORQUES, schemas.SCHEDULE, schemas.EVALUATION):
        offered = pd.read_csv(data / f"{table.name}.csv")
        known = tables.read(work / f"{table.name}.parquet", table)
        assert list(offered.columns) == list(known.columns)
        assert len(offered) == len(known)
    friction = tables.read(work / "torques.parquet", schemas.TORQUES)["friction_torque"]
    offered = pd.read_csv(data / "torques.csv")["friction_torque"]
    np.testing.assert_allclose(offered, friction, rtol=1e-8)


def test_figures_are_png_files_on_demand_only(tmp_path, write_work):
    work = write_work(tmp_path, runs=("day-1",), temperature=False)
    folder = write_report(work).parent
    assert not list(folder.glob("*.png"))
    assert list(folder.glob("*.svg"))


def test_downloads_hold_nine_digits(tmp_path):
    values = np.array([0.1, -2 / 3, 1e-30, 123456789.123, 1e300, np.pi * 1e12, 0.0, np.nan])
    rows = pd.DataFrame({"run": 'a,"b"', "value": values, "failed": values > 0})
    downloads._write_csv(rows, tmp_path / "rows.csv")
    found = pd.read_csv(tmp_path / "rows.csv")
    assert list(found["run"]) == ['a,"b"'] * len(values)
    assert found["failed"].dtype == bool
    np.testing.assert_allclose(found["value"], values, rtol=5.1e-9)
    texts = [line.split('",')[-1] for line in (tmp_path / "rows.csv").read_text().splitlines()]
    assert texts[1:3] == ['0.1,"True"', '-0.666666667,"False"']
    assert texts[-1] == ',"False"'
