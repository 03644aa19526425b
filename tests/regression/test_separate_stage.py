"""The second way to the table of torques in the chain: chosen, told, and said."""

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import NotEnoughData, OptionError, TableError
from frictioncli.model.document import read_models
from frictioncli.pairs.settings import SeparationSettings
from frictioncli.provenance import Provenance
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.synthesize import synthesize
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.run import run
from frictioncli.stages.separate import separate
from tests.command_line import invoke
from tests.equation_16 import write_recording
from tests.moves import move_sequence
from tests.moves import samples as moved_samples
from tests.regression import programmes

REGRESSION = SeparationSettings(by="regression")
TORQUES = "torques.parquet"


def write_samples(work, table, unit="N·m"):
    work.mkdir()
    facts = {"torque_unit": unit}
    tables.write(work / "samples.parquet", table, schemas.SAMPLES, Provenance("ingest"), facts)


def write_log(path, motion, torque):
    """Write a log of positions and torques, without velocities."""
    write_recording(path, pd.DataFrame({"time": motion[0], "position": motion[1]}), torque)


@pytest.fixture(scope="module")
def swung(tmp_path_factory):
    """A log of sines, its work folder after a run, and what the run said of each stage."""
    folder = tmp_path_factory.mktemp("swung")
    generator = np.random.default_rng(21)
    motion = programmes.sines(240, generator)
    torque = programmes.torque(motion) + programmes.autoregressive(
        generator, len(motion[0]), 0.4, 0.5
    )
    write_log(folder / "day1" / "swing.csv", motion, torque)
    said = {}
    run(
        [folder / "day1"],
        folder / "work",
        progress=lambda name, result: said.update({name: result}),
    )
    return folder / "work", {name: str(result) for name, result in said.items()}


def test_a_log_without_pairs_goes_through_the_whole_chain(swung):
    work, said = swung
    assert said["pair"].startswith("left out: no ")
    assert "by regression of" in said["separate"]
    assert not (work / "pairs.parquet").exists()
    assert (work / "report" / "index.html").exists()
    (model,) = read_models(work / "model.json")
    known = tables.facts(work / TORQUES)["regression"]["2"]["parameters"]
    for name, value in (("tau_c", 8.0), ("alpha", 0.002), ("beta", 2.0)):
        low, high = model.parameters[name].ci95
        assert low - (high - low) / 2 <= value <= high + (high - low) / 2, name
        # what errs in all torques alike is in the interval
        assert high - low > known[name]["ci95"][1] - known[name]["ci95"][0], name


def test_the_table_says_where_its_rows_come_from(swung):
    work, _ = swung
    facts = tables.facts(work / TORQUES)
    assert facts["separated_by"] == {"2": "regression"}
    found = facts["regression"]["2"]
    inertia = found["parameters"]["inertia"]
    assert inertia["unit"] == "kg·m²"
    assert inertia["ci95"][0] < programmes.INERTIA * 1.01
    assert inertia["ci95"][1] > programmes.INERTIA * 0.99
    assert found["held_out"] >= found["rmse"] > 0
    assert set(tables.metadata(work / TORQUES)["inputs"]) == {
        "samples.parquet",
        "recordings.parquet",
    }
    used = tables.read(work / TORQUES, schemas.TORQUES)[["n_forward", "n_reverse"]].sum().sum()
    assert used + sum(facts["dropped"].values()) == facts["samples"]


def test_the_report_counts_the_samples_of_a_regression(swung):
    page = (swung[0] / "report" / "index.html").read_text(encoding="utf-8")
    assert "of the samples went into" in page


def test_pairs_that_suffice_are_used_and_said(tmp_path):
    motion = move_sequence([0, 100] * 3 + [0], [20.0, 20.0, 50.0, 50.0, 90.0, 90.0])
    friction = 5 + 2 * np.sqrt(motion["velocity"].abs())
    write_samples(tmp_path / "work", moved_samples(motion, friction, load=lambda q: 0 * q))
    pair(tmp_path / "work")
    text = str(separate(tmp_path / "work"))
    assert text.startswith("joint 2: forward torque is load + friction")
    assert tables.facts(tmp_path / "work" / TORQUES)["separated_by"] == {"2": "pairs"}


