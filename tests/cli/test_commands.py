"""The command line end to end, and what it says when the input is at fault."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.cli.commands import app
from frictioncli.stages.settings import RunSettings
from tests.command_line import called, invoke
from tests.equation_16 import friction, write_recording
from tests.moves import move_sequence

COMMANDS = (
    "inspect",
    "ingest",
    "pair",
    "separate",
    "fit",
    "simulate",
    "evaluate",
    "diagnose",
    "report",
    "run",
    "plan",
    "export",
    "compare",
    "fleet",
    "synthesize",
    "challenge",
)


def write_log(
    path, *, turns=(0, 170, 0, 170, 0, 170, 0), speeds=(20, 20, 50, 50, 90, 90), **columns
):
    """Write a KUKA-style trace whose friction is 5 + 2 sqrt(v) N·m."""
    motion = move_sequence(list(turns), list(speeds))
    direction = np.sign(motion["velocity"])
    truth = {"tau_c": 5.0, "alpha": 0.0, "beta": 2.0, "gamma": 0.0, "delta": 0.0}
    speed = motion["velocity"].abs()
    opposing = friction(truth, load=0.0, speed=speed, temperature=40.0)
    gravity = 80 * np.cos(np.radians(motion["position"]))
    torque = gravity + direction * opposing + 5 * np.radians(motion["acceleration"])
    return write_recording(path, motion, torque, **columns)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A finished run over one short log without temperature."""
    folder = tmp_path_factory.mktemp("finished")
    write_log(folder / "logs" / "trace.csv")
    result = called("run", folder / "logs", "-w", folder / "work")
    assert result.returncode == 0, result.stderr
    return folder, result.stdout


def test_run_recovers_the_joint_that_made_the_log(finished):
    folder, _ = finished
    model = json.loads((folder / "work" / "model.json").read_text(encoding="utf-8"))
    assert model["parameters"]["tau_c"]["estimate"] == pytest.approx(5.0, abs=0.2)
    assert model["parameters"]["beta"]["estimate"] == pytest.approx(2.0, abs=0.03)
    assert model["sign"] == 1
    assert not model["parameters"]["delta"]["determined"]


def test_run_says_one_line_per_stage_and_what_it_left_out(finished):
    _, output = finished
    stages = ("ingest", "pair", "separate", "fit", "diagnose", "simulate", "evaluate", "report")
    told = [line for line in output.splitlines() if line.startswith(stages)]
    assert [line.split()[0] for line in told] == list(stages)
    for stage in ("diagnose", "simulate", "evaluate"):
        assert told[stages.index(stage)].split()[1:3] == ["left", "out:"]


def test_every_output_says_where_it_comes_from(finished):
    folder, _ = finished
    work = folder / "work"
    for name in ("samples", "rejected", "recordings", "pairs", "torques"):
        document = tables.metadata(work / f"{name}.parquet")
        assert document["program"] == "frictioncli"
        assert {"version", "stage", "settings", "inputs"} <= set(document)
    model = json.loads((work / "model.json").read_text(encoding="utf-8"))
    assert set(model["provenance"]["inputs"]) == {"torques.parquet"}


def test_tables_carry_units_and_the_columns_of_the_contract(finished):
    folder, _ = finished
    torques = tables.read(folder / "work" / "torques.parquet", schemas.TORQUES)
    assert {"friction_torque", "load_torque", "position", "n_forward"} <= set(torques.columns)
    batch = next(tables.batches(folder / "work" / "torques.parquet", schemas.TORQUES))
    units = {field.name: field.metadata[b"unit"].decode() for field in batch.schema}
    assert units["friction_torque"] == "N·m"
    assert units["speed"] == "deg/s"
    assert units["motor_temperature"] == "°C"


def test_each_stage_works_alone(finished):
    folder, _ = finished
    for stage in ("pair", "separate", "fit", "report"):
        result = called(stage, "-w", folder / "work")
        assert (result.returncode, result.stderr) == (0, "")


def test_options_are_in_the_provenance_of_what_is_written(tmp_path):
    write_log(tmp_path / "logs" / "trace.csv")
    work = tmp_path / "work"
    invoke("ingest", tmp_path / "logs", "-w", work, "--joint", 2, "--torque-unit", "Nm")
    invoke("pair", "--work", work, "--bin-width", 10, "--min-samples", 7)
    invoke("separate", "-w", work, "--sign", "+1")
    invoke("fit", "-w", work, "--temperature", "motor")
    samples = tables.metadata(work / "samples.parquet")["settings"]
    assert (samples["joints"], samples["units"]) == ([2], {"torque": "N·m"})
    pairs = tables.metadata(work / "pairs.parquet")["settings"]
    assert (pairs["bin_width"], pairs["steady"]["min_samples"]) == (10.0, 7)
    assert tables.metadata(work / "torques.parquet")["settings"] == {
        "by": "auto",
        "urdf": None,
        "sign": 1,
    }
    model = json.loads((work / "model.json").read_text(encoding="utf-8"))
    assert model["provenance"]["settings"]["temperature"] == "motor"


