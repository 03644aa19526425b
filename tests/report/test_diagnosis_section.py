"""Section on the diagnosis: its numbers, figures and sentences."""

import json
import re
import shutil
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from msgspec import convert, structs

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument, extended_model
from frictioncli.diagnosis.documents.reload import is_current, read_documents, reload
from frictioncli.diagnosis.documents.sentences import detectable_text, p_value_text
from frictioncli.diagnosis.search.effect_size import TAKEN_BY_BASE
from frictioncli.errors import TableError
from frictioncli.report.diagnosis_captions import cause_title
from frictioncli.report.diagnosis_section import diagnosis_figures, diagnosis_section
from frictioncli.report.diagnosis_tables import FOUND, NONE, UNDETECTABLE, detectable_table
from frictioncli.report.diagnosis_text import cause_texts, gain_sentence, verdict_sentence
from frictioncli.report.drawing import draw_figure
from frictioncli.report.page import write_report
from frictioncli.report.results import read_results
from tests.report.diagnosis_documents import (
    DIAGNOSIS_DOCUMENT,
    OFFSET,
    SHIFT,
    cause,
    diagnosis,
    stribeck_term,
)

HOSTILE = "<script>alert(1)</script>&\"'$\\frac{kr10$"


def test_reloaded_misfits_are_those_of_the_files(diagnosed):
    seen, new = diagnosed.diagnosis.seen, diagnosed.diagnosis.new
    assert seen.problem.runs == ("day-1",)
    assert new.problem.runs == ("day-2",)
    for one in (seen, new):
        speed = one.problem.table.speed
        np.testing.assert_allclose(one.terms[0].friction, stribeck_term(speed))
        np.testing.assert_allclose(one.terms[1].load, OFFSET)
        wanted = one.before["friction"] - SHIFT - stribeck_term(speed)
        np.testing.assert_allclose(one.after["friction"], wanted, atol=1e-9)
        np.testing.assert_allclose(one.after["load"], one.before["load"] - OFFSET, atol=1e-9)
        np.testing.assert_allclose(
            one.without(0, "friction"), one.before["friction"] - SHIFT, atol=1e-9
        )
    both = seen.torque({"friction": np.array([1.0, 2.0]), "load": np.array([10.0, 20.0])})
    np.testing.assert_allclose(both, [11.0, 22.0, 9.0, 18.0])


def test_what_did_not_last_is_not_predicted_on_the_new_run(diagnosed, diagnosed_work):
    document, extended = read_documents(diagnosed_work)[2]
    first, *others = document.causes
    lost = structs.replace(first, holds_on_new_run=False)
    found = reload(diagnosed.torques, structs.replace(document, causes=(lost, *others)), extended)
    wanted = found.new.before["friction"] - SHIFT
    np.testing.assert_allclose(found.new.after["friction"], wanted, atol=1e-9)
    seen = diagnosed.diagnosis.seen.after["friction"]
    np.testing.assert_allclose(found.seen.after["friction"], seen, atol=1e-9)


def test_section_says_what_was_found(diagnosed):
    section = diagnosis_section(diagnosed)
    assert "2.10 N·m (RMS, day-1)" in section.verdict
    assert "The model lacks Stribeck friction." in section.verdict
    assert "one of direction asymmetry and dress pack" in section.verdict
    assert "There is also structure" in section.verdict
    assert [one.effects for one in section.causes] == [
        "Stribeck friction 97 %",
        "direction asymmetry 60 % or dress pack 40 %",
    ]
    first = section.causes[0]
    assert (first.size, first.p_value) == ("1.2 N·m RMS in the friction", "3e−09")
    assert first.parameters == "velocity 8.0 deg/s; boundary torque 3.0 N·m (2.5 to 3.5)"
    assert [one.claim for one in section.unnamed] == ["Residuals have structure along angle."]
    (seen,) = section.visible
    assert (seen.effects, seen.kind, seen.p_value) == ("inertia", "load", "below 1e−300")
    assert seen.size == "0.050 N·m (0.031 to 0.069) RMS in the friction"
    assert seen.standing == ("too small to name: the base leaves 0.05 N·m, less than 0.10 N·m")
    assert section.margin == (
        "Effects below 0.10 N·m are not named (the least margin; 'frictioncli diagnose --margin'"
        " sets another)."
    )
    assert "run day-2, which was not used for fitting" in section.gain
    assert "50 % less (95 % interval: 40 % less to 60 % less)" in section.gain
    assert section.detectable.rows[0][1] == "0.40"
    assert [row[1] for row in section.detectable.rows[1:3]] == [NONE, NONE]
    assert section.detectable.rows[1][2].endswith(f" C{UNDETECTABLE[1:]}.")
    assert section.detectable.rows[2][2].endswith(" Cannot be distinguished from the base model.")
    assert section.worst.rows[0] == (
        "temperature 25.0 to 31.0 °C",
        "rising",
        "67.5 deg/s",
        "friction",
        "−4.50 N·m",
    )
    names = [figure.name for figure in diagnosis_figures(diagnosed.diagnosis)]
    assert names == [
        "diagnosis-simulation",
        "diagnosis-maps",
        "diagnosis-1",
        "diagnosis-2",
        "diagnosis-gain",
    ]


