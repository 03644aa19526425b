"""What an inspection says on the terminal and as JSON, and what logs suffice for."""

import json

import numpy as np
import pytest

from frictioncli.documents import to_json
from frictioncli.inspection.document import document
from frictioncli.inspection.inspect import inspect
from frictioncli.inspection.text import text
from frictioncli.logs.settings import IngestSettings
from tests.logs.logs import REAL, kuka_columns, text_of

from .faulty import COLUMNS, clean_log, write

TIME, POSITION, VELOCITY, TORQUE, TEMPERATURE = COLUMNS


def stages(found):
    (joint,) = found.joints
    return {stage.name: (stage.suffices, stage.reason) for stage in joint.stages}


def hot_day(seed, **motion):
    """Return a log that warms from 25 to 45 °C and cools down again, in steps of 1 °C."""
    log = clean_log(seed, speeds=(20, 40, 60) * 6, **motion)
    share = np.linspace(-1, 1, len(log))
    log[TEMPERATURE] = np.floor(45 - 20 * np.abs(share))
    return log


def test_form_channels_units_and_faults(tmp_path):
    columns = kuka_columns()
    columns["AxisPos_Act2[°]"] = np.radians(columns["AxisPos_Act2[°]"])
    content = text_of(columns, decimal=",").replace("\n", "\nfaulty\n", 1)
    (tmp_path / "a.csv").write_text(content, encoding="cp1252")
    (tmp_path / "b.csv").write_text("")
    whole = inspect([tmp_path])
    first, second = whole.files
    assert first.rejected == {"wrong_field_count": 1}
    assert first.rows == len(columns["Zeit[sec]"]) + 1 == first.rows_kept + 1
    position = next(c for c in first.joints[0].channels if c.quantity == "position")
    assert (position.unit_found, position.unit_believed) == ("°", "rad")
    assert "says °" in position.evidence
    assert (position.lowest, position.highest) == pytest.approx((-50, 62), abs=0.1)
    assert second.reason == "empty_file"
    shown = text(whole)
    assert "83.33 Hz" in shown
    assert "decimal comma, CP1252" in shown
    assert "not usable: empty file" in shown
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "b.csv"]


def test_a_reason_is_of_its_own_channel(tmp_path):
    """One name may begin with another."""
    log = clean_log(3)
    log[[POSITION, VELOCITY]] = np.radians(log[[POSITION, VELOCITY]])
    names = dict(zip(COLUMNS, ("time", "q", "qd", "tau", "temperature"), strict=True))
    path = write(log.rename(columns=names), tmp_path / "log.csv")
    channels = {one.quantity: one for one in inspect([path]).files[0].joints[0].channels}
    position, velocity = channels["position"].evidence, channels["velocity"].evidence
    assert position.startswith("has no unit, values span")
    assert velocity.startswith("has no unit, position changes")
    assert position.count("has no unit") == velocity.count("has no unit") == 1


def test_a_whole_experiment_suffices_for_every_stage(tmp_path):
    """Two days with a thermal cycle each, three speeds, start times by the manifest."""
    for day in (1, 2):
        write(hot_day(day), tmp_path / f"day{day}" / "log.csv")
        manifest = f"file;started_at\nlog.csv;2024-05-0{day}T08:00:00\n"
        (tmp_path / f"day{day}" / "manifest.csv").write_text(manifest, encoding="utf-8")
    found = inspect([tmp_path])
    assert {suffices for suffices, _ in stages(found).values()} == {"yes"}
    (joint,) = found.joints
    assert (joint.forward, joint.reverse, joint.pairs) == (36, 36, 36)
    assert joint.temperature == pytest.approx((25, 45), abs=2)
    assert joint.speeds == pytest.approx((20, 40, 60), rel=0.01)
    low, high = joint.load
    assert 30 * np.cos(np.radians(30)) - 1 < low < high < 31


