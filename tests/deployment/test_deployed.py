"""What is written as JSON is read back as the same joint, and damage is told, not guessed."""

import json
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.correction.settings import ScheduleSettings
from frictioncli.deployment.deployed_model import default_correction_speed
from frictioncli.deployment.document import load_deployed
from frictioncli.deployment.export import export
from frictioncli.deployment.extended_corrector import ExtendedCorrector
from frictioncli.deployment.settings import ExportSettings
from frictioncli.errors import NotEnoughData, OptionError, TableError
from frictioncli.model.friction import PUBLISHED, friction_torque
from tests.deployment.joints import day, extended, joint


def written(deployed, folder):
    done = export(deployed, ExportSettings(to="json"))
    path = folder / done.name
    path.write_text(done.text, encoding="utf-8")
    return path


@pytest.mark.parametrize("extension", [None, extended()], ids=["base", "extended"])
@pytest.mark.parametrize("criterion", ["first_degree", "latest_degree"])
def test_it_comes_back_as_it_was(tmp_path, extension, criterion):
    """Not one digit is lost, and the corrector does the same all day."""
    schedule = ScheduleSettings(criterion=criterion, k=2.0, tmax=900.0)
    deployed = joint(extension=extension, schedule=schedule)
    path = written(deployed, tmp_path)
    back = load_deployed(path)
    # the effects' coefficients are arrays, which == compares one by one
    assert replace(back, extension=None) == replace(deployed, extension=None)
    assert export(back, ExportSettings(to="json")).text == path.read_text(encoding="utf-8")
    seen, pair = day(4), [deployed.corrector(), back.corrector()]
    for i in range(len(seen["time"])):
        for corrector in pair:
            corrector.update(float(seen["time"][i]), float(seen["motor"][i]))
            if corrector.is_due:
                corrector.correct(float(seen["friction"][i]), 10.0, 60.0)
        assert pair[0].correction == pair[1].correction
        assert pair[0].friction(20.0, 80.0) == pair[1].friction(20.0, 80.0)


def test_without_a_state_friction_is_equation_16():
    speed = np.array([10.0, 60.0])
    wanted = friction_torque(PUBLISHED, load=30.0, speed=speed, temperature=40.0)
    found = joint().friction(load=30.0, speed=speed, temperature=40.0)
    np.testing.assert_array_equal(found, wanted)


def test_the_corrector_knows_what_it_was_given():
    schedule = ScheduleSettings(criterion="latest_degree", k=2.0, tmax=900.0)
    inner = joint(schedule=schedule).corrector()
    assert isinstance(inner, TemperatureCorrector)
    assert (inner.k, inner.tmax, inner.reading) == (2.0, 900.0, "latest_degree")
    assert isinstance(joint(extension=extended()).corrector(), ExtendedCorrector)
    assert default_correction_speed(joint().model) == pytest.approx(101.2 * 2 / 3)


def test_without_a_temperature_there_is_no_corrector_and_the_document_says_so(tmp_path):
    deployed = joint(gamma=0.0, delta=0.0)
    with pytest.raises(NotEnoughData, match="temperature spans 1 °C"):
        deployed.corrector()
    path = written(deployed, tmp_path)
    assert json.loads(path.read_text(encoding="utf-8"))["correction"] is None
    assert load_deployed(path).friction(load=0.0, speed=100.0, temperature=9.0) == pytest.approx(
        10.57 + 34.8
    )


def test_the_document_says_units_ranges_and_intervals():
    document = json.loads(export(joint(), ExportSettings(to="json")).text)
    assert document["schema"] == "frictioncli-deployed/1"
    assert document["parameters"]["beta"]["unit"] == "N·m/(deg/s)^0.5"
    assert document["parameters"]["beta"]["ci95"] == pytest.approx([0.9 * 3.48, 1.1 * 3.48])
    assert document["range"]["speed"] == [2.3, 101.2]
    assert document["correction"]["tmax_unit"] == "s"
    assert document["made_from"] == {"model.json": "0" * 64}


def test_a_notebook_shows_text_from_logs_as_text():
    """A reason may hold a column's name, and that anything."""
    deployed = joint()
    delta = replace(deployed.model.parameters["delta"], reason="<b onload=evil()>")
    parameters = {**deployed.model.parameters, "delta": delta}
    shown = replace(deployed, model=replace(deployed.model, parameters=parameters))._repr_html_()
    assert "<b" not in shown
    assert "&lt;b onload" in shown
    assert "<td>3.132 to 3.828</td>" in shown


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(TableError, match="--to json"):
        load_deployed(tmp_path / "none.json")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": "other/1"}', "nonsense", '"a"'])
def test_another_file_is_refused(tmp_path, text):
    path = tmp_path / "some.json"
    path.write_text(text)
    with pytest.raises(TableError, match="is not what 'frictioncli export --to json' writes"):
        load_deployed(path)


def places(value, path=()):
    """Return the way to every value of a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, part in inner:
        yield (*path, key)
        if isinstance(part, dict | list):
            yield from places(part, (*path, key))


DOCUMENT = json.loads(export(joint(extension=extended()), ExportSettings(to="json")).text)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(sorted(places(DOCUMENT), key=str)), st.sampled_from(["gone", "text", None]))
def test_a_damaged_document_is_refused_or_still_a_joint(tmp_path, place, damage):
    document = json.loads(json.dumps(DOCUMENT))
    parent = document
    for key in place[:-1]:
        parent = parent[key]
    if damage == "gone":
        del parent[place[-1]]
    else:
        parent[place[-1]] = damage
    path = tmp_path / "damaged.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    with suppress(TableError):  # any other error is a bug
        load_deployed(path)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"to": "fmu"}, "expected one of c, urdf"),
        ({"to": "c", "criterion": "uncertainty"}, "need the whole log"),
        ({"to": "urdf", "extended": True}, "expected --to c or json"),
        ({"to": "csv", "tolerance": 0.0}, "--tolerance 0"),
        ({"to": "urdf", "lowest": float("nan")}, "--lowest nan"),
        ({"to": "urdf", "torque_constant": -1.0}, "--torque-constant -1"),
        ({"to": "urdf", "lowest": 5.0, "highest": 5.0}, "range of speeds"),
        ({"to": "urdf", "temperature": float("inf")}, "--temperature inf"),
        ({"to": "urdf", "load": float("nan")}, "--load nan"),
    ],
)
def test_senseless_options_are_refused(wrong, said):
    with pytest.raises(OptionError, match=said):
        ExportSettings(**wrong)
