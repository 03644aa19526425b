"""README and docs are true: table of commands, quick start, comparison with the paper, links."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from docs import folders
from docs.compare_with_paper import comparison, markdown
from frictioncli import schemas, tables
from frictioncli.cli.commands import app
from frictioncli.workfiles import EVALUATION
from tests.sample_run import WORDS, command

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def between(name, text=README):
    return text.split(f"<!-- {name} -->\n")[1].split(f"<!-- /{name} -->")[0].strip()


def quick_start():
    block = README.split("## Quick start\n")[1].split("\n\n")[0]
    return [line.strip() for line in block.splitlines() if line.strip().startswith("frictioncli")]


def recordings(folder, *, every):
    """Return a folder with some recordings of the first day of the sample logs."""
    day = ROOT / "sample_logs" / "kr10" / "day1"
    header, *rows = (day / "manifest.csv").read_text("utf-8").splitlines()
    folder.mkdir()
    (folder / "manifest.csv").write_text("\n".join([header, *rows[::every], ""]), "utf-8")
    for row in rows[::every]:
        shutil.copy(day / row.split(";")[0], folder)
    return folder


@pytest.fixture(scope="module")
def work(tmp_path_factory, sample_run):
    """The work folder that the commands of the quick start leave.

    The paper's method is tried on a few recordings; its comparison below has both days.
    """
    few = recordings(tmp_path_factory.mktemp("few") / "day", every=8)
    folder = sample_run(tmp_path_factory.mktemp("quick") / "friction-run")
    first, *others = quick_start()
    assert shlex.split(first, comments=True)[1:] == [*WORDS, folder.name]
    for line in others:
        words = shlex.split(line, comments=True)[1:]
        words = [str(folder.with_name(word)) if word.endswith("-run") else word for word in words]
        words = [str(few) if word == "sample_logs/kr10" else word for word in words]
        command(*words)
    return folder, markdown(comparison(folder))


def test_quick_start_leaves_a_report(work):
    folder, _ = work
    assert "What the simulation gets wrong" in (folder / "report" / "index.html").read_text("utf-8")


def test_comparison_with_the_paper_is_what_the_sample_logs_give(work):
    """To the last digit but one: libraries may differ in the last."""
    _, published = work
    page = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    stated, found = between("comparison", page).splitlines(), published.splitlines()
    assert len(stated) == len(found)
    number = re.compile(r"-?\d+\.?\d*")
    for one, other in zip(stated, found, strict=True):
        assert number.sub("#", one) == number.sub("#", other)
        for left, right in zip(number.findall(one), number.findall(other), strict=True):
            assert float(left) == pytest.approx(float(right), rel=0.06, abs=0.06), one


def test_the_readme_states_the_error_of_the_extended_model(sample_run, tmp_path):
    folder = sample_run(tmp_path / "friction-run")
    command("evaluate", "-w", str(folder), "--extended")
    found = tables.read(folder / EVALUATION, schemas.EVALUATION)
    found = found[found["criterion"] == "none"].set_index(["phase", "run"])["epsilon"]
    row = next(line for line in README.splitlines() if "`evaluate --extended`" in line)
    stated = [float(number) for number in re.findall(r"\d\.\d+", row)]
    places = [(phase, day) for phase in ("heat-up", "cool-down") for day in ("day1", "day2")]
    assert stated == pytest.approx([found[place] for place in places], abs=0.02)


def test_table_of_commands_lists_every_command():
    listed = re.findall(r"^\| `(\w+)` \|", between("commands"), flags=re.MULTILINE)
    registered = {command.callback.__name__ for command in app.registered_commands}
    assert set(listed) == registered


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_a_page_links_to_exist(page):
    # pages that the site makes from the program: docs/site_hooks.py
    made = {"commands.md", "tables.md", "documents.md", "effects.md"}
    for target in re.findall(r"\]\((?!https)([^)#]+)\)", page.read_text(encoding="utf-8")):
        path = page.parent / target
        is_made = path.parent.name == "reference" and path.name in made | {"python.md"}
        assert is_made or path.exists(), target


def test_the_site_lists_every_page():
    listed = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    for page in PAGES[1:]:
        assert f"- {page.relative_to(ROOT / 'docs').as_posix()}\n" in listed, page.name


def test_the_readme_is_short():
    assert len(README.splitlines()) < 150


def test_the_table_of_folders_is_made_from_the_package():
    page = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    assert between("folders", page) == folders.table().strip(), "run python docs/folders.py"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_modules_that_a_page_names_exist(page):
    """Paths below the package, as ``logs/formats/ros.py``, and folders, as ``logs/formats/``."""
    package = {path.name for path in (ROOT / "frictioncli").iterdir()}
    for text in re.findall(
        r"`(?:frictioncli/)?([a-z_]+/[\w./]*(?:\.py|\.c|\.js|/))`", page.read_text("utf-8")
    ):
        if text.split("/")[0] in package:
            assert (ROOT / "frictioncli" / text).exists(), text
