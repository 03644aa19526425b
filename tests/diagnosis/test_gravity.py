"""Gravity goes with the payload where payloads are known, and is what it was where they are not."""

import json

import msgspec
import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.diagnosis.data.build_problem import build_problems, simulated
from frictioncli.diagnosis.data.gravity import GravityForm, gravity_columns
from frictioncli.diagnosis.data.gravity_document import gravity_document, stated_gravity
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.apply_extension import without_effects
from frictioncli.diagnosis.documents.document import read_diagnoses
from frictioncli.diagnosis.documents.extended_document import read_extended
from frictioncli.diagnosis.documents.reload import read_documents, reload
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import TableError
from frictioncli.model.document import read_models
from frictioncli.provenance import Provenance
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, TORQUES
from tests.equation_16 import cycle_temperatures, torques

P, Q, C, PER_KG, ASIDE = 70.0, 5.0, -2.0, 8.3, 0.6
GRAVITY = [P, Q, C, PER_KG, ASIDE]


def carried(payloads=(0.0, 3.0, 5.0), *, noise=0.0, undeclared=0.0):
    """Two days, payloads in turn from pair to pair; a mass that nobody tells on the second half.

    The gear carries the constant of gravity, as it does the rest.
    """
    temperature, time, phase = (values[::4] for values in cycle_temperatures())
    rows = pd.concat(
        [
            torques(day, temperatures=(temperature, time, phase)).assign(run=f"day{day}")
            for day in (1, 2)
        ],
        ignore_index=True,
    )
    payload = np.array(payloads)[rows["pair"] % len(payloads)]
    late = (rows["run"] == "day2") | (rows["pair"] > rows["pair"].max() / 2)
    angle = np.radians(rows["position"])
    mass = payload + undeclared * late
    load = (P + PER_KG * mass) * np.cos(angle) + (Q + ASIDE * mass) * np.sin(angle) + C
    friction = rows["friction_torque"] + 0.0014 * (np.square(load) - np.square(rows["load_torque"]))
    noisy = load + noise * np.random.default_rng(3).normal(size=len(rows))
    return rows.assign(load=np.nan, load_torque=noisy, friction_torque=friction, payload=payload)


def test_gravity_of_known_payloads_is_recovered():
    seen, new = build_problems(carried(), "motor", "day2")
    np.testing.assert_allclose(seen.gravity, GRAVITY, atol=1e-6)
    np.testing.assert_array_equal(new.gravity, seen.gravity)
    assert seen.load_base.shape[1] == new.load_base.shape[1] == 5
    assert np.abs(new.load_misfit).max() < 1e-6
    assert seen.parameters.alpha == pytest.approx(0.0014, rel=0.02)


def test_the_load_that_effects_see_goes_with_the_payload():
    rows = carried()
    seen, _ = build_problems(rows, "motor", "day2")
    ordered = rows[rows["run"] == "day1"].sort_values(["time", "pair", "position"])
    np.testing.assert_allclose(seen.table.load, ordered["load_torque"], atol=1e-6)
    np.testing.assert_allclose(seen.all_runs.load[seen.rows], seen.table.load)


@pytest.mark.parametrize(
    "payload", [np.nan, 2.0, [2.0, np.nan]], ids=["unknown", "one", "one and unknown"]
)
def test_one_payload_is_a_single_sine(payload):
    rows = carried(payloads=(2.0,), noise=0.1)
    mass = np.resize(payload, rows["pair"].max() + 1)[rows["pair"]]
    bare, _ = build_problems(rows.drop(columns="payload"), "motor", "day2")
    problem, _ = build_problems(rows.assign(payload=mass), "motor", "day2")
    assert problem.load_base.shape[1] == 3
    np.testing.assert_array_equal(problem.gravity, bare.gravity)
    # the delay, taken off before the base is fitted, is summed in another order
    np.testing.assert_allclose(problem.friction_base, bare.friction_base, rtol=1e-9)
    assert set(msgspec.to_builtins(gravity_document(problem.gravity))) == {
        "cosine",
        "sine",
        "offset",
    }


