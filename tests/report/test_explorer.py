"""Data of the explorer agree with evaluation and simulation at every setting of the grid."""

import json
import re
import shutil

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.correction.settings import EvaluationGrid, ScheduleSettings
from frictioncli.provenance import Provenance
from frictioncli.report.explorer import explorer
from frictioncli.report.page import write_report
from frictioncli.report.results import read_results
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.simulate import simulate
from frictioncli.wording import number_text
from tests.report.diagnosis_documents import extended_document

GRID = EvaluationGrid(k=(1.0, 2.5, 5.0, 10.0), tmax=(1800.0, 3600.0, 14400.0))


@pytest.fixture(scope="module")
def work(tmp_path_factory, write_work):
    folder = write_work(tmp_path_factory.mktemp("explored"), schedule=False)
    torques = read_results(folder).joints[0].torques
    model = extended_document(folder, torques)
    (folder / "extended-model.json").write_text(json.dumps(model), encoding="utf-8")
    simulate(folder, ScheduleSettings(k=2.5, tmax=3600.0))
    evaluate(folder, GRID)
    return folder


@pytest.fixture
def copied(work, tmp_path):
    return shutil.copytree(work, tmp_path / "copied")


def explored(folder):
    return explorer(read_results(folder).joints[0])


def every_cell(data, phases):
    """Each phase with k, tmax [s], its place in the grid and its schedule there."""
    for phase in phases:
        places = [(k, 60.0 * tmax) for k in data["k"] for tmax in data["tmax"]]
        for place, (k, tmax) in enumerate(places):
            yield phase, k, tmax, place, phase["schedules"][phase["settings"][place]]


def errors(phase, schedule):
    """What the page's script draws, by its formula, in plain numpy."""
    last = np.searchsorted(schedule["time"], phase["time"], side="right") - 1
    step = np.where(last >= 0, np.append(schedule["step"], 0.0)[last], 0.0)
    change = np.exp(-phase["delta"] * step) - 1
    return np.array(phase["error"]) + np.array(phase["term"]) * change, step


@pytest.mark.parametrize("flavour", ["base", "extended"])
def test_every_cell_says_what_the_evaluation_says(copied, flavour):
    if flavour == "extended":
        evaluate(copied, GRID, extended=True)
    data = explored(copied).data
    assert data["evaluated"] == flavour
    rows = tables.read(copied / "evaluation.parquet", schemas.EVALUATION)
    first = rows[rows["criterion"] == "first_degree"].set_index(["run", "phase", "k", "tmax"])
    never = rows[rows["criterion"] == "none"].set_index(["run", "phase"])["epsilon"]
    seen = 0
    for phase, k, tmax, place, schedule in every_cell(data, data["models"][flavour]):
        row = first.loc[(phase["run"], phase["phase"], k, tmax)]
        assert phase["epsilon"][place] == number_text(row["epsilon"])
        assert phase["none"] == number_text(never[phase["run"], phase["phase"]])
        assert len(schedule["time"]) == row["corrections"]
        assert len(schedule["failed"]) == row["failed"]
        drawn = np.sqrt(np.mean(np.square(errors(phase, schedule)[0])))
        assert drawn == pytest.approx(row["epsilon"], abs=2e-3)
        seen += 1
    assert seen == 4 * len(GRID.k) * len(GRID.tmax)


def test_curves_are_those_of_the_simulated_schedule(work):
    """``simulate`` corrects pair by pair, as a robot would; the explorer replays whole grids."""
    data = explored(work).data
    assert (data["k"][data["start"][0]], data["tmax"][data["start"][1]]) == (2.5, 60.0)
    whole = tables.read(work / "schedule.parquet", schemas.SCHEDULE)
    for phase, k, tmax, _, schedule in every_cell(data, data["models"]["base"]):
        if (k, tmax) != (2.5, 3600.0):
            continue
        own = whole[(whole["run"] == phase["run"]) & (whole["phase"] == phase["phase"])]
        missed, step = errors(phase, schedule)
        wanted = own["friction_predicted"] - own["friction_smoothed"]
        np.testing.assert_allclose(missed, wanted, atol=2e-3)
        np.testing.assert_allclose(step, own["temperature_correction"], atol=1e-3)
        corrected = own.loc[own["corrected"], "time"] / 60.0
        np.testing.assert_allclose(schedule["time"], corrected, atol=0.006)