@pytest.mark.parametrize(
    ("count", "seconds", "said"),
    [
        (1, 120, "too few pairs (1 pair of joint 1): by regression"),
        (4, 300, "4 pairs of joint 1 hold 5 % of its motion: by regression"),
        (4, 20, ""),
    ],
)
def test_pairs_that_hold_little_of_the_motion_give_way_to_a_regression(
    count, seconds, said, tmp_path
):
    """Pairs at growing speeds, then sines."""
    speeds = np.repeat(20.0 * np.arange(1, count + 1), 2)
    pairs = move_sequence([0, 100] * count + [0], speeds, period=0.01)
    swing = programmes.sines(seconds, np.random.default_rng(22), centre=0.0)
    after = pairs["time"].iloc[-1] + 5.0
    table = programmes.samples(
        tuple(
            np.concatenate([pairs[name], channel + (after if name == "time" else 0.0)])
            for name, channel in zip(
                ("time", "position", "velocity", "acceleration"), swing, strict=True
            )
        ),
        np.concatenate(
            [
                programmes.torque(tuple(pairs[name] for name in pairs)),
                programmes.torque(swing),
            ]
        ),
    )
    work = tmp_path / "work"
    write_samples(work, table)
    pair(work)
    text = str(separate(work))
    assert said in text
    way = "regression" if said else "pairs"
    assert tables.facts(work / TORQUES)["separated_by"] == {"1": way}
    # as told, pairs are used nonetheless
    separate(work, SeparationSettings(by="pairs"))
    assert tables.facts(work / TORQUES)["separated_by"] == {"1": "pairs"}


def test_pairs_that_are_told_and_missing_are_named(tmp_path):
    write_samples(tmp_path / "work", programmes.noisy_log(1, duration=20))
    with pytest.raises(TableError, match=r"pairs\.parquet is missing"):
        separate(tmp_path / "work", SeparationSettings(by="pairs"))


def write_speeds(path, motion, torque):
    """Write the log of a motor on a bench, without positions."""
    path.parent.mkdir(parents=True)
    columns = {"time [s]": motion[0], "velocity [deg/s]": motion[2], "torque [Nm]": torque}
    pd.DataFrame(columns).to_csv(path, index=False, float_format="%.7g")


@pytest.mark.long
@pytest.mark.parametrize("offset", [0.0, 1.5])
def test_a_log_without_positions_is_regressed_by_its_velocity(offset, tmp_path):
    """Sines of a motor on a bench: no gravity, but inertia, friction and an offset."""
    generator = np.random.default_rng(31)
    motion = programmes.sines(240, generator)
    torque = programmes.torque(motion, gravity=(0.0, 0.0), offset=offset, alpha=0.0)
    torque += programmes.autoregressive(generator, len(torque), 0.3, 0.5)
    write_speeds(tmp_path / "day1" / "bench.csv", motion, torque)
    work = tmp_path / "work"
    run([tmp_path / "day1"], work)
    facts = tables.facts(work / TORQUES)
    assert facts["position"] == "integrated"
    assert facts["separated_by"] == {"1": "regression"}
    found = facts["regression"]["1"]
    assert "no angle" in found["undetermined"]["gravity"]
    for name, true in (("inertia", programmes.INERTIA), ("offset", offset)):
        low, high = found["parameters"][name]["ci95"]
        assert low - 0.02 * programmes.INERTIA < true < high + 0.02 * programmes.INERTIA
    (model,) = read_models(work / "model.json")
    assert model.parameters["tau_c"].estimate == pytest.approx(8.0, rel=0.05)
    assert model.parameters["beta"].estimate == pytest.approx(2.0, rel=0.05)
    rows = tables.read(work / TORQUES, schemas.TORQUES)
    assert len(set(rows["position"])) == 1
    np.testing.assert_allclose(rows["load_torque"], offset, atol=0.3)


def test_a_refusal_names_both_ways(tmp_path):
    motion = programmes.sines(3, np.random.default_rng(23))
    write_log(tmp_path / "day1" / "short.csv", motion, programmes.torque(motion))
    with pytest.raises(NotEnoughData, match=r"no .*; by regression neither: joint 2: "):
        run([tmp_path / "day1"], tmp_path / "work")
    assert not (tmp_path / "work" / TORQUES).exists()