def test_a_gain_that_is_none_is_said_to_be_none():
    document = convert(DIAGNOSIS_DOCUMENT, DiagnosisDocument)

    def sentence(**changed):
        gain = structs.replace(document.gain, **changed)
        return gain_sentence(structs.replace(document, gain=gain), "A")

    worse = {"reduction": -0.3, "ci95": (-0.5, -0.1)}
    assert "30 % more" in sentence(**worse)
    assert "worse than the base model" in sentence(**worse)
    unsure = {"reduction": -0.3, "ci95": (-0.5, 0.1)}
    assert "The interval includes zero" in sentence(**unsure)
    unsure |= {"basis": "within_run"}
    assert "optimistic" in sentence(**unsure)
    assert " A " in sentence(**unsure)
    assert "N·m" not in sentence(**unsure)
    assert gain_sentence(structs.replace(document, gain=None), "A") == ""
    assert p_value_text(0.0) == "below 1e−300"
    assert p_value_text(0.031) == "0.031"


def test_silence_is_explained_and_draws_no_gain(diagnosed, diagnosed_work):
    document = deepcopy(DIAGNOSIS_DOCUMENT)
    model = json.loads((diagnosed_work / "extended-model.json").read_text())
    document |= {"verdict": "no_evidence", "causes": [], "visible": [], "gain": None}
    model["effects"] = []
    found = reload(
        diagnosed.torques,
        convert(document, DiagnosisDocument),
        extended_model(convert(model, ExtendedDocument)),
    )
    assert found.seen.after is found.seen.before
    silent = replace(diagnosed, diagnosis=found)
    section = diagnosis_section(silent)
    assert "No cause was found: no known effect" in section.verdict
    figures = diagnosis_figures(found)
    assert [figure.name for figure in figures] == ["diagnosis-simulation", "diagnosis-maps"]
    for figure in figures:
        assert draw_figure(figure, silent, "joint2-").name == f"joint2-{figure.name}"


def test_verdict_tells_joint_measurement_and_what_did_not_last_apart():
    document = diagnosis(
        causes=(
            cause(["stribeck"], kind="friction"),
            cause(["drift", "run_in"], kind="friction"),
            cause(["payload_change"], kind="load", holds_on_new_run=False, when="in run day-1"),
            cause(
                ["torque_delay"],
                kind="measurement",
                statement="The torque in these logs lags the position by 12 ms (11 to 13).",
            ),
        ),
        verdict="ambiguous",
    )
    sentence = verdict_sentence(document, "N·m")
    assert "The model lacks Stribeck friction. The model lacks one of drift and run-in" in sentence
    assert (
        "Payload change: a change that did not last: present in run day-1, absent on the held-out"
        " run (day-2)."
    ) in sentence
    assert (
        "Measurement: the torque in these logs lags the position by 12 ms (11 to 13); corrected."
    ) in sentence
    third = cause_texts(document)[3]
    assert third.kind == "measurement"
    assert cause_title(document.causes[3], 4) == "Measurement 4. torque delay"


def test_without_a_diagnosis_the_section_names_the_command(tmp_path, write_work):
    work = write_work(tmp_path, runs=("day-1",), temperature=False)
    results = read_results(work).joints[0]
    assert "'frictioncli diagnose' does it" in diagnosis_section(results).missing
    document = deepcopy(DIAGNOSIS_DOCUMENT) | {"causes": [], "gain": None}
    (work / "diagnosis.json").write_text(json.dumps(document))
    (work / "extended-model.json").write_text((work / "model.json").read_text())
    with pytest.raises(TableError, match="diagnose"):
        read_results(work)
    model = json.loads((work / "model.json").read_text()) | {"effects": []}
    (work / "extended-model.json").write_text(json.dumps(model))
    assert not is_current(convert(document, DiagnosisDocument), results.torques)
    assert "other runs" in diagnosis_section(read_results(work).joints[0]).missing
    (work / "diagnosis.json").write_text(json.dumps(document | {"joint": 5}))
    (work / "extended-model.json").write_text(json.dumps(model | {"joint": 5}))
    assert "no diagnosis" in diagnosis_section(read_results(work).joints[0]).missing


