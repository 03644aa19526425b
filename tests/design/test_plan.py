"""The stage ``plan`` on a work folder: what it writes, says and refuses."""

import json
import shutil
from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.design.from_plan import interval_records, stated_half_widths
from frictioncli.design.plan import plan_joint
from frictioncli.design.predicted_rows import predict_rows
from frictioncli.design.selection import steps_of
from frictioncli.design.settings import PlanSettings
from frictioncli.diagnosis.documents.extended_document import EffectRecord, ParameterRecord
from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import FrictionError
from frictioncli.provenance import Provenance
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.plan import plan, plan_new
from frictioncli.workfiles import TORQUES
from tests.design.few_programmes import few_programmes
from tests.design.krl import Controller
from tests.design.model_arm import Arm
from tests.simulation.motion_programme import MeasuredMoves, UnrecordedMoves, simulate_programmes

FASTEST = 101.2
ASKED = PlanSettings(minutes=30.0, to="krl", rated_speed=225.0)


def planned_quickly(work, asked):
    """Plan, with few programmes to choose from; return what is said."""
    with few_programmes():
        return str(plan(work, asked))


@pytest.fixture(scope="module")
def thin(tmp_path_factory):
    """A work folder with an experiment that only heats, on a joint with a hidden gear."""
    work = tmp_path_factory.mktemp("plan") / "run"
    series = MeasuredMoves(speeds=(20.0, 60.0, FASTEST), low=0.0, high=180.0)
    heat = UnrecordedMoves(speed=FASTEST, low=0.0, high=180.0, seconds=360.0)
    settings = SynthesisSettings(seed=6, joint_kind="plain", effects=("thermal_lag:2.5",))
    (table,) = simulate_programmes(settings, [[series, heat] * 8], 1)
    work.mkdir()
    facts = {"torque_unit": "N·m", "torque_side": "joint", "sign": {"2": 1}}
    tables.write(work / TORQUES, table, schemas.TORQUES, Provenance("separate"), facts)
    fit(work)
    # so few pairs tell what is there, and not how much of it
    diagnose(work, DiagnosisSettings(margin=0.1))
    # as if they left two names: what a plan asks does not depend on how sure this joint's are
    found = json.loads((work / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["causes"][0]["effects"] == ["thermal_lag"]
    found["causes"][0]["effects"] = ["thermal_lag", "run_in"]
    found["verdict"] = "ambiguous"
    (work / "diagnosis.json").write_text(json.dumps(found), encoding="utf-8")
    return work


@pytest.fixture
def copy(thin, tmp_path):
    """A copy of it."""
    return shutil.copytree(thin, tmp_path / "run")


@pytest.fixture(scope="module")
def planned(thin, tmp_path_factory):
    """The plan of it as a KUKA program: its folder and what was said."""
    work = shutil.copytree(thin, tmp_path_factory.mktemp("planned") / "run")
    return work, planned_quickly(work, ASKED)


def document(work):
    return json.loads((work / "plan.json").read_text(encoding="utf-8"))


def test_the_set_is_the_question(thin, planned):
    found = json.loads((thin / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "ambiguous"
    (question,) = document(planned[0])["questions"]
    assert set(found["causes"][0]["effects"]) <= set(question["effects"])
    assert sum(question["probabilities"].values()) == pytest.approx(1.0, abs=1e-3)
    sure = question["right_name_alone"]
    assert 0 <= sure["now"] <= sure["after"] <= 1
    assert sure["after"] > 0.3


def test_the_plan_fits_into_its_budget_and_its_parts_follow_each_other(planned):
    told = document(planned[0])
    whole = told["programme"]["duration_s"] + told["check"]["duration_s"]
    assert told["budget_min"] == 30.0
    assert whole <= 30 * 60
    assert told["programme"]["duration_s"] > 10 * 60
    at = 0.0
    for block in told["programme"]["blocks"]:
        assert block["start_s"] == pytest.approx(at, abs=0.5)
        at += block["duration_s"]
    assert at == pytest.approx(told["programme"]["duration_s"], abs=1.0)


def test_intervals_only_become_narrower(planned):
    rows = document(planned[0])["intervals"]
    assert {row["parameter"] for row in rows} >= {"tau_c", "alpha", "beta", "gamma", "delta"}
    for row in rows:
        assert 0 < row["half_width_after"] <= row["half_width_now"] * 1.001
        assert row["unit"]


def test_the_program_does_what_the_plan_says(planned):
    work, _ = planned
    told = document(work)
    for part in ("programme", "check"):
        files = sorted(told[part]["files"])
        data, source = ((work / name).read_text(encoding="ascii") for name in files)
        arm = Arm([0.0, 45.0, 0.0, 0.0, 0.0, 0.0])
        Controller(source, data, arm, 225.0).run()
        speeds = [
            speed
            for block in told[part]["blocks"]
            for step in block["steps"]
            if step["kind"] == "series"
            for speed in step["speeds_deg_s"]
        ]
        assert [m.speed for m in arm.moves if m.traced][::2] == pytest.approx(speeds, rel=1e-4)
        limits = told["limits"]
        for move in arm.moves:
            assert move.axis == told["joint"]
            assert limits["low_deg"] - 1e-6 <= move.target <= limits["high_deg"] + 1e-6
            assert move.speed <= limits["fastest_deg_s"] * (1 + 1e-5)
        assert arm.clock == pytest.approx(told[part]["duration_s"], rel=0.06)


def test_the_limits_are_those_of_the_data(thin, planned):
    torques = tables.read(thin / TORQUES, schemas.TORQUES)
    limits = document(planned[0])["limits"]
    assert limits["fastest_deg_s"] == pytest.approx(torques["speed"].max())
    assert limits["low_deg"] >= torques["position"].min() - 2.5
    assert limits["high_deg"] <= torques["position"].max() + 2.5
    assert limits["beyond_measured"] == []


def test_the_text_says_what_why_and_how(planned):
    _, said = planned
    for wanted in ("open:", "the right name alone", "next day", "reduced speed first", "within"):
        assert wanted in said


@pytest.mark.long
def test_the_same_call_gives_the_same_bytes(planned, copy):
    work, said = planned
    again = planned_quickly(copy, ASKED)
    assert again.replace(str(copy), str(work)) == said
    told = document(work)
    programs = [name for part in ("programme", "check") for name in told[part]["files"]]
    for name in ("plan.json", *programs):
        assert (copy / name).read_bytes() == (work / name).read_bytes()


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({"low": 175.0}, "at least"),
        ({"to": "krl", "rated_speed": 90.0}, "rated speed"),
        ({"joint": 5}, "has joint 2"),
    ],
)
def test_what_is_refused_leaves_nothing_behind(copy, asked, reason):
    with pytest.raises(FrictionError, match=reason):
        plan(copy, PlanSettings(**asked))
    assert not (copy / "plan.json").exists()
    assert not list(copy.glob("friction_a*"))


@pytest.mark.long
def test_a_payload_that_there_is_no_time_to_mount_is_left_out(copy):
    planned_quickly(copy, PlanSettings(minutes=5.0, payload=(4.0,), high=60.0))
    assert all("payload" not in one["name"] for one in document(copy)["programme"]["blocks"])


def without_a_name(work, form=None):
    """Say of a work folder that what was found has no name, or that a form describes it."""
    ranges = {"position": [0.0, 180.0], "speed": [20.0, FASTEST], "temperature": [16.0, 37.0]}
    empirical = {
        "forms": [{"kind": "peak", "channel": "friction", "formula": ""} | (form or {})],
        "functions": [],
        "ranges": ranges | {"load": [0.0, 95.0]},
        "base_changes": {},
        "gravity_changes": {"cosine": 0.0, "sine": 0.0, "offset": 0.0},
        "torque_unit": "N·m",
        "units": {},
        "size": 1.0,
    }
    for name, key in (("diagnosis.json", "causes"), ("extended-model.json", "effects")):
        told = json.loads((work / name).read_text(encoding="utf-8"))
        for part in (told, *told.get("joints", {}).values()):
            part[key] = []
            if key == "causes":
                part["verdict"] = "unnamed"
            elif form is not None:
                part["empirical"] = empirical
        (work / name).write_text(json.dumps(told), encoding="utf-8")


def test_structure_without_a_name_gets_blocks_that_spread_over_all_inputs(copy):
    without_a_name(copy)
    said = str(plan(copy, PlanSettings(minutes=25.0)))
    assert "no known effect explains" in said
    blocks = document(copy)["programme"]["blocks"]
    steps = [step for block in blocks for step in block["steps"]]
    # the data at hand heat the joint at three speeds from end to end, and never let it rest
    assert {step["kind"] for step in steps} >= {"series", "rest"}
    series = [step for step in steps if step["kind"] == "series"]
    speeds = np.unique([speed for step in series for speed in step["speeds_deg_s"]])
    assert len(speeds) >= 6
    assert speeds.min() < 20.0 / 2
    assert len({(step["low_deg"], step["high_deg"]) for step in series}) >= 2


@pytest.fixture
def rows_planned(copy):
    """Speeds, angles and motor temperatures of the rows that a plan would add, by its form."""

    def planned(form):
        without_a_name(copy, form)
        torques = tables.read(copy / TORQUES, schemas.TORQUES)
        (diagnosed, extended) = next(iter(read_documents(copy).values()))
        experiment = plan_joint(torques, "N·m", diagnosed, extended, PlanSettings(minutes=25.0))
        steps = steps_of(experiment.blocks)
        return predict_rows(experiment.criterion.joint, steps, "planned")[0], experiment

    return planned


def errors(rows, column, centre, width):
    """Return the errors of height and place of a peak from rows with white noise alone.

    Beside what friction and gravity are made of, by ordinary least squares.
    """
    angle, speed, warm = (rows[name] for name in ("position", "speed", "motor_temperature"))
    away = np.log(speed / centre) if column == "speed" else rows[column] - centre
    peak = np.exp(-np.square(away / width) / 2)
    base = [angle**0, rows.load_torque**2, speed**0.5, speed**0.5 * warm, np.cos(np.radians(angle))]
    columns = np.column_stack([*base, peak, peak * away / width])
    return np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))[-2:]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("axis", "column", "kind", "shape", "least"),
    [
        pytest.param(
            *("speed", "speed", "peak", {"centre": 40.0, "width": 0.15}, 1.5),
            marks=pytest.mark.long,
        ),
        pytest.param(
            *("position", "position", "bump", {"centre": 50.0, "width": 4.0, "lag": 0.0}, 1.1),
            marks=pytest.mark.long,
        ),
        pytest.param(
            *("temperature", "motor_temperature", "peak", {"centre": 22.0, "width": 1.0}, 1.5),
            marks=pytest.mark.long,
        ),
    ],
    ids=["speed", "angle", "temperature"],
)
def test_blocks_concentrate_where_structure_was_located(
    rows_planned, axis, column, kind, shape, least
):
    """Height and place are better known than after as long a plan that knows of no place."""
    spread, _ = rows_planned(None)
    form = {"kind": kind, "axes": [axis], "shape": shape, "coefficients": {"peak": 2.0}}
    rows, experiment = rows_planned(form)
    place = column, shape["centre"], shape["width"]
    ratio = errors(spread, *place) / errors(rows, *place)
    assert (ratio > least).all()
    near = [block for block in experiment.blocks if f"about {shape['centre']:.3g}" in block.name]
    assert len(near) >= 2 or axis == "temperature"
    assert experiment.check
    # what changes it is asked, too
    assert rows.speed.max() > 2 * rows.speed.min()


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({}, "safe limits are not known"),
        ({"low": 0.0, "high": 5.0, "max_speed": 50.0}, "at least"),
        ({"low": 0.0, "high": 90.0, "max_speed": 150.0, "rated_speed": 100.0}, "at most"),
    ],
)
def test_a_new_joint_needs_all_its_limits(tmp_path, asked, reason):
    with pytest.raises(FrictionError, match=reason):
        plan_new(tmp_path / "new", PlanSettings(joint=1, **asked))
    assert not (tmp_path / "new").exists()


