"""Synthesized folders: their form, that they repeat byte for byte, and what they refuse."""

import csv
import json
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from frictioncli.errors import OptionError
from frictioncli.simulator.synthesize import SynthesisSettings, synthesize

SAMPLE_LOGS = Path(__file__).parents[2] / "sample_logs" / "kr10"
SHORT = {"runs": 1, "lowest": 25, "highest": 28}
TRACE_HEADER = (
    b"Zeit[sec];AxisPos_Act2[\xb0];GearTorq_Act2[Nm];Motortemperatur2[\xb0C];"
    b"Gehaeusetemperatur2[\xb0C]\n"
)


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def table(path: Path) -> np.ndarray:
    return np.loadtxt(path, delimiter=";", skiprows=1, encoding="cp1252")


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    folder = tmp_path_factory.mktemp("synthesis") / "short"
    return folder, synthesize(folder, SynthesisSettings(seed=3, **SHORT))


def manifest(folder: Path) -> list[dict[str, str]]:
    with (folder / "day1" / "manifest.csv").open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream, delimiter=";"))


def test_same_seed_gives_the_same_bytes(short, tmp_path):
    synthesize(tmp_path / "again", SynthesisSettings(seed=3, **SHORT))
    assert contents(tmp_path / "again") == contents(short[0])


def test_other_seed_gives_other_traces(short, tmp_path):
    synthesize(tmp_path / "other", SynthesisSettings(seed=4, **SHORT))
    mine, other = contents(short[0]), contents(tmp_path / "other")
    assert mine.keys() == other.keys()
    traces = [name for name in mine if name.endswith("KRCIpo.csv")]
    assert all(mine[name] != other[name] for name in traces)


def test_sample_logs_can_be_made_again(tmp_path):
    settings = json.loads((SAMPLE_LOGS / "truth.json").read_text(encoding="utf-8"))["settings"]
    synthesize(tmp_path / "kr10", SynthesisSettings(seed=settings["seed"]))
    mine, kept = contents(tmp_path / "kr10"), contents(SAMPLE_LOGS)
    assert mine.keys() == kept.keys()
    assert [name for name in mine if mine[name] != kept[name]] == []
    assert sum(map(len, kept.values())) < 20e6


def test_traces_have_the_layout_of_the_controller(short):
    folder, _ = short
    trace = (folder / "day1" / "012_heat-up_KRCIpo.csv").read_bytes()
    assert trace.startswith(TRACE_HEADER)
    assert trace.endswith(b"\n")
    assert b"\r" not in trace
    assert b"-0.00;" not in trace
    first = trace.splitlines()[1].decode("ascii").split(";")
    assert first[0] == "0.000"
    assert [len(cell.partition(".")[2]) for cell in first] == [3, 3, 2, 0, 1]
    assert np.diff(table(folder / "day1" / "012_heat-up_KRCIpo.csv")[:, 0]) == pytest.approx(0.012)


def test_manifest_tells_each_recording(short):
    folder, summary = short
    rows = manifest(folder)
    assert list(rows[0]) == ["file", "started_at", "phase", "payload", "ambient"]
    files = [row["file"] for row in rows]
    assert files == sorted(files)
    assert set(files) == {p.name for p in (folder / "day1").iterdir()} - {"manifest.csv"}
    assert summary.runs[0].recordings == len(rows)
    # 11 speeds; heating from 25 while below 28, cooling from 28 while above 25.
    phases = [row["phase"] for row in rows]
    assert phases == ["sweep"] * 11 + ["heat-up"] * 3 + ["cool-down"] * 3
    starts = [datetime.fromisoformat(row["started_at"]) for row in rows]
    for begin, following, name in zip(starts, starts[1:], files, strict=False):
        assert (following - begin).total_seconds() > table(folder / "day1" / name)[-1, 0]


def test_summary_counts_the_rows(short):
    folder, summary = short
    assert summary.runs[0].rows == sum(
        len(table(folder / "day1" / row["file"])) for row in manifest(folder)
    )
    assert "day1" in summary.files_text()
    assert "heat" in summary.truth_text()
    assert str(summary) == f"{summary.files_text()}\n{summary.truth_text()}"


def test_sweep_holds_each_speed_of_the_paper(short):
    folder, _ = short
    speeds = []
    for row in manifest(folder):
        if row["phase"] == "sweep":
            trace = table(folder / "day1" / row["file"])
            forward = (trace[:, 1] > 60.0) & (trace[:, 1] < 120.0)
            steps = np.abs(np.diff(trace[:, 1])[forward[1:]]) / 0.012
            speeds.append(np.median(steps))
    assert speeds[0] == pytest.approx(2.3, abs=0.1)
    assert speeds[-1] == pytest.approx(101.2, abs=0.2)
    for expected in (19.1, 67.5):
        assert np.min(np.abs(np.array(speeds) - expected)) < 0.1


def test_change_of_temperature_starts_a_series(short):
    folder, _ = short
    series = [row for row in manifest(folder) if row["phase"] != "sweep"]
    # Up to 25, 26, 27 and 28 °C, then down to 27 and 26 °C.
    for row, reached, step in zip(
        series, (25, 26, 27, 28, 27, 26), (1, 1, 1, 1, -1, -1), strict=True
    ):
        trace = table(folder / "day1" / row["file"])
        assert set(trace[trace[:, 0] < 0.599, 3].tolist()) == {reached - step}
        assert trace[trace[:, 0] > 0.601, 3][0] == reached
        # The joint stands until the change is seen.
        assert trace[trace[:, 0] < 0.9, 1] == pytest.approx(0.0)


