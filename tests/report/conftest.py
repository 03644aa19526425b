"""A plausible experiment, made of the friction function and a lag, as the stages would store it."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.model.friction import PUBLISHED, friction_torque, temperature_from_friction
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.report.results import JointResults, read_results
from tests.report.diagnosis_documents import write_diagnosis

CYCLE_SPEEDS = (19.1, 43.0, 67.5, 101.2)
SWEEP_SPEEDS = (2.3, 5.0, 10.0, 19.1, 30.0, 43.0, 67.5, 85.0, 101.2)
HEATING, COOLING = 6000.0, 18000.0


def thermal_state(time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motor, housing and friction-zone temperature after ``time`` of heating, then cooling."""
    motor = np.where(
        time < HEATING,
        25 + 40 * (1 - np.exp(-time / 2500)) / (1 - np.exp(-HEATING / 2500)),
        24 + 41 * np.exp(-(time - HEATING) / 5500),
    )
    housing = 23 + 0.6 * (motor - 25) * (1 - 0.4 * np.exp(-time / 3000))
    rising = np.where(time < HEATING, 1.0, -1.0)
    zone = motor - 3.0 * rising * np.minimum(1.0, time / 1500)
    return motor, housing, zone


@cache
def make_torques(
    runs: tuple[str, ...], joint: int, *, temperature: bool = True, scale: float = 1.0, step=600.0
) -> pd.DataFrame:
    generator = np.random.default_rng(7 + joint)
    rows = []
    for run in runs:
        moves = [(60.0 * i, speed, "sweep") for i, speed in enumerate(SWEEP_SPEEDS)]
        for start in np.arange(0.0, HEATING + COOLING, step):
            phase = "heat-up" if start < HEATING else "cool-down"
            moves += [(start + 900 + 30 * i, s, phase) for i, s in enumerate(CYCLE_SPEEDS)]
        for pair, (time, speed, phase) in enumerate(moves):
            motor, housing, zone = thermal_state(np.array([max(time - 900, 0.0)]))
            position = np.arange(15.0, 175.0, 10.0)
            load = 40.0 * np.cos(np.radians(position))
            friction = friction_torque(PUBLISHED, load=load, speed=speed, temperature=zone)
            friction = (friction + generator.normal(0, 0.6, position.size)) * scale
            rows.append(
                pd.DataFrame(
                    {
                        "run": run,
                        "joint": joint,
                        "pair": pair,
                        "speed": speed,
                        "time": time,
                        "phase": phase,
                        "motor_temperature": motor[0] if temperature else np.nan,
                        "housing_temperature": housing[0] if temperature else np.nan,
                        "position": position,
                        "torque_forward": load * scale + friction,
                        "torque_reverse": load * scale - friction,
                        "n_forward": 20,
                        "n_reverse": 20,
                        "friction_torque": friction,
                        "load_torque": load * scale,
                    }
                )
            )
    return pd.concat(rows, ignore_index=True)


def make_schedule(torques: pd.DataFrame, *, every: float) -> pd.DataFrame:
    """Correct at the first pair and then every ``every`` seconds of each phase."""
    pairs = torques[torques["phase"] != "sweep"].drop_duplicates(["run", "joint", "pair"])
    out = []
    for (_, _, _), rows in pairs.groupby(["run", "joint", "phase"]):
        correction, last = 0.0, -np.inf
        for row in rows.sort_values("time").itertuples():
            zone = thermal_state(np.array([row.time - 900]))[2][0]
            smooth = float(friction_torque(PUBLISHED, load=0.0, speed=row.speed, temperature=zone))
            corrected = row.time - last >= every and row.speed == 67.5
            if corrected:
                found = temperature_from_friction(
                    PUBLISHED, friction=smooth, load=0.0, speed=row.speed
                )
                correction, last = float(found) - row.motor_temperature, row.time
            parameter = row.motor_temperature + correction
            out.append(
                {
                    "run": row.run,
                    "joint": row.joint,
                    "pair": row.pair,
                    "speed": row.speed,
                    "time": row.time,
                    "phase": row.phase,
                    "criterion": "first_degree",
                    "k": 5.0,
                    "tmax": 3600.0,
                    "temperature_parameter": parameter,
                    "temperature_correction": correction,
                    "corrected": corrected,
                    "failed": corrected and len(out) % 7 == 3,
                    "friction_torque": smooth + 0.3 * np.sin(row.pair),
                    "friction_smoothed": smooth,
                    "friction_predicted": float(
                        friction_torque(PUBLISHED, load=0.0, speed=row.speed, temperature=parameter)
                    ),
                }
            )
    return pd.DataFrame(out)