def test_extended_model_predicts_with_its_effect(work):
    """The planted effects are not in these data: put in, they must be missed by what they are."""
    models = explored(work).data["models"]
    for base, more in zip(models["base"], models["extended"], strict=True):
        assert (base["run"], base["phase"]) == (more["run"], more["phase"])
        assert base["none"] != more["none"]


def test_two_cycles_of_a_run_are_one_phase_each(copied):
    torques = tables.read(copied / "torques.parquet", schemas.TORQUES)
    one = torques[torques["run"] == "day-1"]
    later = one[one["phase"] != "sweep"].copy()
    later["time"] += 40000.0
    later["pair"] += 10000
    whole = pd.concat([one, later], ignore_index=True)
    facts = tables.facts(copied / "torques.parquet")
    tables.write(copied / "torques.parquet", whole, schemas.TORQUES, Provenance("separate"), facts)
    (copied / "extended-model.json").unlink()
    model = json.loads((copied / "model.json").read_text(encoding="utf-8"))
    del model["provenance"]  # it was fitted to the torques before
    (copied / "model.json").write_text(json.dumps(model), encoding="utf-8")
    evaluate(copied, GRID)
    found = explored(copied)
    assert "'frictioncli diagnose' makes one" in found.without_extended
    rows = tables.read(copied / "evaluation.parquet", schemas.EVALUATION)
    first = rows[rows["criterion"] == "first_degree"].set_index(["phase", "k", "tmax"])
    phases = found.data["models"]["base"]
    assert [phase["phase"] for phase in phases] == ["heat-up", "cool-down"]
    for phase, k, tmax, place, schedule in every_cell(found.data, phases):
        row = first.loc[(phase["phase"], k, tmax)]
        assert phase["epsilon"][place] == number_text(row["epsilon"])
        assert len(schedule["time"]) == row["corrections"]
        drawn = np.sqrt(np.mean(np.square(errors(phase, schedule)[0])))
        assert drawn == pytest.approx(row["epsilon"], abs=2e-3)


def test_an_evaluation_of_another_model_is_not_shown(copied):
    model = json.loads((copied / "model.json").read_text(encoding="utf-8"))
    model["parameters"]["gamma"]["estimate"] *= 1.01
    (copied / "model.json").write_text(json.dumps(model), encoding="utf-8")
    found = explored(copied)
    assert found.data == {}
    assert "'frictioncli evaluate'" in found.missing


def test_without_effects_there_is_no_switch_and_it_says_why(copied):
    model = json.loads((copied / "extended-model.json").read_text(encoding="utf-8"))
    (copied / "extended-model.json").write_text(json.dumps(model | {"effects": []}))
    found = explored(copied)
    assert list(found.data["models"]) == ["base"]
    assert "adds nothing" in found.without_extended


@pytest.mark.usefixtures("without_figures")
def test_without_a_thermal_cycle_it_says_why(tmp_path, write_work):
    folder = write_work(tmp_path, runs=("day-1",), temperature=False)
    found = explored(folder)
    assert "no motor temperature" in found.missing
    page = write_report(folder).read_text(encoding="utf-8")
    assert f"<b>No explorer.</b> {found.missing}" in page
    assert "joint2-grid" not in page


def test_a_large_grid_stays_small(copied):
    grid = EvaluationGrid(
        k=tuple(np.linspace(0.5, 20, 20)), tmax=tuple(np.linspace(300.0, 9000.0, 20))
    )
    evaluate(copied, grid)
    data = explored(copied).data
    assert len(data["models"]["extended"][0]["epsilon"]) == 400
    assert len(json.dumps(data)) < 500_000


@pytest.mark.usefixtures("without_figures")
def test_names_in_the_data_are_harmless(tmp_path, write_work):
    hostile = "</script><script>alert(1)</script>\u202e=1+1'\""
    folder = write_work(tmp_path, runs=(hostile,), schedule=False)
    evaluate(folder, GRID)
    page = write_report(folder).read_text(encoding="utf-8")
    named = re.findall(r'<script type="application/json" id="(.*?)">(.*?)</script>', page)
    assert [name for name, _ in named] == ["joint2-grid", "joint2-points"]
    blocks = [block for _, block in named]
    assert not set("<>&'\u202e") & set("".join(blocks))
    names = {phase["run"] for phase in json.loads(blocks[0])["models"]["base"]}
    assert names == {hostile.replace("\u202e", "\N{REPLACEMENT CHARACTER}")}
    # the numbers, and the page's own scripts, which its policy names
    assert page.count("<script") == len(blocks) + page.count("'sha256-")
