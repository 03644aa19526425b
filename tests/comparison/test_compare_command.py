"""``frictioncli compare`` on work folders: what it writes, says, and refuses."""

import json
from datetime import timedelta

import numpy as np
import pytest

from frictioncli.comparison.settings import ComparisonSettings
from frictioncli.errors import OptionError, TableError
from frictioncli.stages.compare import compare as stage
from tests.command_line import invoke
from tests.comparison.folders import FIRST, one_each, write_folder
from tests.equation_16 import daily_torques


def called_with(runs, out, threshold):
    return invoke("compare", *runs, "-w", out, "--fail-above", threshold)


@pytest.fixture(scope="module")
def worn(tmp_path_factory):
    """Five work folders a week apart; friction grows by 20 %."""
    root = tmp_path_factory.mktemp("worn")
    return one_each(root, daily_torques(5, share=np.linspace(0, 0.2, 5), seed=3))


@pytest.fixture(scope="module")
def called(worn, tmp_path_factory):
    """The command's folder and exit status, the runs named last to first."""
    out = tmp_path_factory.mktemp("out") / "comparison"
    return out, called_with(worn[::-1], out, "5%").exit_code


def test_a_change_above_the_threshold_ends_with_status_3(called):
    assert called[1] == 3


def test_what_is_written(called):
    out, _ = called
    assert sorted(path.name for path in out.iterdir()) == [
        "compare.html",
        "comparison.json",
        "trend.png",
        "trend.svg",
    ]
    document = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert document["verdict"] == "changed"
    assert document["threshold"] == {"value": 5.0, "unit": "%", "exceeded": True}
    # named last to first, ordered by their dates
    assert document["folders"] == [f"run-{number:02d}" for number in range(1, 6)]
    assert [run["days"] for run in document["runs"]] == [0.0, 7.0, 14.0, 21.0, 28.0]
    hours = 28 * 24
    trend = document["trend"]
    assert trend["per_1000_h"]["estimate"] == pytest.approx(
        trend["percent"]["estimate"] * 1000 / hours
    )
    assert set(document["provenance"]["inputs"]) == {
        f"run-{number:02d}/{file}"
        for number in range(1, 6)
        for file in ("torques.parquet", "model.json")
    }


def test_parameters_are_those_of_the_first_and_the_last_folder(called, worn):
    out, _ = called
    document = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    first, last = (
        json.loads((path / "model.json").read_text("utf-8")) for path in worn[:: len(worn) - 1]
    )
    alpha = document["parameters"]["alpha"]
    assert alpha["first"] == first["parameters"]["alpha"]["estimate"]
    assert alpha["change"] == pytest.approx(
        last["parameters"]["alpha"]["estimate"] - first["parameters"]["alpha"]["estimate"]
    )
    # 0.0014 1/(N·m), and 20 % more
    assert alpha["ci95"][0] < 0.2 * 0.0014 < alpha["ci95"][1]


def test_the_same_inputs_give_the_same_bytes(called, worn, tmp_path):
    out, _ = called
    called_with(worn[::-1], tmp_path, "5%")
    for path in sorted(out.iterdir()):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_below_the_threshold_the_status_is_0_and_the_text_says_so(worn, tmp_path):
    result = called_with(worn, tmp_path, "40%")
    assert result.exit_code == 0
    said = result.stdout
    assert said.startswith("joint 2, 5 runs of 5 folders, 2026-01-05 to 2026-02-02: changed\n")
    assert "threshold 40 %: no change above it found" in said


def test_runs_of_one_folder_and_a_motor_current(tmp_path):
    table = daily_torques(3, seed=4)
    started_at = {
        run: FIRST + timedelta(days=n) for n, run in enumerate(sorted(table["run"].unique()))
    }
    folder = write_folder(tmp_path / "joint=2", table, started_at=started_at, unit="A")
    done = stage([folder], tmp_path / "out")
    assert "mean friction" in str(done)
    assert "N·m" not in str(done)
    document = json.loads(done.path.read_text(encoding="utf-8"))
    assert document["torque_unit"] == "A"
    assert document["parameters"] == {}
    assert [run["run"] for run in document["runs"]] == ["d01", "d02", "d03"]


def test_joints_must_be_the_same(tmp_path):
    table = daily_torques(2)
    one = write_folder(tmp_path / "one", table[table["run"] == "d01"])
    two = write_folder(tmp_path / "two", table[table["run"] == "d02"].assign(joint=3))
    with pytest.raises(OptionError, match="one: 2; two: 3; compare folders of one joint"):
        stage([one, two], tmp_path / "out")
    with pytest.raises(OptionError, match="--joint 5"):
        stage([one, two], tmp_path / "out", ComparisonSettings(joint=5))
    assert not (tmp_path / "out").exists()


def test_a_folder_without_a_model_is_said(tmp_path):
    with pytest.raises(TableError, match=r"model\.json is missing; run 'frictioncli fit' first"):
        stage([tmp_path / "a", tmp_path / "b"], tmp_path / "out")


def test_a_scatter_of_nothing_is_refused():
    with pytest.raises(OptionError, match="day-to-day 0 %"):
        ComparisonSettings(day_to_day=0.0)