def make_evaluation(runs: tuple[str, ...], joint: int) -> pd.DataFrame:
    rows = []
    for run in runs:
        for phase, base in (("heat-up", 4.0), ("cool-down", 5.0)):
            rows.append((run, joint, phase, "none", None, None, 0, 0, base, base + 0.2))
            for k, count in ((1.0, 25), (2.0, 14), (5.0, 6), (10.0, 3), (20.0, 2)):
                error = base / count
                key = (run, joint, phase)
                rows.append((*key, "first_degree", k, 3600.0, count, count // 10, error, error))
                rows.append((*key, "latest_degree", k, 3600.0, count + 1, 0, error * 1.1, error))
                rows.append((*key, "equal", k, 3600.0, count, 0, error * 1.3, error * 1.4))
            for bound, count in ((1.0, 14), (2.0, 6), (6.0, 0)):
                error = 0.9 * base / max(count, 1)
                key = (run, joint, phase, "uncertainty", None, None)
                rows.append((*key, count, 0, error, error, bound))
    names = list(schemas.EVALUATION.names)
    return pd.DataFrame([dict(zip(names, row, strict=False)) for row in rows], columns=names)


def make_model(joint: int, unit: str = "N·m", *, temperature: bool = True) -> dict[str, object]:
    per = f"{unit}/(deg/s)^0.5"
    if temperature:
        viscous = (3.48, 15.66, 0.056)
        reason = None
    else:
        viscous = (6.5, 0.0, 0.0)
        reason = "the log has no temperature; merged into beta"

    def stated(estimate: float, unit: str, reason: str | None = None) -> dict[str, object]:
        ci95 = None if reason else [estimate * 0.95, estimate * 1.05]
        return {
            "estimate": estimate,
            "ci95": ci95,
            "unit": unit,
            "determined": reason is None,
            "reason": reason,
        }

    return {
        "form": "tau = tau_c + alpha*L^2 + (beta + gamma*exp(-delta*T))*sqrt(v)",
        "joint": joint,
        "method": "joint",
        "temperature": "motor",
        "torque_unit": unit,
        "torque_side": "joint",
        "sign": 1,
        "speed_unit": "deg/s",
        "parameters": {
            "tau_c": stated(10.57, unit),
            "alpha": stated(0.0014, f"1/({unit})"),
            "beta": stated(viscous[0], per),
            "gamma": stated(viscous[1], per, reason),
            "delta": stated(viscous[2], "1/°C", reason),
        },
        "rmse": 1.13,
        "n_pairs": 298,
        "noise": {"point": 0.61, "pair": 0.2, "drift": 0.4, "drift_time": 1800.0},
        "range": {
            "speed": [2.3, 101.2],
            "load": [-39.8, 38.6],
            "temperature": [25.0, 65.0] if temperature else None,
        },
        "notes": ["the fit uses 298 pairs"],
        "provenance": Provenance(
            "fit", {"method": "joint"}, {"torques.parquet": "ab" * 32}
        ).as_dict(),
    }


def write_work(
    work: Path,
    *,
    runs: tuple[str, ...] = ("day-1", "day-2"),
    joints: tuple[int, ...] = (2,),
    unit: str = "N·m",
    temperature: bool = True,
    schedule: bool = True,
) -> Path:
    """Fill a work folder as the stages before the report would."""
    facts = {"torque_unit": unit, "torque_side": "joint", "notes": ["sign +1 found"]}
    torques = pd.concat(
        [make_torques(runs, joint, temperature=temperature) for joint in joints],
        ignore_index=True,
    )
    pairs = torques.drop(columns=["friction_torque", "load_torque"])
    paired = Provenance("pair", {"bin_width": 10.0}, {"samples.parquet": "ef" * 32})
    dropped = {"no partner": 40, "not at constant speed": 1234}
    tables.write(
        work / "pairs.parquet",
        pairs,
        schemas.PAIRS,
        paired,
        facts | {"dropped": dropped, "samples": 200_000},
    )
    separated = Provenance("separate", {"sign": "auto"}, input_hashes([work / "pairs.parquet"]))
    tables.write(work / "torques.parquet", torques, schemas.TORQUES, separated, facts)
    if schedule and temperature:
        made = pd.concat(
            [make_schedule(torques[torques["joint"] == joint], every=3600.0) for joint in joints]
        )
        simulated = Provenance("simulate", {"k": 5.0, "tmax": 60.0})
        tables.write(work / "schedule.parquet", made, schemas.SCHEDULE, simulated, facts)
        evaluation = pd.concat([make_evaluation(runs, joint) for joint in joints])
        evaluated = Provenance("evaluate")
        tables.write(work / "evaluation.parquet", evaluation, schemas.EVALUATION, evaluated, facts)
    recordings = pd.DataFrame(
        {
            "run": [run for run in runs for _ in range(3)],
            "recording": [f"move-{i}" for _ in runs for i in range(3)],
            "joint": joints[0],
            "file": [f"logs/{run}/move-{i}.csv" for run in runs for i in range(3)],
            "start": 0.0,
            "rows_read": 1000,
            "rows_kept": 998,
            "rows_rejected": 2,
            "period": 0.012,
            "notes": "velocity is in deg/s\ntime has no gaps",
        }
    )
    ingested = Provenance("ingest", {"logs": list(runs)}, {"move-0.csv": "12" * 32})
    tables.write(work / "recordings.parquet", recordings, schemas.RECORDINGS, ingested, facts)
    rejected = pd.DataFrame(
        {
            "run": runs[0],
            "recording": "move-0",
            "row": [17, 18, 900],
            "reason": ["not a number", "not a number", "too few columns"],
            "text": ["1;x", "1;y", "1"],
        }
    )
    tables.write(work / "rejected.parquet", rejected, schemas.REJECTED, ingested)
    models = {str(joint): make_model(joint, unit, temperature=temperature) for joint in joints}
    fitted = Provenance("fit", {"method": "joint"}, input_hashes([work / "torques.parquet"]))
    document = models[str(joints[0])] | {"provenance": fitted.as_dict()}
    if len(joints) > 1:
        document["joints"] = models
    (work / "model.json").write_text(json.dumps(document), encoding="utf-8")
    return work


@pytest.fixture(name="write_work", scope="session")
def write_work_fixture() -> Callable[..., Path]:
    return write_work


@pytest.fixture(scope="session")
def two_runs(tmp_path_factory: pytest.TempPathFactory) -> JointResults:
    work = write_work(tmp_path_factory.mktemp("two_runs"))
    return read_results(work).joints[0]


@pytest.fixture(scope="session")
def current_log(tmp_path_factory: pytest.TempPathFactory) -> JointResults:
    """One run whose torque is a motor current."""
    work = write_work(tmp_path_factory.mktemp("current"), runs=("day-1",), unit="A")
    return read_results(work).joints[0]


@pytest.fixture(scope="session")
def without_temperature(tmp_path_factory: pytest.TempPathFactory) -> JointResults:
    work = write_work(tmp_path_factory.mktemp("cold"), runs=("day-1",), temperature=False)
    return read_results(work).joints[0]


@pytest.fixture(scope="session")
def diagnosed_work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A work folder with a diagnosis and an extended model; tests must not change it."""
    return write_diagnosis(write_work(tmp_path_factory.mktemp("diagnosed"), schedule=False))


@pytest.fixture(scope="session")
def diagnosed(diagnosed_work: Path) -> JointResults:
    return read_results(diagnosed_work).joints[0]


@pytest.fixture(scope="session")
def diagnosis(diagnosed: JointResults) -> Reloaded:
    assert diagnosed.diagnosis is not None
    return diagnosed.diagnosis


@pytest.fixture
def without_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave the figures out, whose drawing takes most of a report's time."""
    monkeypatch.setattr("frictioncli.report.drawing.FIGURES", ())