@pytest.mark.parametrize(
    ("change", "stage", "suffices", "told"),
    [
        (lambda log: log.drop(columns=TEMPERATURE), "fit", "in part", "no motor or housing"),
        (lambda log: log.drop(columns=TEMPERATURE), "simulate", "no", "no motor or housing"),
        (lambda log: log.assign(**{TEMPERATURE: 30.0}), "fit", "in part", "spans 0.0 °C"),
        (lambda log: log, "diagnose", "in part", "one run only"),
        (lambda log: log[: len(log) // 3], "diagnose", "no", "at least 12 are needed"),
        (lambda log: log[:400], "pair", "no", "1x forward and 0x in reverse"),
        (lambda log: log[:400], "separate", "in part", "'separate' uses regression on all motion"),
        (lambda log: log[:400], "simulate", "in part", "as far as the regression gives torques"),
        (
            lambda log: log.assign(
                **{
                    TORQUE: 30 * np.cos(np.radians(log[POSITION]))
                    + np.random.default_rng(1).normal(0, 1, len(log))
                }
            ),
            "separate",
            "in part",
            "of the pairs only",
        ),
    ],
)
def test_what_is_missing_is_said(tmp_path, change, stage, suffices, told):
    write(change(hot_day(3)), tmp_path / "log.csv")
    found, reason = stages(inspect([tmp_path]))[stage]
    assert found == suffices
    assert told in reason


def test_one_speed_does_not_tell_viscous_friction(tmp_path):
    log = clean_log(4, speeds=(40,) * 6)
    log[TEMPERATURE] = np.floor(np.linspace(25, 40, len(log)))
    write(log, tmp_path / "log.csv")
    suffices, reason = stages(inspect([tmp_path]))["fit"]
    assert suffices == "in part"
    assert "speeds span 40 to 40 deg/s" in reason


def test_what_holds_in_many_files_is_told_once(tmp_path):
    """300 files alike, two with a gap each: one block, a line per file, the remarks once."""
    for number in range(300):
        log = clean_log(number % 5, speeds=(60,), period=0.02, reach=30)
        if number in (7, 250):
            log = log.drop(index=range(40, 60))
        write(log, tmp_path / f"part_{number:03d}.csv")
    found = inspect([tmp_path])
    lines = text(found).splitlines()
    assert len(lines) < 40
    assert max(map(len, lines)) <= 100 + len(str(tmp_path))
    assert sum("read as deg: as the header says" in line for line in lines) == 1
    assert sum("gap" in line and "part_" in line for line in lines) == 2
    assert sum(line.strip().startswith("part_") for line in lines) == 0
    listed = text(found, verbose=True).splitlines()
    assert len(listed) < 300 + 40
    assert sum(line.strip().startswith("part_") for line in listed) == 300


def test_the_verdict_comes_first_and_files_on_demand(tmp_path):
    for number in range(40):
        write(clean_log(number % 5), tmp_path / f"part_{number:03d}.csv")
    found = inspect([tmp_path])
    shown = text(found).splitlines()
    assert shown[0].startswith("joint 2 in all logs: ")
    assert len(shown) < 40
    assert "--verbose" in shown[-1]
    assert "--verbose" not in text(found, verbose=True)


def test_an_unreadable_manifest_is_a_remark(tmp_path):
    write(clean_log(), tmp_path / "log.csv")
    (tmp_path / "manifest.csv").write_text("nonsense\n")
    found = inspect([tmp_path])
    assert any("manifest" in remark for remark in found.remarks)
    assert found.files[0].refusal == ""


def test_json_is_whole_and_keeps_its_keys(tmp_path):
    log = clean_log()
    log.loc[300, TORQUE] += 40
    log["brake"] = 0.0
    write(log, tmp_path / "log.csv")
    (tmp_path / "junk.bin").write_bytes(bytes(range(256)))
    write(log[:40], tmp_path / "still" / "log.csv")  # nothing moves: NaN and nothing must be null
    found = json.loads(to_json(document(inspect([tmp_path]))))
    assert set(found) == {"program", "version", "files", "joints", "remarks"}
    files = {one["run"] + one["path"].rsplit(".")[-1]: one for one in found["files"]}
    junk, file, still = (
        files[key] for key in (f"{tmp_path.name}bin", f"{tmp_path.name}csv", "stillcsv")
    )
    assert still["joints"][0]["moves"] == {"forward": 0, "reverse": 0}
    assert still["joints"][0]["velocity_agreement"] is None
    assert not junk["usable"]
    assert junk["reason"] == "not_a_log"
    assert junk["sampling"] is None
    assert {"path", "run", "recording", "form", "columns", "rows", "rows_kept"} < set(file)
    assert {"nominal_period_s", "rate_hz", "jitter_s", "gaps", "resets"} < set(file["sampling"])
    (joint,) = file["joints"]
    assert joint["spikes"][0]["unit"] == "N·m"
    assert {c["quantity"]: c["unit"] for c in joint["channels"]} == {
        "position": "deg",
        "velocity": "deg/s",
        "torque": "N·m",
        "motor_temperature": "°C",
    }
    assert {remark["kind"] for remark in file["remarks"]} == {"spikes"}
    (data,) = found["joints"]
    assert data["stages"]["pair"]["suffices"] == "yes"
    assert len(data["speeds_deg_per_s"]) == 3


@pytest.mark.parametrize(
    "hostile", ["\x1b[2Jtorque_2 [Nm]", "torque_2 [Nm]\u202e\u2066", "a\x07b torque_2 [Nm]"]
)
def test_hostile_names_do_not_act_on_the_terminal(tmp_path, hostile):
    log = clean_log().rename(columns={TORQUE: hostile})
    (tmp_path / "channels.toml").write_text(
        '[channels]\ntime = "t"\nposition = "q_2"\nvelocity = "qd_2"\n'
        f'torque = {json.dumps(hostile)}\n[units]\ntorque = "N·m"\n[joint]\nnumber = 2\n',
        encoding="utf-8",
    )
    path = write(log, tmp_path / "log.csv")
    found = inspect([path], IngestSettings(map_file=tmp_path / "channels.toml"))
    assert found.files[0].refusal == ""
    assert found.files[0].joints[0].channels[2].column == hostile
    shown = text(found)
    assert all(character.isprintable() or character == "\n" for character in shown)


def test_a_unit_of_the_map_is_as_told_whatever_the_values(tmp_path):
    """Values beyond a turn are no reason where the user says rad."""
    log = clean_log().set_axis(["t", "q_2", "qd_2", "m", *clean_log().columns[4:]], axis=1)
    log["q_2"], log["qd_2"] = np.radians(log["q_2"]), np.radians(log["qd_2"])
    (tmp_path / "channels.toml").write_text(
        '[channels]\ntime = "t"\nposition = "q_2"\nvelocity = "qd_2"\ntorque = "m"\n[units]\n'
        'position = "rad"\nvelocity = "rad/s"\ntorque = "A"\n[joint]\nnumber = 2\n',
        encoding="utf-8",
    )
    path = write(log, tmp_path / "log.csv")
    found = inspect([path], IngestSettings(map_file=tmp_path / "channels.toml"))
    channels = {one.quantity: one for one in found.files[0].joints[0].channels}
    assert {channels[name].evidence for name in ("position", "velocity", "torque")} == {"as given"}
    assert max(abs(channels["position"].lowest), abs(channels["position"].highest)) > 6.9


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
class TestRealLogs:
    """The traps that the README of the real logs names, as far as a program can see them."""

    def test_xarm_torque_is_freed_of_friction(self):
        """The current is read in its place; joint 7 holds dummies, and a file is empty."""
        found = inspect([REAL / "xarm6-j2"])
        joint = next(joint for joint in found.joints if joint.joint == 2)
        separate = next(stage for stage in joint.stages if stage.name == "separate")
        assert separate.suffices == "yes"
        assert sum(file.reason == "empty_file" for file in found.files) == 1
        usable = [file for file in found.files if not file.refusal]
        assert all("Current_6 holds only zeros" in " ".join(file.notes) for file in usable)
        for file in usable:
            assert file.sampling.rate_hz == pytest.approx(2, abs=0.01)
            (grid,) = {
                c.grid.step
                for c in file.joints[1].channels
                if c.quantity == "motor_temperature" and c.grid is not None
            } or {1.0}
            assert grid == pytest.approx(1)

    def test_ur3_has_no_positions_and_long_gaps(self):
        (file,) = inspect([REAL / "ur3-cobotops"]).files
        assert file.reason == "no_position_channel"
        assert file.sampling.nominal_period_s == pytest.approx(1, abs=0.02)
        assert file.sampling.gaps == 3

    def test_nist_velocity_is_in_rad_per_second_and_nothing_pairs(self):
        found = inspect([REAL / "nist-ur5"])
        (file,) = found.files
        assert file.sampling.begins_s == pytest.approx(10578.16)
        for joint in file.joints[:5]:
            units = {c.quantity: c.unit_believed for c in joint.channels}
            assert (units["position"], units["velocity"]) == ("deg", "rad/s")
            assert joint.velocity_agreement == pytest.approx(1, abs=0.01)
        assert all(joint.pairs == 0 for joint in found.joints)

    def test_kr3_header_lies_about_radians(self):
        found = inspect([REAL / "kuka-kr3" / "PTP_Combined"])
        for file in found.files:
            for joint in file.joints:
                position = next(c for c in joint.channels if c.quantity == "position")
                assert (position.unit_found, position.unit_believed) == ("°", "rad")
                assert "says °" in position.evidence
