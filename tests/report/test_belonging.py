"""Results of other torques or of another model never stand beside those of the present ones."""

import json

import pytest

from frictioncli import schemas, tables
from frictioncli.correction.settings import EvaluationGrid
from frictioncli.errors import TableError
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.report.page import write_report
from frictioncli.report.results import read_results
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.simulate import simulate

GRID = EvaluationGrid(k=(1.0, 5.0), tmax=(1800.0, 3600.0))


@pytest.fixture
def work(tmp_path, write_work):
    made = write_work(tmp_path, runs=("day-1",), schedule=False)
    simulate(made)
    evaluate(made, GRID)
    return made


def refit(work):
    """Another model of the same torques, as another method gives."""
    path = work / "model.json"
    model = json.loads(path.read_text(encoding="utf-8"))
    model["parameters"]["beta"]["estimate"] *= 1.3
    path.write_text(json.dumps(model), encoding="utf-8")


def test_all_belongs_together_after_a_plain_run(work):
    found = read_results(work)
    assert found.left_out == ()
    assert not found.joints[0].schedule.empty
    assert not found.joints[0].evaluation.empty


@pytest.mark.usefixtures("without_figures")
def test_an_evaluation_of_another_model_is_left_out_and_said(work):
    before = write_report(work).read_text(encoding="utf-8")
    assert "without correction" in before
    refit(work)
    simulate(work)
    found = read_results(work)
    assert not found.joints[0].schedule.empty
    assert found.joints[0].evaluation.empty
    assert found.left_out == (
        "Comparison of corrections left out: evaluation.parquet was made from a different"
        " model.json; run 'frictioncli evaluate' again.",
    )
    assert "evaluation.parquet" not in found.metadata
    page = write_report(work).read_text(encoding="utf-8")
    assert "Comparison of corrections left out" in page
    assert "against" not in page[page.index('class="summary"') :][:800]


def test_corrections_by_an_extended_model_fall_with_it(work):
    extended = work / "extended-model.json"
    model = json.loads((work / "model.json").read_text(encoding="utf-8"))
    digest = input_hashes([work / "model.json"])
    extended.write_text(
        json.dumps(model | {"provenance": Provenance("diagnose", {}, digest).as_dict()}),
        encoding="utf-8",
    )
    rows = tables.read(work / "schedule.parquet", schemas.SCHEDULE)
    made = Provenance("simulate", {"extended": True}, input_hashes([extended]))
    tables.write(work / "schedule.parquet", rows, schemas.SCHEDULE, made, {})
    refit(work)
    evaluate(work, GRID)
    found = read_results(work)
    assert found.joints[0].schedule.empty
    assert found.joints[0].extended_model is None
    assert [text.split(":")[0] for text in found.left_out] == [
        "Extended model left out",
        "Simulated corrections left out",
    ]
    assert all("run 'frictioncli diagnose' again" in text for text in found.left_out)


def test_counts_of_other_pairs_are_left_out(work):
    facts = tables.facts(work / "pairs.parquet")
    rows = tables.read(work / "pairs.parquet", schemas.PAIRS)
    other = Provenance("pair", {"bin_width": 5.0}, {})
    tables.write(work / "pairs.parquet", rows.iloc[:-1], schemas.PAIRS, other, facts)
    found = read_results(work)
    assert "pairs.parquet" not in found.metadata
    assert found.recordings.empty
    assert found.left_out[0] == (
        "Counts of pairing left out: torques.parquet was made from a different pairs.parquet;"
        " run 'frictioncli separate' again."
    )


def test_a_model_of_other_torques_gives_no_page(work):
    facts = tables.facts(work / "torques.parquet")
    rows = tables.read(work / "torques.parquet", schemas.TORQUES)
    other = Provenance("separate", {"sign": "plus"}, {})
    tables.write(work / "torques.parquet", rows.iloc[:-1], schemas.TORQUES, other, facts)
    with pytest.raises(TableError, match=r"run 'frictioncli fit -w .*' again"):
        write_report(work)
