"""The sample logs by regression, against the truth about the arm and against their pairs."""

import json
from pathlib import Path

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.pairs.settings import SeparationSettings
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate

LOGS = Path(__file__).parents[2] / "sample_logs" / "kr10"


@pytest.fixture(scope="module")
def both_ways(tmp_path_factory):
    """Torques of the first day by pairs and by regression, and what the regression found."""
    work = tmp_path_factory.mktemp("work")
    ingest([LOGS / "day1"], work)
    pair(work)
    found = []
    for way in ("pairs", "regression"):
        separate(work, SeparationSettings(by=way))
        found.append(tables.read(work / "torques.parquet", schemas.TORQUES))
    return *found, tables.facts(work / "torques.parquet")["regression"]["2"]


def arm():
    """Bodies of the simulated arm, from its truth file."""
    truth = json.loads((LOGS / "truth.json").read_text(encoding="utf-8"))
    return truth["runs"][0]["joint"]["arm"]


@pytest.mark.slow
def test_inertia_and_gravity_are_those_of_the_arm(both_ways):
    bodies = [*arm()["bodies"], arm()["payload"]]
    inertia = arm()["rotor_inertia"] + sum(
        body["own_inertia"] + body["mass"] * (body["along"] ** 2 + body["across"] ** 2)
        for body in bodies
    )
    weight = sum(9.80665 * body["mass"] * body["along"] for body in bodies)
    parameters = both_ways[2]["parameters"]
    assert parameters["inertia"]["estimate"] == pytest.approx(inertia, rel=0.005)
    assert parameters["gravity_cos"]["estimate"] == pytest.approx(weight, rel=0.005)


@pytest.mark.slow
def test_friction_by_regression_is_that_of_the_pairs(both_ways):
    """At the speeds of the thermal cycle, in the same ten degrees and the same time."""
    pairs, regression, _ = both_ways
    keys = ["speed", "warm", "position", "phase"]
    medians = []
    for rows in (pairs, regression):
        near = np.argmin(np.abs(rows["speed"].to_numpy()[:, None] / [19.1, 39.4, 67.5] - 1), axis=1)
        level = np.array([19.1, 39.4, 67.5])[near]
        known = rows.assign(speed=level, warm=np.floor(rows["motor_temperature"] / 4) * 4)[
            np.abs(rows["speed"] / level - 1) < 0.03
        ]
        medians.append(known.groupby(keys)["friction_torque"].median())
    first, second = medians[0].align(medians[1], join="inner")
    assert len(first) > 500
    difference = second - first
    assert abs(difference.median()) < 0.15
    # what differs is the time within four degrees at which each took its rows
    assert difference.std() < 0.04 * first.mean()
