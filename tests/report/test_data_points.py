"""The chart's points against the tables and the diagnosis that they come from."""

from base64 import b64decode

import numpy as np
import pytest

from frictioncli.report.data_points import data_points


def unpacked(column):
    levels = np.frombuffer(b64decode(column["levels"]), "<u2")
    return column["low"] + column["step"] * levels


def columns(points):
    return {name: unpacked(column) for name, column in points["columns"].items()}


def near(column, expected):
    half = 0.51 * column["step"]
    return unpacked(column) == pytest.approx(np.asarray(expected), abs=half)


def test_without_a_diagnosis_every_row_of_the_torques_is_there(two_runs):
    points = data_points(two_runs)
    rows = two_runs.torques.sort_values(["run", "time", "pair", "position"], kind="stable")
    assert near(points["columns"]["angle"], rows["position"])
    assert near(points["columns"]["u_forward"], rows["load_torque"] + rows["friction_torque"])
    assert near(points["columns"]["u_reverse"], rows["load_torque"] - rows["friction_torque"])
    predicted = two_runs.predict(
        load=rows["load_torque"], speed=rows["speed"], temperature=rows["motor_temperature"]
    )
    missed = rows["friction_torque"] - predicted
    assert near(points["columns"]["base_forward"], missed)
    assert near(points["columns"]["base_reverse"], -missed)
    assert points["extended"] is False


def test_rows_belong_to_moves(two_runs):
    points = data_points(two_runs)
    pairs = two_runs.torques.drop_duplicates(["run", "pair"]).sort_values(["run", "time"])
    assert points["moves"] == len(pairs) == len(points["length"])
    assert points["speed"] == pytest.approx(pairs["speed"].to_numpy(), abs=0.01)
    assert points["time"] == pytest.approx(pairs["time"].to_numpy() / 60, abs=0.01)
    assert [points["runs"][run] for run in points["run"]] == pairs["run"].tolist()
    assert set(points["length"]) == set(two_runs.torques.groupby(["run", "pair"]).size())


def test_with_a_diagnosis_residuals_are_those_of_both_models(diagnosed):
    points = data_points(diagnosed)
    reloaded = diagnosed.diagnosis
    parts = [part for part in (reloaded.seen, reloaded.new) if part is not None]
    for model, misfits in (
        ("base", [part.before for part in parts]),
        ("ext", [part.after for part in parts]),
    ):
        load, friction = (
            np.concatenate([missed[channel] for missed in misfits])
            for channel in ("load", "friction")
        )
        assert near(points["columns"][f"{model}_forward"], load + friction)
        assert near(points["columns"][f"{model}_reverse"], load - friction)
    assert points["extended"] is True


def test_of_too_many_moves_evenly_spaced_ones_are_left_out(two_runs):
    every = data_points(two_runs)
    few = data_points(two_runs, most_rows=sum(every["length"]) // 3)
    assert few["step"] == 3 or few["step"] == 4
    assert few["number"] == every["number"][:: few["step"]]
    assert few["moves"] == every["moves"]
    assert len(unpacked(few["columns"]["angle"])) == sum(few["length"])


def test_a_joint_without_temperature_offers_no_such_axis(without_temperature):
    points = data_points(without_temperature)
    assert points["temperatures"] == {}


def test_in_amperes_the_unit_is_said(current_log):
    assert data_points(current_log)["unit"] == "A"
