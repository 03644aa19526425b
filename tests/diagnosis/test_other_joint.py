"""Motion of other joints is said as a property of the log, if the log has their positions."""

import json
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from frictioncli import tables
from frictioncli.deployment.settings import ExportSettings
from frictioncli.diagnosis.documents.document import OTHER_JOINT
from frictioncli.diagnosis.documents.other_joint import with_other_joint
from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.diagnosis.documents.text import verdict_text
from frictioncli.report.diagnosis_text import visible_texts
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.synthesize import synthesize
from frictioncli.stages.diagnose import diagnose, has_finding
from frictioncli.stages.export import export
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.report import report
from frictioncli.stages.separate import separate
from tests.report.diagnosis_documents import diagnosis
from tests.two_joint_logs import write_logs

SIZE = 8.0


def settings(size):
    chosen = {"runs": 1, "seed": 5, "lowest": 25, "highest": 36, "joint_kind": "plain"}
    return SynthesisSettings(nuisances=(f"other_joint:{size:g}",) if size else (), **chosen)


def chain(folder):
    ingest([folder / "logs"], folder / "work")
    for stage in (pair, separate, fit):
        stage(folder / "work")
    text = diagnose(folder / "work").text
    document = json.loads((folder / "work" / "diagnosis.json").read_text(encoding="utf-8"))
    return SimpleNamespace(folder=folder, work=folder / "work", text=text, document=document)


def found_in(document):
    return [
        cause
        for cause in (*document["causes"], *document["visible"])
        if OTHER_JOINT in cause["effects"]
    ]


@pytest.fixture(scope="module")
def disturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("disturbed")
    turned = write_logs(folder / "logs", settings(SIZE))
    found = chain(folder)
    found.turned = turned
    return found


def test_what_others_add_is_a_property_of_the_measurement(disturbed):
    (cause,) = found_in(disturbed.document)
    assert cause in disturbed.document["causes"]
    assert disturbed.document["verdict"] == "named"
    assert (cause["kind"], cause["standing"]) == ("measurement", "named")
    assert cause["effects"] == [OTHER_JOINT]
    assert cause["channel"] == "load"
    assert has_finding(disturbed.work, named_only=True)


@pytest.fixture(scope="module")
def unknown(tmp_path_factory):
    """The same logs without the positions of the others: the disturbance is in the pairs."""
    folder = tmp_path_factory.mktemp("unknown")
    synthesize(folder / "logs", settings(SIZE))
    return chain(folder)


@pytest.mark.long
def test_its_size_is_what_the_simulator_added(disturbed, unknown, tmp_path):
    """The simulator's logs without the disturbance tell bin by bin what it is."""
    synthesize(tmp_path / "logs", settings(0.0))
    ingest([tmp_path / "logs"], tmp_path / "work")
    pair(tmp_path / "work")
    plain, rows = (
        pd.read_parquet(one / "pairs.parquet") for one in (tmp_path / "work", unknown.work)
    )
    at = ["pair", "position"]
    used = pd.read_parquet(disturbed.work / "pairs.parquet")[at].assign(used=True)
    both = rows.merge(plain, on=at, suffixes=("", "_plain")).merge(used, on=at, how="left")
    left_out = both[both["used"].isna()]
    # recordings begin with a move forward, and the others stand before it ends
    added = left_out["torque_forward"] - left_out["torque_forward_plain"]
    true = float(np.sqrt(np.mean(np.square(added))))
    (cause,) = found_in(disturbed.document)
    low, high = cause["size_ci95"]
    assert cause["size"] == pytest.approx(true, rel=0.2)
    assert true > 2.0 > high - low
    stated = cause["parameters"]["torque"]
    assert (stated["estimate"], stated["unit"]) == (cause["size"], "N·m")


