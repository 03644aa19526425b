"""The examples and the Python page run as they stand, on the sample logs, and say what is true."""

import importlib
import json
import re
import runpy
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.deployment.document import load_deployed
from frictioncli.deployment.settings import ExportSettings
from frictioncli.diagnosis.documents.apply_extension import friction_beyond
from frictioncli.diagnosis.documents.extended_document import read_extended
from frictioncli.model.document import read_models
from frictioncli.stages.export import deployed, export
from tests.deployment.logged_pairs import instants_before, pairs_of

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def work(tmp_path_factory, sample_run):
    """The work folder that all examples share."""
    return sample_run(tmp_path_factory.mktemp("examples") / "friction-run")


def said(example, work, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [example, str(work)])
    runpy.run_path(str(ROOT / "examples" / f"{example}.py"))
    return capsys.readouterr().out


def test_every_example_is_listed_and_tried():
    table = (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
    tried = {name for name in globals() if name.startswith("test_")}
    for example in EXAMPLES:
        assert f"]({example.name})" in table
        assert f"test_{example.stem}" in tried


def test_what_is_this_joints_friction(work, monkeypatch, capsys):
    """The sample joint has 44 % less friction hot than cold; its truth is in truth.json."""
    text = said("what_is_this_joints_friction", work, monkeypatch, capsys)
    cold, hot = (
        [float(word) for word in re.search(rf"{degrees} °C +(.*)", text)[1].split()]
        for degrees in (25, 65)
    )
    assert 0.35 < 1 - hot[-1] / cold[-1] < 0.5
    added = float(re.search(r"adds ([\d.]+) N·m", text)[1])
    assert added == pytest.approx(0.0014 * 80**2, rel=0.02)


def test_which_units_did_my_log_have(work, monkeypatch, capsys):
    text = said("which_units_did_my_log_have", work, monkeypatch, capsys)
    good, spoilt = text.split("spoilt_010")
    assert good.count("read as deg ") == 2
    assert spoilt.count("[°] read as rad") == 2
    assert spoilt.count("[°C] read as K") == 4


def test_when_must_i_correct(work, monkeypatch, capsys):
    text = said("when_must_i_correct", work, monkeypatch, capsys)
    found = [float(value) for value in re.findall(r"epsilon ([\d.]+) N·m", text)]
    never, paper, bound = (np.array(found[i : i + 4]) for i in (0, 4, 8))
    assert (never > 4.5).all()
    assert (paper < 1.5).all()
    assert (bound < 2.5).all()


def test_what_does_my_simulation_get_wrong(work, monkeypatch, capsys):
    text = said("what_does_my_simulation_get_wrong", work, monkeypatch, capsys)
    assert "verdict: named" in text
    assert "\nthermal_lag:" in text


def test_use_it_on_my_controller(work, monkeypatch, capsys):
    """The gear's state, told only the past, needs no correction to do as well, nearly."""
    text = said("use_it_on_my_controller", work, monkeypatch, capsys)
    found = [float(value) for value in re.findall(r"misses friction by ([\d.]+) N·m RMS", text)]
    alone, corrected, extended = found
    assert alone > 4.5
    assert corrected < 1.5
    assert extended < 1.4
    assert len(list((work / "export").iterdir())) == 5


def test_the_page_runs_as_it_stands(work, tmp_path, monkeypatch):
    """Its blocks one after the other; the stages are not done again.

    By hand: 10.57 + (3.48 + 15.66 e^-3.64) 10.06 = 49.7;
    -ln(49.43/128.66 - 0.2222)/0.056 = 32.5.
    """
    blocks = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(blocks) == 3
    monkeypatch.chdir(tmp_path)
    (tmp_path / "friction-run").symlink_to(work, target_is_directory=True)
    for stage in ("ingest", "pair", "separate", "fit", "diagnose"):
        module = importlib.import_module(f"frictioncli.stages.{stage}")
        monkeypatch.setattr(module, stage, lambda *paths: paths[-1])
    names = {}
    for block in blocks:
        exec(block, names)
    assert names["torque"].shape == (2,)
    assert names["hot"] == pytest.approx(49.7, abs=0.05)
    assert names["warm"] == pytest.approx(32.5, abs=0.05)
    assert 20 < names["estimate"] < 150
    ten = [
        line for line in blocks[0].splitlines() if line and not line.startswith(("from", "import"))
    ]
    assert len(ten) <= 10


def test_on_the_sample_logs_the_online_gear_is_the_extended_model(work):
    """All pairs of both days: to 1e-3 N·m, which the refitted gravity makes by way of the load."""
    settings = ExportSettings(to="json", extended=True)
    joint = load_deployed(export(work, settings).path)
    torques = tables.read(work / "torques.parquet", schemas.TORQUES)
    # what causes add; the empirical term is a function of its own on the controller
    model = replace(read_extended(work / "extended-model.json")[2], empirical=None)
    (fitted,) = read_models(work / "extended-model.json")
    added, _ = friction_beyond(torques, fitted, model)
    pairs, run = pairs_of(torques, added), None
    found = []
    told = instants_before(torques, model, joint.extension)
    for pair, instants in zip(pairs.itertuples(), told, strict=True):
        if pair.run != run:
            corrector, run = joint.corrector(), pair.run
        for one in instants:
            corrector.update(one.time, one.motor, housing_temperature=one.housing, power=one.power)
        found.append(corrector.added_friction(np.sqrt(pair.squared), pair.speed))
    (cause,) = json.loads((work / "diagnosis.json").read_text(encoding="utf-8"))["causes"]
    interval = cause["parameters"]["time_constant"]["ci95"]
    assert list(joint.extension.gear.time_constant_ci95) == interval
    assert np.std(pairs["added"]) > 4
    np.testing.assert_allclose(found, pairs["added"], rtol=0, atol=1e-3)


def test_a_joint_shows_itself_as_a_table(work):
    shown = deployed(work)._repr_html_()
    assert "<td>gamma</td>" in shown
    assert "N·m/(deg/s)^0.5" in shown
    assert "correction at about 67.5 deg/s" in shown
