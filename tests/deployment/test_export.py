"""The command and the stage: one file, its path and its loss told; several joints, bad input."""

from dataclasses import replace

import pytest

from frictioncli.deployment.document import load_deployed
from frictioncli.deployment.settings import TARGETS, ExportSettings
from frictioncli.errors import OptionError, TableError
from frictioncli.model.document import write_models
from frictioncli.provenance import Provenance, sha256
from frictioncli.stages.export import export
from tests.command_line import invoke
from tests.deployment.joints import joint


@pytest.fixture
def work(tmp_path):
    """A work folder with a model."""
    write_models(tmp_path / "model.json", [joint().model], Provenance("fit"))
    return tmp_path


@pytest.mark.parametrize("target", TARGETS)
def test_each_target_is_one_file_whose_path_is_told_first(work, target):
    done = export(work, ExportSettings(to=target))
    assert done.path.is_file()
    assert [path.name for path in (work / "export").iterdir()] == [done.path.name]
    assert str(done).splitlines()[0] == str(done.path)
    assert "lost" in str(done)
    text = done.path.read_text(encoding="utf-8")
    assert sha256(work / "model.json") in text
    export(work, ExportSettings(to=target))
    assert done.path.read_text(encoding="utf-8") == text


def test_the_command_says_what_the_stage_says(work):
    """Minutes on the command line are seconds inside."""
    result = invoke("export", "--to", "json", "-w", work, "--k", 3, "--tmax", 20)
    path, *_ = result.stdout.splitlines()
    rule = load_deployed(work / "export" / "friction-joint2.json").schedule
    assert path == str(work / "export" / "friction-joint2.json")
    assert (rule.k, rule.tmax) == (3.0, 1200.0)


def test_one_of_several_joints_must_be_chosen(work):
    models = [replace(joint().model, joint=number) for number in (1, 3)]
    write_models(work / "model.json", models, Provenance("fit"))
    for wrong in (None, 2):
        with pytest.raises(OptionError, match=r"has joint\(s\) 1, 3"):
            export(work, ExportSettings(to="c", joint=wrong))
    assert export(work, ExportSettings(to="c", joint=3)).path.name == "friction-joint3.h"
    assert not (work / "export" / "friction-joint2.h").exists()


def test_missing_inputs_are_named_and_nothing_is_written(tmp_path):
    with pytest.raises(TableError, match="run 'frictioncli fit' first"):
        export(tmp_path, ExportSettings(to="c"))
    with pytest.raises(TableError, match=r"extended-model\.json is missing"):
        export(tmp_path, ExportSettings(to="c", extended=True))
    assert not list(tmp_path.iterdir())