def test_a_payload_left_empty_beside_others_is_none():
    rows = carried()
    empty = rows.assign(payload=rows["payload"].where(rows["payload"] > 0))
    seen, _ = build_problems(empty, "motor", "day2")
    np.testing.assert_allclose(seen.gravity, GRAVITY, atol=1e-6)


def test_only_the_runs_seen_decide_whether_gravity_goes_with_the_payload():
    rows = carried()
    one = rows[(rows["run"] == "day2") | (rows["payload"] == 3.0)]
    seen, new = build_problems(one, "motor", "day2")
    assert len(seen.gravity) == 3
    assert new.load_base.shape[1] == 3


def test_rows_are_simulated_with_as_many_coefficients_as_are_given():
    rows = carried().sample(frac=1.0, random_state=1)
    seen, _ = build_problems(rows, "motor", None)
    order, problem = simulated(rows, "motor", seen.parameters, np.array(GRAVITY))
    np.testing.assert_allclose(problem.table.load, rows.loc[order, "load_torque"], atol=1e-6)
    _, plain = simulated(rows, "motor", seen.parameters, np.array([P, Q, C]))
    angle = np.radians(plain.table.position)
    np.testing.assert_allclose(plain.table.load, P * np.cos(angle) + Q * np.sin(angle) + C)


def test_columns_are_per_degree_and_kilogram():
    columns = gravity_columns(np.array([0.0, 90.0]), np.array([2.0, np.nan]))
    np.testing.assert_allclose(columns, [[1, 0, 1, 2, 0], [0, 1, 1, 0, 0]], atol=1e-12)


def test_files_state_gravity_as_they_did_and_payloads_beside():
    three = gravity_document(np.array([1.0, 2.0, 3.0]))
    assert msgspec.to_builtins(three) == {"cosine": 1.0, "sine": 2.0, "offset": 3.0}
    five = gravity_document(np.arange(5.0))
    assert list(msgspec.to_builtins(five))[3:] == ["cosine_per_kg", "sine_per_kg"]
    np.testing.assert_array_equal(stated_gravity(five), np.arange(5.0))
    np.testing.assert_array_equal(stated_gravity(three), [1, 2, 3])
    np.testing.assert_array_equal(
        stated_gravity(three, GravityForm(payloads=True)), [1, 2, 3, 0, 0]
    )
    with pytest.raises(TableError, match="frictioncli diagnose"):
        stated_gravity(five, GravityForm())


def work_of(work, rows):
    """Write some torques into a work folder and take it through the stages to the diagnosis."""
    rows = rows.assign(torque_forward=1.0, torque_reverse=1.0, n_forward=1, n_reverse=1)
    provenance = Provenance("test")
    tables.write(work / TORQUES, rows, schemas.TORQUES, provenance, {"torque_unit": "N·m"})
    fit(work)
    diagnose(work)
    return work


@pytest.fixture(scope="module")
def undeclared(tmp_path_factory):
    """The work folder of payloads in turn, with a mass that nobody tells."""
    return work_of(tmp_path_factory.mktemp("undeclared"), carried(noise=0.3, undeclared=0.2))


@pytest.fixture(scope="module")
def undeclared_in_a_pose(tmp_path_factory):
    """The work folder of poses in turn, with a mass in one of them that nobody tells."""
    return work_of(tmp_path_factory.mktemp("pose"), in_poses(undeclared=0.5))


def written(work):
    """Return the extended model that the stages have written."""
    return json.loads((work / EXTENDED).read_text(encoding="utf-8"))


def named(work):
    """Return the sets of effects that the diagnosis of a work folder names."""
    (found,) = read_diagnoses(work / DIAGNOSIS).values()
    return [cause.effects for cause in found.causes]


