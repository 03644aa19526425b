"""Planted effects in traces: what the folder tells, and that the tables agree with the traces."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from frictioncli.errors import OptionError
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.synthesize import synthesize
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from frictioncli.workfiles import TORQUES
from tests.simulation.torque_table import simulate_torques

SHORT = {"runs": 1, "seed": 3, "lowest": 25, "highest": 28}


def synthesis(folder: Path, **changes: object):
    return synthesize(folder, SynthesisSettings(**{**SHORT, **changes}))


def torques(folder: Path, work: Path) -> pd.DataFrame:
    ingest([folder], work)
    pair(work)
    separate(work)
    return pd.read_parquet(work / TORQUES)


def test_truth_tells_each_effect(tmp_path):
    summary = synthesis(tmp_path / "logs", effects=("drift:1.5", "stribeck"))
    truth = json.loads((tmp_path / "logs" / "truth.json").read_text(encoding="utf-8"))
    drift, stribeck = truth["effects"]
    assert drift["name"] == "drift"
    assert drift["rms"] == pytest.approx(1.5, rel=0.001)
    assert set(drift["parameters"]) == {"magnitude", "time_constant", "way"}
    assert "ln(1 + t / tau)" in drift["equation"]
    assert stribeck["listed"]
    assert truth["settings"]["effects"] == ["drift:1.5", "stribeck"]
    assert "drift, 1.50 N·m" in str(summary)


def test_without_effects_the_truth_is_as_before(tmp_path):
    synthesis(tmp_path / "logs")
    truth = json.loads((tmp_path / "logs" / "truth.json").read_text(encoding="utf-8"))
    assert "effects" not in truth
    assert set(truth["settings"]) & {"effects", "blind", "joint_kind", "protocol", "thin"} == set()


def test_blind_folder_tells_nothing(tmp_path):
    effects = ("run_in:2",)
    summary = synthesis(tmp_path / "logs", effects=effects, blind=True)
    synthesis(tmp_path / "clean")
    inside = {p.relative_to(tmp_path / "logs").as_posix() for p in (tmp_path / "logs").rglob("*")}
    clean = {p.relative_to(tmp_path / "clean").as_posix() for p in (tmp_path / "clean").rglob("*")}
    assert inside == clean - {"truth.json"}
    texts = [p.read_bytes() for p in (tmp_path / "logs").rglob("*.csv")]
    assert not any(b"run_in" in text or b"effect" in text for text in texts)
    for word in ("run_in", "hidden", "heat enters", "truth"):
        assert word not in str(summary)
    truth = json.loads((tmp_path / "logs-truth.json").read_text(encoding="utf-8"))
    assert truth["effects"][0]["name"] == "run_in"
    # A blind synthesis can be made again in the same place.
    synthesis(tmp_path / "logs", effects=effects, blind=True)


def test_foreign_truth_beside_is_not_replaced(tmp_path):
    (tmp_path / "logs-truth.json").write_text("{}", encoding="utf-8")
    with pytest.raises(OptionError, match="no truth of a former synthesis"):
        synthesis(tmp_path / "logs", blind=True)
    assert not (tmp_path / "logs").exists()


def test_effects_leave_time_position_and_temperature_alone(tmp_path):
    synthesis(tmp_path / "with", effects=("torque_constant:2",))
    synthesis(tmp_path / "without")
    name = "day1/012_heat-up_KRCIpo.csv"
    one, other = (
        np.loadtxt(tmp_path / folder / name, delimiter=";", skiprows=1, encoding="cp1252")
        for folder in ("with", "without")
    )
    assert np.array_equal(one[:, [0, 1, 3, 4]], other[:, [0, 1, 3, 4]])
    assert np.abs(one[:, 2] - other[:, 2]).max() > 0.01


@pytest.mark.parametrize(
    "changes",
    [
        {"joint_kind": "plain", "effects": ("position_ripple:1", "dress_pack:1")},
        {"sign": -1, "effects": ("direction_asymmetry:1", "rest_recovery:1")},
    ],
)
def test_tables_agree_with_traces(tmp_path, changes):
    synthesis(tmp_path / "logs", noise_scale=0.0, **changes)
    traced = torques(tmp_path / "logs", tmp_path / "work")
    table = simulate_torques(SynthesisSettings(**SHORT, noise_scale=0.0, **changes))
    both = traced.merge(table, on=["pair", "position"], suffixes=("", "_table"))
    assert len(both) >= 0.98 * max(len(traced), len(table))
    for name, most in (
        ("speed", 0.05),
        ("time", 0.3),
        ("torque_forward", 0.2),
        ("torque_reverse", 0.2),
        ("friction_torque", 0.1),
        ("load_torque", 0.2),
        ("housing_temperature", 0.1),
    ):
        away = both[f"{name}_table"] - both[name]
        if name == "time":  # the fast thermal history may wait some seconds less
            away -= away.mean()
            most = 15.0
        assert float(np.sqrt(np.mean(away**2))) < most, name
    assert (both["phase"].astype(str) == both["phase_table"].astype(str)).all()


@pytest.mark.parametrize("protocol", ["paper", "enriched"])
def test_payloads_of_tables_are_those_of_traces(tmp_path, protocol):
    changes = {"protocol": protocol, "payload": 1.5, "joint_kind": "plain", "noise_scale": 0.0}
    synthesis(tmp_path / "logs", **changes)
    traced = torques(tmp_path / "logs", tmp_path / "work")
    table = simulate_torques(SynthesisSettings(**SHORT, **changes))
    both = traced.merge(table, on=["pair", "position"], suffixes=("", "_table"))
    assert len(both) >= 0.98 * max(len(traced), len(table))
    assert set(both["payload"]) == ({1.5} if protocol == "paper" else {1.5, 3.5, 5.5})
    assert (both["payload"] == both["payload_table"]).all()
    # bins at the ends, passed in part, are carried to their centre both ways
    slow = both[both["speed"] < 150]
    away = (slow["load_torque"] - slow["load_torque_table"]).groupby(slow["speed"])
    assert away.std().max() < 0.1


def test_noise_of_tables_is_that_of_traces(tmp_path):
    synthesis(tmp_path / "logs")
    traced = torques(tmp_path / "logs", tmp_path / "work")
    settings = SynthesisSettings(**SHORT)
    quiet = simulate_torques(SynthesisSettings(**SHORT, noise_scale=0.0))
    spreads = []
    for table in (traced, simulate_torques(settings)):
        both = table.merge(quiet, on=["pair", "position"], suffixes=("", "_quiet"))
        spreads.append(float(np.std(both["load_torque"] - both["load_torque_quiet"])))
    assert spreads[0] == pytest.approx(spreads[1], rel=0.2)


def test_enriched_manifest_tells_payloads(tmp_path):
    synthesis(tmp_path / "logs", protocol="enriched", payload=1.0, thin=10)
    with (tmp_path / "logs" / "day1" / "manifest.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream, delimiter=";"))
    assert {row["payload"] for row in rows} == {"1", "3", "5"}
    trace = np.loadtxt(
        tmp_path / "logs" / "day1" / rows[0]["file"], delimiter=";", skiprows=1, encoding="cp1252"
    )
    assert np.diff(trace[:, 0]) == pytest.approx(0.12)
    truth = json.loads((tmp_path / "logs" / "truth.json").read_text(encoding="utf-8"))
    assert len(truth["runs"][0]["payloads"]) == len(rows)


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    program = "from frictioncli.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", program, "synthesize", *map(str, arguments)],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


def test_command_line_plants_and_refuses(tmp_path):
    folder = tmp_path / "logs"
    short = ("--runs", 1, "--highest", 27, "--thin", 5)
    kinds = ("--joint-kind", "plain", "--noise-kind", "pair", "--protocol", "paper")
    done = command(folder, *short, *kinds, "--effect", "drift:1", "--effect", "run_in", "--blind")
    assert done.returncode == 0, done.stderr
    assert "drift" not in done.stdout
    truth = json.loads((tmp_path / "logs-truth.json").read_text(encoding="utf-8"))
    assert [one["name"] for one in truth["effects"]] == ["drift", "run_in"]
    assert truth["settings"]["noise_kind"] == "pair"
    wrong = command(tmp_path / "never", "--effect", "gremlins")
    assert wrong.returncode == 2
    assert "reversal_transient" in wrong.stderr
    assert len(wrong.stderr.splitlines()) == 1
    assert not (tmp_path / "never").exists()