def test_a_second_run_gives_the_same_bytes(finished, tmp_path):
    folder, _ = finished
    (tmp_path / "again").mkdir()
    former = [tmp_path / "again" / name for name in ("diagnosis.json", "extended-model.json")]
    for path in former:
        path.write_text("of other data", encoding="utf-8")
    assert called("run", folder / "logs", "-w", tmp_path / "again").returncode == 0
    assert not any(path.exists() for path in former)
    for path in sorted((tmp_path / "again").rglob("*")):
        if path.is_file():
            first = folder / "work" / path.relative_to(tmp_path / "again")
            assert first.read_bytes() == path.read_bytes(), path.name


def test_simulate_without_temperature_says_why(finished):
    folder, _ = finished
    result = called("simulate", "-w", folder / "work", "--k", 5, "--tmax", 60)
    assert result.returncode == 2
    assert "has no dependence of friction on temperature" in result.stderr
    assert not (folder / "work" / "schedule.parquet").exists()


def columns_without(name):
    def spoil(path):
        frame = pd.read_csv(path, sep=";", encoding="cp1252")
        frame.drop(columns=name).to_csv(path, sep=";", index=False, encoding="cp1252")

    return spoil


def empty(path):
    path.write_bytes(b"")


def text_for_numbers(path):
    frame = pd.read_csv(path, sep=";", encoding="cp1252", dtype=str)
    frame["GearTorq_Act2[Nm]"] = "offline"
    frame.to_csv(path, sep=";", index=False, encoding="cp1252")


def not_a_number(path):
    frame = pd.read_csv(path, sep=";", encoding="cp1252")
    frame["GearTorq_Act2[Nm]"] = np.nan
    frame.to_csv(path, sep=";", index=False, encoding="cp1252", na_rep="NaN")


def backwards(path):
    frame = pd.read_csv(path, sep=";", encoding="cp1252")
    frame["Zeit[sec]"] = frame["Zeit[sec]"].to_numpy()[::-1]
    frame.to_csv(path, sep=";", index=False, encoding="cp1252")


def one_direction(path):
    write_log(path, turns=(0, 170), speeds=(20,))


def no_constant_speed(path):
    write_log(path, turns=(0, 50, 0, 50, 0), speeds=(900, 900, 900, 900))


def wrong_delimiter(path):
    path.write_bytes(path.read_bytes().replace(b";", b"|"))


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (columns_without("GearTorq_Act2[Nm]"), "torque"),
        (columns_without("AxisPos_Act2[°]"), "position"),
        (columns_without("Zeit[sec]"), "time"),
        (empty, "empty"),
        (text_for_numbers, "offline"),
        (not_a_number, "GearTorq_Act2"),
        (backwards, "time"),
        (one_direction, "no pair of counter-directed moves"),
        (no_constant_speed, "no constant-velocity motion"),
        (wrong_delimiter, "|"),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_bad_input_gives_one_message_and_nothing_half_written(tmp_path, spoil, told):
    path = write_log(tmp_path / "logs" / "trace.csv")
    spoil(path)
    result = called("run", tmp_path / "logs", "-w", tmp_path / "work")
    assert result.returncode == 2
    assert told in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stderr.count("\n") == 1
    left = {item.name for item in (tmp_path / "work").glob("*")}
    assert left <= {"samples.parquet", "recordings.parquet", "rejected.parquet"}


def test_inspect_shows_units_and_writes_nothing(tmp_path):
    write_log(tmp_path / "logs" / "trace.csv", **{"Motortemperatur2[K]": 313})
    result = called("inspect", "logs", cwd=tmp_path)
    assert result.returncode == 0
    assert "AxisPos_Act2[°]: 0 to 170 deg" in result.stdout
    assert "read as deg: as the header says" in result.stdout
    assert "read as K: as the header says" in result.stdout
    assert "3 pairs: 1 at 20, 1 at 50, 1 at 90 deg/s" in result.stdout
    assert [item.name for item in tmp_path.iterdir()] == ["logs"]