def test_a_plan_needs_a_diagnosis_of_these_runs(copy):
    torques = tables.read(copy / TORQUES, schemas.TORQUES).assign(run="another day")
    tables.write(copy / TORQUES, torques, schemas.TORQUES, Provenance("separate"))
    with pytest.raises(FrictionError, match="run 'frictioncli diagnose' again"):
        plan(copy)
    (copy / "diagnosis.json").unlink()
    with pytest.raises(FrictionError, match="run 'frictioncli diagnose' first"):
        plan(copy)


def test_without_data_the_papers_algorithms_are_written(tmp_path):
    work = tmp_path / "new"
    asked = PlanSettings(joint=2, low=-100.0, high=0.0, max_speed=150.0, to="urscript")
    assert "Algorithms 1 and 2" in str(plan_new(work, asked))
    blocks = document(work)["programme"]["blocks"]
    sweep = blocks[0]["steps"][0]["speeds_deg_s"]
    assert (sweep[0], sweep[-1]) == (2.3, pytest.approx(101.2, abs=0.3))
    heating = [step["until_degC"] for step in blocks[1]["steps"] if step["kind"] == "heat"]
    assert heating == list(np.arange(25.0, 66.0))
    assert (work / "friction_a2_new.script").exists()


def test_intervals_now_are_those_that_the_diagnosis_states():
    """One source: the page shows the diagnosis's intervals beside the plan's."""
    effect = EffectRecord(
        name="stribeck",
        equation="",
        channel="friction",
        shape={},
        coefficients={
            "boundary_torque": ParameterRecord(estimate=3.0, ci95=(2.6, 3.4), unit="N·m"),
            "other": ParameterRecord(estimate=0.0, ci95=(0.0, 0.0), unit="1"),
            "unknown": ParameterRecord(estimate=1.0, ci95=None, unit="1"),
        },
    )
    model = SimpleNamespace(
        parameters={
            "beta": SimpleNamespace(ci95=(3.0, 6.0), determined=True),
            "tau_c": SimpleNamespace(ci95=(0.0, 0.6), determined=False),
            "delta": SimpleNamespace(ci95=None, determined=False),
        },
        effects=(effect,),
    )
    stated = stated_half_widths(model)
    assert stated == pytest.approx(
        {
            "beta": 1.5,
            "tau_c": np.inf,
            "delta": np.inf,
            "stribeck.boundary_torque": 0.4,
            "stribeck.other": 0.0,
        }
    )
    # a cause's interval allows for its shape: the report states it, and so does the plan
    wide = SimpleNamespace(
        effects=("stribeck", "drift"),
        parameters={
            "boundary_torque": ParameterRecord(estimate=3.0, ci95=(1.0, 5.0), unit="N·m"),
            "velocity": ParameterRecord(estimate=8.0, ci95=(4.0, 12.0), unit="deg/s"),
        },
    )
    assert stated_half_widths(model, (wide,)) == stated | {"stribeck.boundary_torque": 2.0}
    names = (*stated, "gamma")
    plan = SimpleNamespace(
        torque_unit="N·m",
        expected=(
            SimpleNamespace(half_widths=dict.fromkeys(names, 0.2)),
            SimpleNamespace(half_widths=dict.fromkeys(names, 0.1)),
        ),
        criterion=SimpleNamespace(
            open_questions=SimpleNamespace(causes=()),
            estimates=dict.fromkeys(names, 1.0),
            usual_sizes={"tau_c": 0.5, "delta": 0.05},
            of_interest=names,
        ),
    )
    found = {one.parameter: one for one in interval_records(plan, {}, stated)}
    assert (found["beta"].half_width_now, found["beta"].half_width_after) == (1.5, 0.75)
    assert found["gamma"].half_width_now == 0.2
    # the programme determines the one, ±0.1 is more than the other is
    tau_c, delta = found["tau_c"], found["delta"]
    assert (tau_c.estimate, tau_c.half_width_now, tau_c.half_width_after) == (None, None, 0.1)
    assert (delta.estimate, delta.half_width_now, delta.half_width_after) == (None, None, None)
    assert [name for name, one in found.items() if not one.wide] == ["stribeck.other"]