def test_payloads_in_turn_are_no_finding_and_an_undeclared_mass_is(undeclared):
    clean = diagnose_joint(carried(noise=0.3), "motor", "N·m", DiagnosisSettings())
    assert clean.verdict == "no_evidence"
    # 1.7 % of gravity may be another scale of the torque, at 6 %
    assert "payload_change" in [one[0] for one in named(undeclared)]


def read_back_predicts_load(work):
    """Check the extended model as it is read back on the new run, and return it."""
    stored = tables.read(work / TORQUES, schemas.TORQUES)
    (document, extended), *_ = read_documents(work).values()
    found = reload(stored, document, extended)
    before, after = (np.std(rows["load"]) for rows in (found.new.before, found.new.after))
    assert after < 0.5 < before
    (model,) = read_models(work / EXTENDED)
    added = without_effects(stored, model, read_extended(work / EXTENDED)[2])[2]
    assert added.abs().max() < 1.0  # the effect is of the load: friction hardly changes
    return extended


def test_an_extended_model_with_payloads_is_read_back(undeclared):
    extended = written(undeclared)
    assert extended["gravity"]["cosine_per_kg"] == pytest.approx(PER_KG, abs=0.2)
    assert set(extended["gravity_about"]) == set(extended["gravity"])
    read_back_predicts_load(undeclared)


@pytest.mark.parametrize("sign", [1, -1])
def test_gravity_s_derivatives_are_differences_over_the_angle_and_turn_with_the_sign(sign):
    rows = carried()
    forward = rows["load_torque"] + sign * rows["friction_torque"]
    reverse = rows["load_torque"] - sign * rows["friction_torque"]
    rows = rows.assign(torque_forward=forward, torque_reverse=reverse)
    table = build_problems(rows, "motor")[0].table
    for name in np.unique(table.pair)[::40]:
        one = table.pair == name
        angle, load = table.position[one], table.load[one]
        gradient, curvature = sign * table.load_gradient[one], table.load_curvature[one]
        # central differences, error h²/6 of the third derivative
        assert gradient[1:-1] == pytest.approx(
            (load[2:] - load[:-2]) / (angle[2:] - angle[:-2]), rel=0.01
        )
        step = angle[1] - angle[0]
        assert curvature[1:-1] == pytest.approx(np.diff(load, 2) / step**2, rel=0.01)


def test_gravity_s_slope_is_that_of_the_logged_current_where_load_is_a_channel_of_its_own():
    rows = carried(payloads=(3.0,))
    current = 0.02 * rows["load_torque"]
    rows = rows.assign(
        load=rows["load_torque"],
        torque_forward=current + 1.0,
        torque_reverse=current - 1.0,
    )
    table = build_problems(rows, "motor")[0].table
    other = build_problems(carried(payloads=(3.0,)), "motor")[0].table
    assert table.load_gradient == pytest.approx(0.02 * other.load_gradient)