def test_inspect_as_json_and_as_a_mapping_file(tmp_path):
    path = write_log(tmp_path / "logs" / "trace.csv")
    found = json.loads(called("inspect", "logs", "--json", cwd=tmp_path).stdout)
    assert found["files"][0]["rows_kept"] == path.read_bytes().count(b"\n") - 1
    suggested = called("inspect", "logs", "--suggest-map", cwd=tmp_path)
    (tmp_path / "channels.toml").write_text(suggested.stdout, encoding="utf-8")
    again = called("inspect", "logs", "--json", "--map", "channels.toml", cwd=tmp_path)
    assert json.loads(again.stdout)["joints"][0]["pairs"] == found["joints"][0]["pairs"] == 3
    both = called("inspect", "logs", "--json", "--suggest-map", cwd=tmp_path)
    assert (both.returncode, both.stderr.count("\n")) == (2, 1)


def test_inspect_of_unusable_files_is_done_all_the_same(tmp_path):
    (tmp_path / "empty.csv").write_text("")
    result = called("inspect", tmp_path)
    assert result.returncode == 0
    assert "not usable: empty file" in result.stdout


def test_a_missing_folder_is_named(tmp_path):
    result = called("run", tmp_path / "nowhere", "-w", tmp_path / "work")
    assert result.returncode == 2
    assert "nowhere" in result.stderr


def test_a_stage_without_its_input_names_the_missing_table(tmp_path):
    result = called("fit", "-w", tmp_path)
    assert result.returncode == 2
    assert "torques.parquet" in result.stderr


@pytest.mark.parametrize("name", ["pairs.parquet", "samples.parquet"])
def test_a_damaged_table_is_named(tmp_path, name):
    (tmp_path / name).write_bytes(b"PAR1 and then nothing")
    stage = {"pairs.parquet": "separate", "samples.parquet": "pair"}[name]
    result = called(stage, "-w", tmp_path)
    assert result.returncode == 2
    assert name in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("separate", "--sign", "up"), "expected auto, +1 or -1"),
        (("evaluate", "--k", "two"), "expected numbers"),
        (("simulate", "--criterion", "often"), "first_degree"),
        (("fit", "--method", "magic"), "joint, paper"),
        (("pair", "--bin-width", "0"), "bin width"),
        (("simulate", "--tmax", "soon"), "--tmax"),
        (("simulate", "--criterion", "uncertainty", "--bound", "0"), "--bound: found 0"),
        (("evaluate", "--bound", "1,x"), "expected numbers"),
    ],
)
def test_bad_options_name_what_is_allowed(tmp_path, arguments, told):
    result = called(*arguments, "-w", tmp_path)
    assert result.returncode == 2
    assert told in result.stderr
    assert "Traceback" not in result.stderr


def test_help_names_units():
    for command in COMMANDS:
        text = called(command, "--help").stdout
        assert any(unit in text for unit in ("deg", "N·m", "°C", "min")), command


def test_commands_are_those_listed_here():
    assert {command.callback.__name__ for command in app.registered_commands} == set(COMMANDS)


def test_option_defaults_are_the_settings_defaults():
    """What ``run --help`` shows as default is what the library does."""
    settings = RunSettings()
    text = " ".join(called("run", "--help").stdout.split())
    steady, pairing = settings.pairing.steady, settings.pairing
    for option, value in {
        "bin-width": pairing.bin_width,
        "settling": steady.settling,
        "min-speed": steady.min_speed,
        "same-speed": pairing.same_speed,
        "k": settings.schedule.k,
        "tmax": settings.schedule.tmax / 60,
        "bound": settings.schedule.bound,
        "method": settings.fit.method,
        "criterion": settings.schedule.criterion,
    }.items():
        described = text.split(f"--{option} ")[1]
        assert described.split("default: ")[1].startswith(f"{value}]"), option


def test_version_is_told():
    assert called("--version").stdout.startswith("frictioncli 0.")


def test_synthesize_makes_what_run_reads(tmp_path):
    made = called(
        "synthesize",
        tmp_path / "made",
        *("--seed", 4, "--runs", 1, "--thin", 8),
        *("--lowest", 40, "--highest", 44),
    )
    assert made.returncode == 0, made.stderr
    assert (tmp_path / "made" / "truth.json").exists()
    result = called("run", tmp_path / "made", "-w", tmp_path / "work")
    assert result.returncode == 0, result.stderr
    for name in ("diagnosis.json", "extended-model.json", "schedule.parquet"):
        assert (tmp_path / "work" / name).exists()
    assert Path(result.stdout.split()[-1]).exists()
    assert "heat-up" in result.stdout
    assert "cool-down" in result.stdout