def test_the_option_is_on_the_command_line(tmp_path):
    write_samples(tmp_path / "work", programmes.noisy_log(24))
    done = invoke("separate", "-w", tmp_path / "work", "--by", "regression")
    assert done.exit_code == 0
    assert "joint 1: by regression of" in done.stdout
    with pytest.raises(OptionError, match="--by magic: expected auto, pairs, regression"):
        invoke("separate", "-w", tmp_path / "work", "--by", "magic")


def test_a_joint_that_moves_with_others_is_regressed_only_when_told(tmp_path):
    table = programmes.noisy_log(25)
    moving = table.append_column("other_speed", [np.full(len(table), 12.0)])
    work = tmp_path / "work"
    write_samples(work, moving)
    with pytest.raises(NotEnoughData, match="other joint moves in 100 % of its motion"):
        separate(work)
    assert "friction includes what they add" in str(separate(work, REGRESSION))


def test_one_direction_is_regressed_only_when_told(tmp_path):
    generator = np.random.default_rng(26)
    time = np.arange(0, 60, 0.01)
    rate = 2 * np.pi * 0.1
    motion = (
        time,
        50 * time + 30 / rate * np.sin(rate * time),
        50 + 30 * np.cos(rate * time),
        -30 * rate * np.sin(rate * time),
    )
    torque = programmes.torque(motion) + generator.normal(0, 0.3, len(time))
    work = tmp_path / "work"
    write_samples(work, programmes.samples(motion, torque))
    with pytest.raises(NotEnoughData, match="motion in one direction only"):
        separate(work)
    assert "not determined: offset: motion in one direction only" in str(separate(work, REGRESSION))


def test_a_log_without_angles_has_no_gravity(tmp_path):
    """A motor on a bench, whose position was integrated: friction by speed alone."""
    generator = np.random.default_rng(27)
    motion = programmes.sines(120, generator)
    torque = programmes.torque(motion, gravity=(0.0, 0.0), alpha=0.0)
    torque += generator.normal(0, 0.2, len(torque))
    facts = {"torque_unit": "N·m", "position": "integrated"}
    tables.write(
        tmp_path / "samples.parquet",
        programmes.samples(motion, torque),
        schemas.SAMPLES,
        Provenance("ingest"),
        facts,
    )
    assert "not determined: gravity: the log has no angle" in str(separate(tmp_path, REGRESSION))
    rows = tables.read(tmp_path / TORQUES, schemas.TORQUES)
    assert rows["position"].std() == 0
    error = rows["friction_torque"] - 8.0 - 2.0 * np.sqrt(rows["speed"])
    assert np.abs(error).max() < 0.3
    # the constant load of an offset is not told from Coulomb friction
    found = tables.facts(tmp_path / TORQUES)["regression"]["1"]
    assert "alpha" in found["undetermined"]
    assert found["condition"] < 100
    middle = found["friction"][1]
    assert middle["estimate"] == pytest.approx(8.0 + 2.0 * np.sqrt(middle["speed"]), rel=0.02)


@pytest.mark.long
def test_both_ways_agree_on_a_simulated_joint(tmp_path):
    """Logs of the simulator, with noise from pair to pair: the same friction by both ways."""
    settings = SynthesisSettings(joint_kind="plain", noise_kind="pair", runs=1, seed=7)
    synthesize(tmp_path / "logs", settings)
    work = tmp_path / "work"
    ingest([tmp_path / "logs"], work)
    pair(work)
    models = []
    for way in ("pairs", "regression"):
        separate(work, SeparationSettings(by=way))
        fit(work)
        models += read_models(work / "model.json")
    first, second = models
    for name, one in first.parameters.items():
        other = second.parameters[name]
        assert one.determined
        assert other.determined
        half = sum((low_high[1] - low_high[0]) / 2 for low_high in (one.ci95, other.ci95))
        # pairs average the square of the load over a bin, which the regression does not
        assert abs(one.estimate - other.estimate) < half + 0.003 * other.estimate, name