def test_it_says_how_much_was_left_out_and_which_joints_moved(disturbed):
    (cause,) = found_in(disturbed.document)
    rows = pd.read_parquet(disturbed.work / "samples.parquet")
    # joints 1 and 4 move, which are bits 0 and 3
    assert {0, 9} <= set(rows["other_joints"].unique()) <= {0, 1, 8, 9}
    amount = {name: stated["estimate"] for name, stated in cause["parameters"].items()}
    pairs = pd.read_parquet(disturbed.work / "pairs.parquet")
    kept = float(pairs[["n_forward", "n_reverse"]].to_numpy().sum())
    assert amount["samples"] / (kept + amount["samples"]) == pytest.approx(amount["share"], rel=0.1)
    assert amount["time"] == pytest.approx(0.012 * amount["samples"])
    # most of a recording's first seconds is no motion at constant speed
    assert 0.2 < amount["time"] / sum(disturbed.turned.values()) < 1.1
    assert amount["moves"] >= sum(seconds > 0 for seconds in disturbed.turned.values())
    assert cause["statement"].startswith("Joints 1 and 4 move during ")
    assert cause["statement"].endswith(": left out.")
    assert "Keep the other joints still" in cause["experiment"]


def test_terminal_and_page_say_it(disturbed):
    (cause,) = found_in(disturbed.document)
    assert f"measurement: other_joint (over 99 %): {cause['statement']}" in disturbed.text
    assert "RMS while they move; p-value" in disturbed.text
    report(disturbed.work)
    page = (disturbed.work / "report" / "index.html").read_text(encoding="utf-8")
    assert cause["statement"] in page
    assert cause["experiment"] in page


def test_what_needs_the_terms_of_the_extended_model_goes_on(disturbed):
    document, extended = read_documents(disturbed.work)[2]
    assert len(document.modelled_causes) == len(extended.effects)
    export(disturbed.work, ExportSettings(to="json", extended=True))


def motion(**changed):
    known = {"samples": 900, "share": 0.05, "seconds": 10.8, "moves": 7, "joints": [1, 4]}
    return known | {"left_out": True, "torque": 0.2, "ci95": [0.0, 0.4], "p_value": 0.2} | changed


@pytest.mark.parametrize(
    ("changed", "standing", "said"),
    [
        ({}, "undetermined", "0.2 N·m (0.0 to 0.4) RMS while they move"),
        ({"ci95": [0.1, 0.25], "p_value": 1e-9}, "negligible", "they add less than the margin"),
        (
            {"torque": None, "ci95": None, "p_value": 1.0},
            "undetermined",
            "of unknown size, p-value not known;",
        ),
        ({"joints": [6], "left_out": False}, "undetermined", "Joint 6 moves during 5.0 % of"),
        ({"ci95": [0.31, 0.5], "p_value": 0.3}, "undetermined", "p-value 0.3"),
    ],
)
def test_little_is_not_named_but_said(changed, standing, said):
    plain = diagnosis(verdict="no_evidence", margin=0.3)
    document = with_other_joint(plain, motion(**changed))
    assert (document.verdict, document.causes) == ("no_evidence", ())
    (cause,) = document.visible
    assert cause.standing == standing
    text = verdict_text(document)
    assert said in text
    assert f"found: {cause.statement}" in text
    assert cause.statement.endswith("used nonetheless." if "left_out" in changed else "left out.")
    (shown,) = visible_texts(document)
    assert shown.note == cause.statement


def test_beside_other_findings_it_comes_before_structure_without_a_name():
    found = diagnosis(sets=[["drift"], []], verdict="unnamed", margin=0.3)
    document = with_other_joint(found, motion(ci95=[0.9, 1.3], p_value=1e-9))
    assert [cause.effects for cause in document.causes] == [("drift",), (OTHER_JOINT,), ()]
    assert [cause.effects for cause in document.modelled_causes] == [("drift",)]
    assert document.verdict == "unnamed"


def test_where_the_load_has_a_channel_of_its_own_it_is_in_the_friction():
    document = with_other_joint(diagnosis(margin=0.3, load_unit="N·m", torque_unit="A"), motion())
    (cause,) = document.visible
    assert cause.channel == "friction"
    assert cause.parameters["torque"].unit == "A"


def test_others_that_stand_are_no_finding(tmp_path):
    write_logs(tmp_path / "logs", settings(0.0))
    ingest([tmp_path / "logs"], tmp_path / "work")
    pair(tmp_path / "work")
    assert tables.facts(tmp_path / "work" / "pairs.parquet")["other_motion"] == {}
    plain = diagnosis(margin=0.3)
    assert with_other_joint(plain, None) is plain


def test_a_log_without_their_positions_says_nothing(unknown):
    assert not found_in(unknown.document)
    assert "other_joint" not in unknown.text