def test_sign_convention_swaps_the_branches(tmp_path):
    quiet = {"noise_scale": 0.0, **SHORT}
    synthesize(tmp_path / "plus", SynthesisSettings(sign=1, **quiet))
    synthesize(tmp_path / "minus", SynthesisSettings(sign=-1, **quiet))
    name = "day1/012_heat-up_KRCIpo.csv"
    plus, minus = table(tmp_path / "plus" / name), table(tmp_path / "minus" / name)
    assert np.array_equal(plus[:, [0, 1, 3, 4]], minus[:, [0, 1, 3, 4]])
    constant = (plus[:, 0] > 2.0) & (plus[:, 0] < 9.0)  # forward at 19.1 deg/s
    assert np.all(plus[constant, 2] > minus[constant, 2] + 20.0)
    # Without noise the middle of both is gravity: no torque of friction is left in it.
    angle = np.radians(plus[constant, 1])
    shape = np.column_stack([np.cos(angle), np.sin(angle)])
    middle = (plus[constant, 2] + minus[constant, 2]) / 2.0
    left = middle - shape @ np.linalg.lstsq(shape, middle, rcond=None)[0]
    assert np.abs(left).max() < 0.05


def test_payload_changes_gravity_only_by_its_weight(tmp_path):
    quiet = {"noise_scale": 0.0, **SHORT}
    synthesize(tmp_path / "light", SynthesisSettings(payload=0.0, **quiet))
    synthesize(tmp_path / "heavy", SynthesisSettings(payload=4.0, **quiet))
    name = "day1/001_sweep_KRCIpo.csv"
    light, heavy = table(tmp_path / "light" / name), table(tmp_path / "heavy" / name)
    # At rest at 0 deg, 4 kg at 0.85 m.
    assert heavy[0, 2] - light[0, 2] == pytest.approx(4.0 * 9.81 * 0.85, abs=0.02)


def test_truth_tells_settings_and_temperatures(short):
    folder, _ = short
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    assert truth["settings"]["seed"] == 3
    run = truth["runs"][0]
    assert len(run["joint"]["zones"]) == 3
    recording = run["recordings"][12]
    trace = table(folder / "day1" / recording["file"])
    for trip in recording["round_trips"]:
        row = trace[np.searchsorted(trace[:, 0], trip["begin"] - recording["start"])]
        assert row[3] == pytest.approx(trip["temperatures"]["motor sensor"], abs=0.51)
        assert row[4] == pytest.approx(trip["temperatures"]["housing"], abs=0.06)


@pytest.mark.parametrize(
    "wrong",
    [
        {"seed": -1},
        {"runs": 0},
        {"joint": 0},
        {"sign": 0},
        {"payload": -1.0},
        {"noise_scale": -0.1},
        {"lowest": 30, "highest": 30},
        {"ambient": ()},
        {"ambient": (float("nan"),)},
        {"motor_heat_share": (1.2,)},
    ],
)
def test_senseless_settings_are_refused(tmp_path, wrong):
    with pytest.raises(OptionError):
        synthesize(tmp_path / "never", SynthesisSettings(**wrong))
    assert not (tmp_path / "never").exists()


def test_temperatures_out_of_reach_are_refused_and_nothing_is_left(tmp_path):
    for wrong, told in (
        ({"lowest": 25, "highest": 400}, "does not reach"),
        ({"lowest": 10, "highest": 28}, "before the thermal cycle"),
        ({"lowest": 25, "highest": 28, "ambient_drift": (60.0,)}, "does not cool"),
    ):
        with pytest.raises(OptionError, match=told):
            synthesize(tmp_path / "never", SynthesisSettings(runs=1, **wrong))
    assert list(tmp_path.iterdir()) == []


def test_fast_heating_still_ends_with_a_series_at_the_highest_temperature(tmp_path):
    fast = SynthesisSettings(runs=1, lowest=25, highest=26, motor_heat_share=(1.0,))
    synthesize(tmp_path / "fast", fast)
    phases = [row["phase"] for row in manifest(tmp_path / "fast")]
    assert phases == ["sweep"] * 11 + ["heat-up", "cool-down"]


def test_foreign_files_are_not_replaced(tmp_path):
    own = tmp_path / "mine"
    own.mkdir()
    (own / "notes.txt").write_text("keep", encoding="utf-8")
    with pytest.raises(OptionError, match=r"notes\.txt"):
        synthesize(own, SynthesisSettings(**SHORT))
    assert contents(own) == {"notes.txt": b"keep"}
    with pytest.raises(OptionError, match="is a file"):
        synthesize(own / "notes.txt", SynthesisSettings(**SHORT))


def test_former_synthesis_is_replaced_but_not_with_a_foreign_file_in_it(short, tmp_path):
    folder = tmp_path / "twice"
    folder.mkdir()  # an empty folder is free to use
    synthesize(folder, SynthesisSettings(seed=5, **SHORT))
    synthesize(folder, SynthesisSettings(seed=3, **SHORT))
    assert contents(folder) == contents(short[0])
    (folder / "day1" / "more.csv").write_text("1", encoding="utf-8")
    with pytest.raises(OptionError, match=r"more\.csv"):
        synthesize(folder, SynthesisSettings(seed=3, **SHORT))