@pytest.mark.parametrize(
    "damage",
    [
        lambda document, model: document.pop("causes"),
        lambda document, model: document["causes"][0].pop("claim"),
        lambda document, model: document["causes"].pop(0),
        lambda document, model: model.pop("gravity"),
        lambda document, model: model["effects"][0].update(name="magic"),
        lambda document, model: model["effects"][0].update(coefficients={}),
    ],
)
def test_damaged_files_are_refused(tmp_path, diagnosed_work, damage):
    document = json.loads((diagnosed_work / "diagnosis.json").read_text(encoding="utf-8"))
    model = json.loads((diagnosed_work / "extended-model.json").read_text(encoding="utf-8"))
    damage(document, model)
    (tmp_path / "diagnosis.json").write_text(json.dumps(document))
    (tmp_path / "extended-model.json").write_text(json.dumps(model))
    with pytest.raises(TableError, match="run 'frictioncli diagnose' again"):
        read_documents(tmp_path)


@pytest.mark.usefixtures("without_figures")
def test_page_has_the_section_after_the_figures_escaped_and_the_same_twice(
    tmp_path, diagnosed_work
):
    work = shutil.copytree(diagnosed_work, tmp_path / "copied")
    document = deepcopy(DIAGNOSIS_DOCUMENT)
    document["causes"][0] |= {"claim": HOSTILE, "equation": HOSTILE, "experiment": HOSTILE}
    document["causes"][1]["claim"] = HOSTILE
    (work / "diagnosis.json").write_text(json.dumps(document), encoding="utf-8")
    page = write_report(work, png=True)
    text = page.read_text(encoding="utf-8")
    start = text.index(">What the simulation gets wrong</h2>")
    assert text.index(">Figures</h2>") < start < text.index(">Parameters</h2>")
    assert "<script>alert" not in text
    assert text.count("&lt;script&gt;alert(1)") > 4
    names = {path.name for path in page.parent.glob("diagnosis-*")}
    stems = ("simulation", "maps", "1", "2", "gain")
    assert names == {f"diagnosis-{stem}.{kind}" for stem in stems for kind in ("svg", "png")}
    assert UNDETECTABLE[1:] in text
    known = re.findall(r'\bid="([^"]+)"', text)
    assert len(known) == len(set(known))
    # the whole page's bytes are compared elsewhere; drawing takes long
    results = read_results(work).joints[0]
    for figure in diagnosis_figures(results.diagnosis)[1:3]:
        again = draw_figure(figure, results, png=True)
        assert again.svg in text
        assert again.png == (page.parent / f"{figure.name}.png").read_bytes()


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("causes", 0, "effects"), [HOSTILE]),
        (("detectable",), {"gremlins": 0.3}),
        (("verdict",), "maybe"),
    ],
)
def test_names_that_the_catalogue_lacks_are_refused(tmp_path, diagnosed_work, place, value):
    work = shutil.copytree(diagnosed_work, tmp_path / "copied")
    document = deepcopy(DIAGNOSIS_DOCUMENT)
    holder = document
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = value
    (work / "diagnosis.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(TableError, match="run 'frictioncli diagnose' again"):
        write_report(work)


def test_an_effect_that_is_named_is_never_said_to_be_undetectable():
    """Of a named effect the data may show no smallest size; the page does not doubt it for that."""
    sizes = {"thermal_lag": None, "drift": None, "run_in": 1.0}
    document = diagnosis(
        sets=[["thermal_lag"], ["drift", "run_in"]],
        detectable=sizes,
        undetectable=dict.fromkeys(("thermal_lag", "drift"), TAKEN_BY_BASE),
    )
    rows = {row[0]: row[1:] for row in detectable_table(document, "N·m").rows}
    assert {name: row[0] for name, row in rows.items()} == {
        "thermal lag": FOUND,
        "drift": NONE,
        "run-in": "1.0",
    }
    reason = TAKEN_BY_BASE.removeprefix("c").removesuffix(" with these data")
    assert [reason in row[1] for row in rows.values()] == [False, True, False]
    assert detectable_text(document).endswith("with these data: drift.")


def test_smallest_sizes_of_effects_on_a_load_channel_have_its_unit():
    sizes = {"stribeck": 0.5, "payload_change": 2.0, "drift": None}
    document = diagnosis(sets=[], detectable=sizes)
    table = detectable_table(document, "N·m")
    assert table.header[1] == "RMS [N·m]"
    assert [row[1] for row in table.rows][::2] == ["0.50", "2.0"]
    current = structs.replace(document, torque_unit="A", load_unit="N·m")
    table = detectable_table(current, "A")
    assert table.header[1] == "RMS"
    cells = dict(zip((row[0] for row in table.rows), (row[1] for row in table.rows), strict=True))
    assert cells[table.rows[0][0]] == "0.50 A"
    assert "2.0 N·m" in cells.values()
