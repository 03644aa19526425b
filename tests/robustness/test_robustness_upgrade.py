"""Work folders that the first version 0.1.0 has made are read, or refused in a sentence.

``data/work-0.1.0.zip`` was made by the program as it was at commit 2832135, from four recordings of
friction by equation (16) with the parameters of :data:`tests.robustness.runs.TRUTH`.
"""

import json
import shutil
import zipfile
from pathlib import Path

import pytest

from tests.design.few_programmes import few_programmes
from tests.robustness.runs import TRUTH
from tests.studies.fuzz_call import call

STORED = Path(__file__).with_name("data") / "work-0.1.0.zip"


@pytest.fixture
def old(tmp_path):
    with zipfile.ZipFile(STORED) as packed:
        packed.extractall(tmp_path / "work")
    return tmp_path / "work"


@pytest.mark.parametrize(
    "words",
    [
        *(["pair"], ["separate"], ["fit"], ["simulate"], ["evaluate"], ["export", "--to", "json"]),
        *(pytest.param([one], marks=pytest.mark.long) for one in ("diagnose", "plan")),
        pytest.param(["report"], marks=pytest.mark.slow),
        *(["simulate", "--extended"], ["compare"]),
    ],
    ids=lambda words: " ".join(words),
)
def test_every_stage_reads_what_the_first_version_made_or_says_why_not(old, words):
    arguments = [*words, "-w", str(old)]
    if words == ["compare"]:
        shutil.copytree(old, old.with_name("other"))
        arguments = [*words, str(old), str(old.with_name("other")), "-w", str(old.with_name("out"))]
    with few_programmes():
        status, said = call(arguments)
    assert status in (0, 2), said
    if status == 2:
        assert 1 <= len(said.splitlines()) <= 2
        assert any(word in said for word in ("again", "expected", "once")), said


def test_its_torques_give_the_parameters_that_they_were_made_with(old):
    status, said = call(["fit", "-w", str(old)])
    assert status == 0, said
    model = json.loads((old / "model.json").read_text(encoding="utf-8"))
    for name in ("tau_c", "beta", "gamma", "delta"):
        low, high = model["parameters"][name]["ci95"]
        assert low <= TRUTH[name] <= high


@pytest.mark.parametrize("words", [["simulate"], ["evaluate"], ["export", "--to", "c"]])
def test_a_model_of_another_joint_is_told(old, words):
    model = json.loads((old / "model.json").read_text(encoding="utf-8"))
    (old / "model.json").write_text(json.dumps(model | {"joint": 3}), encoding="utf-8")
    status, said = call([*words, "-w", str(old)])
    assert status == 2
    expected = "of joint 3, but torques.parquet in the same folder has joint(s) 2"
    assert f"{old / 'model.json'}: {expected}" in said
    assert not (old / "export").exists()
