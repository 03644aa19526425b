"""Names and cells that try something: they are shown as they are, and do nothing."""

import base64
import hashlib
import os
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from frictioncli.errors import FrictionError
from frictioncli.stages.ingest import ingest as ingest_stage
from frictioncli.stages.run import run as run_chain
from tests.command_line import called
from tests.logs.logs import kuka_columns, text_of, write
from tests.robustness.runs import finished, refused, write_warm_up

HTML = "<script>alert(1)</script><img src=x onerror=alert(2)>"
ANSI = "\x1b[2J\x1b[31mred\x07"
TURNED = "\u202egnp.exe"


class Elements(HTMLParser):
    """Collects what a page would run or load."""

    def __init__(self):
        super().__init__()
        self.active = []

    def handle_starttag(self, tag, attrs):
        names = {name for name, _ in attrs}
        if tag in ("script", "iframe", "object", "embed", "img", "link", "base", "form"):
            self.active.append((tag, attrs))
        if any(name.startswith("on") for name in names):
            self.active.append((tag, attrs))


def test_hostile_names_are_harmless_in_the_report(tmp_path):
    run = write_warm_up(tmp_path / HTML.replace("/", "|"), levels=(25, 39, 53))
    hostile = run / f"s1{HTML.replace('/', '|')}.csv"
    rows = (run / "s1.csv").read_text(encoding="cp1252").split("\n")
    rows[20] = rows[20] + f";{HTML}"
    hostile.write_text("\n".join(rows), encoding="cp1252")
    (run / "s1.csv").unlink()
    manifest = (run / "manifest.csv").read_text(encoding="utf-8")
    (run / "manifest.csv").write_text(manifest.replace("s1.csv", hostile.name), encoding="utf-8")
    page = run_chain([run], tmp_path / "work")
    text = page.read_text(encoding="utf-8")
    assert "&lt;script&gt;" in text
    for path in (page, *page.parent.glob("*.svg")):
        found = Elements()
        found.feed(path.read_text(encoding="utf-8"))
        # the page's own: numbers, and scripts that the policy names by their hashes
        numbers = [
            ("script", [("type", "application/json"), ("id", f"joint2-{name}")])
            for name in ("grid", "points")
        ]
        scripts = re.findall("<script>(.*?)</script>", text, re.DOTALL)
        own = [*numbers, *[("script", [])] * len(scripts)]
        assert found.active == (own if path == page else []), path
    assert len(scripts) == text.count("'sha256-")
    for script in scripts:
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in text


@pytest.mark.parametrize("command", ["inspect", "ingest"])
@pytest.mark.parametrize("hostile", [ANSI, TURNED, HTML, "=cmd|' /C calc'!A0", "\x9b31m"])
def test_hostile_headers_and_names_are_harmless_on_the_terminal(tmp_path, command, hostile):
    """Columns, file names and texts of faults reach the terminal; nothing in them acts there."""
    columns = kuka_columns()
    columns[f"GearTorq_Act3[Nm] {hostile}"] = columns["GearTorq_Act2[Nm]"]
    (tmp_path / "run").mkdir()
    name = hostile.replace("/", "|")
    (tmp_path / "run" / f"{name}.csv").write_text(text_of(columns), encoding="utf-8")
    (tmp_path / "run" / f"{name}-2.csv").write_text(f"{hostile}\n{hostile}", encoding="utf-8")
    where = () if command == "inspect" else ("-w", tmp_path / "work")
    result = called(command, tmp_path / "run", *where)
    assert result.returncode == 0, result.stderr
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e]", result.stdout)
    assert result.stderr == ""


def test_messages_of_faults_are_harmless_too(tmp_path):
    result = finished("ingest", tmp_path / f"no{ANSI}such", "-w", tmp_path / "work")
    assert result.returncode == 2
    assert "\x1b" not in result.stderr
    assert "such: no such file" in result.stderr


def test_a_file_name_that_is_no_text_is_refused(tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    with open(os.fsencode(run) + b"/\xff\xfe.csv", "w", encoding="utf-8") as stream:
        stream.write(text_of(kuka_columns()))
    for command in (("inspect", run), ("ingest", run, "-w", tmp_path / "work")):
        assert "its name is not UTF-8" in refused(called(*command))


def test_a_work_folder_whose_name_is_no_text_is_refused(tmp_path):
    write(tmp_path / "log.csv", kuka_columns())
    work = os.fsdecode(os.fsencode(tmp_path) + b"/\xff")
    with pytest.raises(FrictionError, match="the name is not UTF-8"):
        ingest_stage([tmp_path / "log.csv"], Path(work))
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]


def test_a_terminal_that_knows_few_characters(tmp_path):
    (tmp_path / "joint τ.csv").write_text(text_of(kuka_columns()), encoding="utf-8")
    env = {"PYTHONIOENCODING": "latin-1", "PYTHONUTF8": "0"}
    result = finished("inspect", tmp_path, env=env)
    assert (result.returncode, result.stderr) == (0, "")
    assert "joint \\u03c4.csv" in result.stdout


def test_nothing_is_written_outside_the_work_folder(tmp_path):
    """Whatever a manifest or a header says."""
    names = ("../../outside", "/etc/outside", "..", "a/../../../outside")
    inside = tmp_path / "a" / "b"
    run = write_warm_up(inside / "run", levels=(25, 39, 53))
    manifest = (run / "manifest.csv").read_text(encoding="utf-8")
    listed = "".join(f"{name};2024-05-18T00:00:00;\n" for name in names)
    (run / "manifest.csv").write_text(manifest + listed, encoding="utf-8")
    header, *rows = (run / "s0.csv").read_text(encoding="cp1252").splitlines()
    lines = [";".join([header, *names]), *(row + ";1" * len(names) for row in rows)]
    (run / "s0.csv").write_text("\n".join(lines), encoding="cp1252")
    before = {path for path in tmp_path.rglob("*")}
    result = called("run", inside, "-w", inside / "work", cwd=inside)
    assert result.returncode == 0, result.stderr
    assert "outside is not a file in the folder" in result.stdout
    made = {path for path in tmp_path.rglob("*")} - before
    assert all(inside / "work" in (path, *path.parents) for path in made)
