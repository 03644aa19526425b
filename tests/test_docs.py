"""What the README says is true: its table of commands, its quick start, its comparison."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from docs.compare_with_paper import comparison, markdown
from frictioncli.cli.commands import app

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def between(name):
    return README.split(f"<!-- {name} -->\n")[1].split(f"<!-- /{name} -->")[0].strip()


def quick_start():
    block = README.split("## Quick start\n")[1].split("\n\n")[0]
    return [line.strip() for line in block.splitlines() if line.strip().startswith("frictioncli")]


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """The work folder that the commands of the quick start leave."""
    folder = tmp_path_factory.mktemp("quick") / "friction-run"
    for line in quick_start():
        words = [word.replace("friction-run", str(folder)) for word in shlex.split(line)[1:]]
        done = subprocess.run(
            [sys.executable, "-m", "frictioncli", *words],
            cwd=ROOT,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == 0, f"{line}: {done.stderr}"
        if words[0] == "run":
            published = markdown(comparison(folder))
    return folder, published


def test_quick_start_leaves_a_report(work):
    folder, _ = work
    assert "What the simulation gets wrong" in (folder / "report" / "index.html").read_text("utf-8")


def test_comparison_in_the_readme_is_what_the_sample_logs_give(work):
    """To the last digit but one: libraries may differ in the last."""
    _, published = work
    stated, found = between("comparison").splitlines(), published.splitlines()
    assert len(stated) == len(found)
    number = re.compile(r"-?\d+\.?\d*")
    for one, other in zip(stated, found, strict=True):
        assert number.sub("#", one) == number.sub("#", other)
        for left, right in zip(number.findall(one), number.findall(other), strict=True):
            assert float(left) == pytest.approx(float(right), rel=0.06, abs=0.06), one


def test_table_of_commands_lists_every_command():
    listed = re.findall(r"^\| `(\w+)` \|", between("commands"), flags=re.MULTILINE)
    registered = {command.callback.__name__ for command in app.registered_commands}
    assert set(listed) == registered


def test_files_that_the_readme_points_to_exist():
    for target in re.findall(r"\]\((?!https)([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