def in_poses(*, noise=0.3, change=25.0, days=(0, 1), undeclared=0.0):
    """Two days, another pose every ten pairs; ``days`` are the second day's poses.

    In pose 1 gravity is less by a cosine and some sine; in pose 2 it is that of pose 0.
    """
    rows = carried(payloads=(2.0,), noise=0.0, undeclared=undeclared).assign(payload=np.nan)
    block = (rows["pair"] // 10).to_numpy()
    pose = np.where(rows["run"] == "day1", block % 3, np.array(days)[block % len(days)])
    angle = np.radians(rows["position"])
    less = np.where(pose == 1, change * np.cos(angle) - 0.3 * change * np.sin(angle), 0.0)
    load = rows["load_torque"] - less
    friction = rows["friction_torque"] + 0.0014 * (np.square(load) - np.square(rows["load_torque"]))
    noisy = load + noise * np.random.default_rng(4).normal(size=len(rows))
    return rows.assign(load_torque=noisy, friction_torque=friction, pose=pose)


def test_each_pose_that_differs_has_a_gravity_of_its_own():
    seen, new = build_problems(in_poses(noise=1e-6), "motor", "day2")
    assert seen.gravity_form.poses == ((1,),)
    expected = [P + 2 * PER_KG, Q + 2 * ASIDE, C, -25.0, 7.5]
    np.testing.assert_allclose(seen.gravity, expected, atol=1e-4)
    assert np.abs(new.load_misfit).max() < 1e-4
    # the load in the friction is that of the pose
    assert seen.parameters.alpha == pytest.approx(0.0014, rel=0.02)


def test_poses_that_change_nothing_share_a_gravity():
    """Of forty comparisons a few at most take noise for a difference: the level is 1 %."""
    apart = 0
    for seed in range(20):
        rows = in_poses(noise=0.0, change=0.0)
        rng = np.random.default_rng(seed)
        of_pair = rng.normal(0, 0.5, rows["pair"].max() + 1)[rows["pair"]]
        rows["load_torque"] += of_pair + rng.normal(0, 0.3, len(rows))
        seen, _ = build_problems(rows, "motor", "day2")
        apart += len(seen.gravity_form.poses)
    assert apart <= 3


def test_gravity_in_a_pose_that_only_the_new_run_has_is_fitted_there():
    rows = in_poses(noise=1e-6, days=(1, 5))
    five = rows["pose"] == 5
    angle = np.radians(rows["position"])
    rows.loc[five, "load_torque"] += 11 * np.cos(angle[five])
    seen, new = build_problems(rows, "motor", "day2")
    assert len(seen.gravity) == len(new.gravity) == 5
    assert np.abs(new.load_misfit).max() < 1e-4
    ordered = rows[rows["run"] == "day2"].sort_values(["time", "pair", "position"])
    np.testing.assert_allclose(new.table.load, ordered["load_torque"], atol=1e-4)


@pytest.mark.parametrize(
    "days",
    [
        pytest.param((0, 1), id="in turn", marks=pytest.mark.long),
        pytest.param((4,), id="a new one", marks=pytest.mark.long),
    ],
)
def test_poses_known_from_the_log_are_no_finding(days):
    """Without the poses the same log is not understood."""
    rows = in_poses(days=days)
    known = diagnose_joint(rows, "motor", "N·m", DiagnosisSettings())
    assert known.verdict == "no_evidence"
    assert not [cause.effects for cause in known.visible]
    hidden = diagnose_joint(rows.assign(pose=0), "motor", "N·m", DiagnosisSettings())
    assert hidden.verdict != "no_evidence"


@pytest.mark.long
def test_a_payload_in_one_pose_is_found_beside_the_gravity_of_the_others(undeclared_in_a_pose):
    assert named(undeclared_in_a_pose) == [("payload_change",)]


def test_an_extended_model_states_the_gravity_of_each_pose(undeclared_in_a_pose):
    (other,) = written(undeclared_in_a_pose)["gravity"]["in_poses"]
    assert other["poses"] == [1]
    assert other["cosine"] == pytest.approx(-25.0, abs=0.6)
    extended = read_back_predicts_load(undeclared_in_a_pose)
    with pytest.raises(TableError, match="other poses of the other joints"):
        stated_gravity(extended.gravity, GravityForm())


def test_a_payload_known_on_the_new_run_alone_is_no_misfit_there():
    rows = carried(payloads=(0.0,))
    late = rows["run"] == "day2"
    angle = np.radians(rows["position"])
    rows.loc[late, "load_torque"] += 5 * np.cos(angle[late])
    seen, new = build_problems(rows.assign(payload=3.0 * late), "motor", "day2")
    assert len(seen.gravity) == 3
    assert np.abs(new.load_misfit).max() < 1e-6
    _, unknown = build_problems(rows.assign(payload=np.nan), "motor", "day2")
    assert np.abs(unknown.load_misfit).max() == pytest.approx(5, rel=0.01)
