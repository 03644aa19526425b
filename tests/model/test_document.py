"""``model.json`` holds all of a model and nothing else is taken for one."""

import json

import pytest

from frictioncli.errors import TableError
from frictioncli.model.document import read_models, write_models
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.provenance import Provenance
from tests.equation_16 import torques


def model(joint=2, rows=slice(None)):
    table = torques(0).assign(joint=joint)
    return fit_joint(table[rows], {"torque_unit": "N·m"}, FitSettings())


def test_a_model_survives_writing_and_reading(tmp_path):
    written = model()
    write_models(tmp_path / "model.json", [written], Provenance("fit"))
    assert read_models(tmp_path / "model.json") == [written]


def test_the_keys_of_the_contract_are_there(tmp_path):
    write_models(tmp_path / "model.json", [model()], Provenance("fit", {"a": 1}, {"b": "c"}))
    document = json.loads((tmp_path / "model.json").read_text(encoding="utf-8"))
    keys = {"form", "temperature", "torque_unit", "sign", "speed_unit", "parameters", "rmse"}
    assert keys | {"n_pairs", "noise", "range", "provenance"} <= set(document)
    assert set(document["noise"]) >= {"point", "pair", "drift"}
    for entry in document["parameters"].values():
        assert {"estimate", "ci95", "unit", "determined"} <= set(entry)
    assert document["provenance"]["inputs"] == {"b": "c"}


def test_of_several_joints_the_one_with_most_pairs_stands_on_top(tmp_path):
    few = model(joint=1, rows=slice(0, 34 * 200))
    write_models(tmp_path / "model.json", [few, model(joint=3)], Provenance("fit"))
    document = json.loads((tmp_path / "model.json").read_text(encoding="utf-8"))
    assert document["joint"] == 3
    assert set(document["joints"]) == {"1", "3"}
    assert [found.joint for found in read_models(tmp_path / "model.json")] == [1, 3]


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"parameters": {}}', "{"])
def test_anything_else_is_refused(tmp_path, text):
    path = tmp_path / "model.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(TableError, match="run 'frictioncli fit' again"):
        read_models(path)


def test_a_missing_model_names_the_command(tmp_path):
    with pytest.raises(TableError, match="frictioncli fit"):
        read_models(tmp_path / "model.json")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda of: of.update(rmse=-1.0), "rmse: expected an error"),
        (lambda of: of["parameters"]["beta"].update(estimate=1e308), "expected beta below"),
        (lambda of: of.update(delay={**of["parameters"]["beta"], "estimate": -5.0}), "at most 1 s"),
    ],
)
def test_values_that_no_fit_gives_are_refused(change, told, tmp_path):
    path = tmp_path / "model.json"
    write_models(path, [model()], Provenance("fit"))
    document = json.loads(path.read_text(encoding="utf-8"))
    change(document)
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(TableError, match=f"{told}.*run 'frictioncli fit' again"):
        read_models(path)


def test_a_model_of_a_release_without_delay_is_read(tmp_path):
    path = tmp_path / "model.json"
    write_models(path, [model()], Provenance("fit"))
    document = json.loads(path.read_text(encoding="utf-8"))
    del document["delay"]
    path.write_text(json.dumps(document), encoding="utf-8")
    assert read_models(path)[0].late_by is None
