"""Suggested mapping files, also for columns without meaningful names, in random order and units."""

import re
import tomllib
import warnings

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.errors import LogError, NotEnoughData
from frictioncli.inspection.inspect import inspect
from frictioncli.inspection.map_suggestion.measured_or_commanded import lag
from frictioncli.inspection.map_suggestion.suggest_map import suggested_map
from frictioncli.logs.ingest import ingest
from frictioncli.logs.settings import IngestSettings
from frictioncli.stages.run import run
from frictioncli.stages.settings import RunSettings
from tests.logs.logs import REAL

from .faulty import COLUMNS, clean_log, write

TIME, POSITION, VELOCITY, TORQUE, TEMPERATURE = COLUMNS
LAG = 3
NAMES = ("time", "position", "velocity", "torque", "motor_temperature")


def wide_log(seed, time_unit, position_unit, velocity_unit, kelvin, with_commands, still_joint):
    """Return columns by quantity: those of a faultless log, and others that loggers write."""
    log = clean_log(seed, period=0.01)
    rng = np.random.default_rng([seed, 7])
    angle = {"deg": 1.0, "rad": np.pi / 180}
    rate = {"deg/s": 1.0, "rad/s": np.pi / 180, "rpm": 1 / 6}
    temperature = 25.0 + np.floor(9 * np.arange(len(log)) / len(log))
    columns = {
        "time": log[TIME] * {"s": 1.0, "ms": 1e3, "us": 1e6}[time_unit],
        "position": log[POSITION] * angle[position_unit],
        "velocity": log[VELOCITY] * rate[velocity_unit],
        "torque": log[TORQUE],
        "motor_temperature": temperature + (273.15 if kelvin else 0.0),
        "zeros": np.zeros(len(log)),
        "counter": np.arange(len(log), dtype=float),
        "noise": rng.normal(0, 5, len(log)),
        "state": np.repeat(rng.integers(0, 4, len(log) // 50 + 1), 50)[: len(log)].astype(float),
        "voltage": 48 + rng.normal(0, 0.1, len(log)),
    }
    if with_commands:
        ahead = np.minimum(np.arange(len(log)) + LAG, len(log) - 1)
        smooth = clean_log(seed, period=0.01, noise=0)
        columns["position_command"] = smooth[POSITION].to_numpy()[ahead] * angle[position_unit]
        columns["velocity_command"] = log[VELOCITY].to_numpy()[ahead] * rate[velocity_unit]
    if still_joint:
        other = clean_log(seed + 1, period=0.01, speeds=(30,), reach=5)
        still = np.pad(other[POSITION].to_numpy(), (0, len(log)), "edge")[: len(log)]
        columns["other_position"] = still * angle[position_unit]
        columns["other_velocity"] = np.gradient(still, 0.01) * rate[velocity_unit]
        columns["other_torque"] = 3 * np.cos(np.radians(still)) + rng.normal(0, 0.3, len(log))
    return log, columns


@settings(max_examples=12)
@given(
    seed=st.integers(0, 10_000),
    order=st.randoms(use_true_random=False),
    time_unit=st.sampled_from(["s", "ms", "us"]),
    position_unit=st.sampled_from(["deg", "rad"]),
    velocity_unit=st.sampled_from(["deg/s", "rad/s", "rpm"]),
    kelvin=st.booleans(),
    with_commands=st.booleans(),
    still_joint=st.booleans(),
)
def test_columns_without_names(tmp_path_factory, order, **drawn):
    """Order, units and other columns are drawn; with the map the log gives the original samples."""
    folder = tmp_path_factory.mktemp("log")
    log, columns = wide_log(**drawn)
    labels = list(columns)
    order.shuffle(labels)
    blind = {label: f"c{i + 1}" for i, label in enumerate(labels)}
    table = pd.DataFrame({blind[label]: columns[label] for label in labels})
    path = write(table, folder / "table.csv", digits=9)

    text = suggested_map([path], IngestSettings(joints=(4,)))
    mapping = tomllib.loads(text)
    assert mapping["channels"] == {name: blind[name] for name in NAMES}
    assert mapping["units"]["time"] == drawn["time_unit"]
    assert mapping["units"]["position"] == drawn["position_unit"]
    assert mapping["units"]["velocity"] == drawn["velocity_unit"]
    assert mapping["units"]["motor_temperature"] == ("K" if drawn["kelvin"] else "°C")
    assert mapping["joint"] == {"number": 4}

    map_file = folder / "channels.toml"
    map_file.write_text(text, encoding="utf-8")
    (found,) = inspect([path], IngestSettings(map_file=map_file)).files
    assert found.refusal == ""
    ingest([path], folder / "work", IngestSettings(map_file=map_file))
    samples = tables.read(folder / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(samples["position"], log[POSITION], atol=1e-6)
    np.testing.assert_allclose(samples["velocity"], log[VELOCITY], atol=1e-5)
    np.testing.assert_allclose(samples["torque"], log[TORQUE], atol=1e-6)


def test_a_log_without_velocity(tmp_path):
    """The position is the smoothest column; the torque depends on the sign of its derivative."""
    log = clean_log()
    table = pd.DataFrame({"a": log[TORQUE], "b": log[TIME], "c": log[POSITION]})
    mapping = tomllib.loads(suggested_map([write(table, tmp_path / "log.csv")]))
    assert mapping["channels"] == {"time": "b", "position": "c", "torque": "a"}


def test_names_of_joints_choose_among_them(tmp_path):
    """Three joints move in turn; each is found by its number, with current as torque in A."""
    logs = [clean_log(seed, speeds=(20 + 10 * seed, 40)) for seed in range(3)]
    n = sum(map(len, logs))
    table = {"uhr": np.arange(n) * 0.01}
    start = 0
    for number, log in enumerate(logs):
        rows = slice(start, start + len(log))
        start += len(log)
        for name, column in (("winkel", POSITION), ("tempo", VELOCITY), ("strom", TORQUE)):
            values = np.full(n, float(log[column].iloc[0]))
            values[rows] = log[column]
            values[rows.stop :] = log[column].iloc[-1]
            table[f"{name}_g{number}_ist"] = values
    path = write(pd.DataFrame(table), tmp_path / "log.csv")
    for joint in (1, 2, 3):
        mapping = tomllib.loads(suggested_map([path], IngestSettings(joints=(joint,))))
        tail = f"_g{joint - 1}_ist"
        assert mapping["channels"]["position"] == f"winkel{tail}"
        assert mapping["channels"]["velocity"] == f"tempo{tail}"
        assert mapping["channels"]["torque"] == f"strom{tail}"
        assert mapping["units"]["torque"] == "A"
        assert mapping["joint"]["number"] == joint


@pytest.mark.parametrize(
    "hostile",
    ['q"\\u0041', "a = 1 # b", "\x1b[31mred", "‮detrever", "'); DROP", "ünï côdé", "[x] 'y'"],
)
def test_hostile_names_stay_inside_their_strings(tmp_path, hostile):
    """Whatever a column is called, the map is valid, names it, and has no control characters."""
    log = clean_log()
    table = pd.DataFrame({"z": log[TIME], "p": log[POSITION], "v": log[VELOCITY]})
    table[hostile] = log[TORQUE]
    path = tmp_path / "log.csv"
    table.to_csv(path, index=False)
    text = suggested_map([path])
    assert all(character.isprintable() or character == "\n" for character in text)
    assert tomllib.loads(text)["channels"]["torque"] == hostile
    map_file = tmp_path / "channels.toml"
    map_file.write_text(text, encoding="utf-8")
    (found,) = inspect([path], IngestSettings(map_file=map_file)).files
    assert found.refusal == ""
    assert found.rows_kept == len(log)


def test_the_first_file_that_is_not_recognised_is_chosen(tmp_path):
    log = clean_log()
    write(log, tmp_path / "run" / "a.csv")
    plain = log.set_axis(["c1", "c2", "c3", "c4", "c5"], axis=1)
    write(plain, tmp_path / "run" / "b.csv")
    text = suggested_map([tmp_path / "run"])
    assert "b.csv" in text
    assert tomllib.loads(text)["channels"]["position"] == "c2"


def test_a_table_without_motion_is_refused(tmp_path):
    rng = np.random.default_rng(3)
    table = pd.DataFrame({"t": np.arange(500) * 0.1, "x": rng.normal(size=500)})
    with pytest.raises(LogError, match=r"log\.csv.*no column looks like a joint's position"):
        suggested_map([write(table, tmp_path / "log.csv")])
    table["t"] = rng.normal(size=500)
    with pytest.raises(LogError, match="without a time column, give the period"):
        suggested_map([write(table, tmp_path / "log.csv")])


def test_german_names_of_one_joint(tmp_path):
    """Names that are known but for ``ist``, with a commanded position beside the measured one."""
    log = clean_log()
    table = pd.DataFrame(
        {
            "t": log[TIME],
            "q_ist_A3": log[POSITION],
            "dq_ist_A3": log[VELOCITY],
            "Moment_A3": log[TORQUE],
            "q_soll_A3": np.roll(log[POSITION], -2),
        }
    )
    text = suggested_map([write(table, tmp_path / "log.csv")])
    mapping = tomllib.loads(text)
    assert mapping["channels"] == {
        "time": "t",
        "position": "q_ist_A3",
        "velocity": "dq_ist_A3",
        "torque": "Moment_A3",
    }
    assert mapping["joint"] == {"number": 3}
    assert re.search(r"Checked: with it \d+ pairs", text)


def test_names_go_before_accidents_of_the_values(tmp_path):
    """In the first file nothing but noise; there a velocity may be taken for a position."""
    log = clean_log()
    rng = np.random.default_rng(5)
    still = np.cumsum(rng.normal(0, 1e-3, len(log)))
    table = pd.DataFrame({"s": log[TIME], "Velocity_3 x": still, "Torq 3 x": log[TORQUE]})
    table["Pos_3 x"] = np.gradient(still, 0.01)
    moving = table.assign(**{"Pos_3 x": log[POSITION], "Velocity_3 x": log[VELOCITY]})
    names = ["uhr", "velocity_3", "drehm_3", "pos_3"]
    write(table.set_axis(names, axis=1), tmp_path / "run" / "a.csv")
    write(moving.set_axis(names, axis=1), tmp_path / "run" / "b.csv")
    mapping = tomllib.loads(suggested_map([tmp_path / "run"]))
    assert mapping["channels"]["position"] == "pos_3"
    assert mapping["channels"]["velocity"] == "velocity_3"
    assert mapping["channels"]["torque"] == "drehm_3"


def test_a_command_is_no_position_where_one_is_measured(tmp_path):
    """The measured position does not agree with the measured velocity, the commanded ones do."""
    log = clean_log()
    table = pd.DataFrame(
        {
            "time": log[TIME],
            "position": 1.8 * log[POSITION],
            "velocity": log[VELOCITY],
            "torque_feedback": log[TORQUE],
            "velocity_cmd": log[VELOCITY],
            "acceleration_cmd": np.gradient(log[VELOCITY], 0.01),
            "position_cmd": log[POSITION],
        }
    )
    mapping = tomllib.loads(suggested_map([write(table, tmp_path / "log.csv")]))
    assert mapping["channels"] == {
        "time": "time",
        "position": "position",
        "velocity": "velocity",
        "torque": "torque_feedback",
    }


def test_what_pairs_nothing_is_not_called_sure(tmp_path):
    """A sine: no constant speed, so nothing confirms the columns."""
    rng = np.random.default_rng(1)
    seconds = np.arange(0, 40, 0.01)
    angle, rate = 30 * np.sin(0.6 * seconds), 18 * np.cos(0.6 * seconds)
    table = pd.DataFrame({"b": seconds, "c": angle, "d": rate})
    table["a"] = 5 * np.sign(rate) + 9 * np.cos(np.radians(3 * angle)) + rng.normal(0, 1, 4000)
    text = suggested_map([write(table, tmp_path / "log.csv")])
    assert "Checked: with it no move at constant speed has a counterpart" in text
    assert "# sure" not in text


@pytest.mark.parametrize("swing", [0.0, 20.0])
def test_a_suggested_map_does_not_hide_the_motion_of_other_joints(swing, tmp_path):
    """Joint 2 turns during every second move of joint 1 where it swings."""
    rng = np.random.default_rng(5)
    seconds = np.arange(0, 80, 0.01)
    angle = 40 * np.abs((seconds / 4) % 2 - 1)
    rate = np.gradient(angle, seconds)
    other = 10 + swing * np.clip(np.minimum(seconds % 16, 16 - seconds % 16) - 4, 0, 4)
    log = pd.DataFrame({"clock": seconds, "Pos_0": angle, "Pos_1": other, "Vel_0": rate})
    log["Current_0"] = 2 * np.sign(rate) + rng.normal(0, 0.05, len(seconds))
    text = suggested_map([write(log, tmp_path / "log.csv")], IngestSettings(joints=(1,)))
    assert ("another joint moves during 5" in text) == (swing > 0)
    map_file = tmp_path / "channels.toml"
    map_file.write_text(text, encoding="utf-8")
    ingest([tmp_path / "log.csv"], tmp_path / "work", IngestSettings(map_file=map_file))
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert set(samples["joint"]) == {1}
    assert set(samples["other_joints"]) == ({0, 2} if swing else {0})


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
def test_a_suggested_map_of_an_arm_that_moves_as_a_whole_is_no_way_round_its_refusal(tmp_path):
    text = suggested_map([REAL / "nist-ur5"])
    assert "# joint 2: another joint moves during 100 % of its motion" in text
    map_file = tmp_path / "channels.toml"
    map_file.write_text(text, encoding="utf-8")
    mapped = IngestSettings(map_file=map_file)
    with pytest.raises(NotEnoughData, match="other joint moves in 100 % of its motion"):
        run([REAL / "nist-ur5"], tmp_path / "work", RunSettings(ingest=mapped))


@given(shift=st.floats(-6, 6), seed=st.integers(0, 100))
@settings(max_examples=40)
def test_lag_between_two_columns(shift, seed):
    """A wave and the same wave ``shift`` samples later."""
    phase = np.random.default_rng(seed).uniform(0, 6)
    rows = np.arange(600.0)

    def wave(t):
        return np.sin(t / 40 + phase) + 0.5 * np.sin(t / 17)

    assert lag(wave(rows), wave(rows - shift)) == pytest.approx(shift, abs=0.05)


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
@pytest.mark.parametrize(
    ("folder", "expected"),
    [
        ("xarm6-j3", ("Pos_2", "Velocity_2", "Current_2", "Torque_2")),
        ("ur10e-j1", ("column 2", "column 8", "column 14", None)),
        ("damiao-5", ("position", "velocity", "torque_feedback", None)),
    ],
)
def test_real_logs_without_a_hint(folder, expected):
    mapping = tomllib.loads(suggested_map([REAL / folder]))["channels"]
    found = tuple(mapping.get(name) for name in ("position", "velocity", "torque", "load"))
    assert found == expected


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
def test_xarm_joint_2_of_seven(tmp_path):
    """Torque_1 is without friction and serves as load; the current contains the friction."""
    text = suggested_map([REAL / "xarm6-j2"], IngestSettings(joints=(2,)))
    mapping = tomllib.loads(text)
    assert mapping["channels"] == {
        "time": "Time (s)",
        "position": "Pos_1",
        "velocity": "Velocity_1",
        "torque": "Current_1",
        "load": "Torque_1",
        "motor_temperature": "Temp_1",
    }
    assert mapping["units"]["torque"] == "A"
    map_file = tmp_path / "channels.toml"
    map_file.write_text(text, encoding="utf-8")
    whole = inspect([REAL / "xarm6-j2"], IngestSettings(map_file=map_file))
    assert sum(not file.refusal for file in whole.files) == 14
    (joint,) = whole.joints
    assert joint.joint == 2
    assert {stage.name: stage.suffices for stage in joint.stages}["separate"] == "yes"


def text_log(path, times, positions, rates):
    """Write a log of a position that goes there and back, by lists of text."""
    rows = zip(times, positions, rates, strict=True)
    lines = [f"{t};{q};{v};{i % 7}" for i, (t, q, v) in enumerate(rows)]
    path.write_text("\n".join(["t;position_2;velocity_2;tau", *lines]), encoding="utf-8")
    return path


def test_positions_in_microdegrees_beside_a_velocity_of_something_else(tmp_path):
    """Velocities are not logged in microdegrees per second: there is no such unit."""
    swing = [round(5e7 * np.sin(i / 40)) for i in range(400)]
    path = text_log(tmp_path / "log.csv", [f"{i / 100}" for i in range(400)], swing, swing)
    units = tomllib.loads(suggested_map([path], IngestSettings()))["units"]
    assert (units["position"], units["velocity"]) == ("udeg", "deg/s")


def test_times_that_no_clock_has_are_no_hindrance(tmp_path):
    """Steps of 1e-300 s make velocities without end."""
    swing = [f"{50 * np.sin(i / 40)}" for i in range(300)]
    path = text_log(tmp_path / "log.csv", [f"{i}e-300" for i in range(300)], swing, ["0"] * 300)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "[channels]" in suggested_map([path], IngestSettings())


def test_times_of_a_speed_alone_that_do_not_change_are_no_hindrance(tmp_path):
    lines = ["time [s];velocity [deg/s];torque [Nm]"]
    lines += [f"-1e300;{i % 7};{5 + i % 3}" for i in range(300)]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    with pytest.raises(LogError, match="grows from row to row"):
        suggested_map([tmp_path / "log.csv"])


def test_the_form_of_the_text_is_repeated(tmp_path):
    """Without it the log would have no time, and numbers that are none."""
    log = clean_log(4)
    path = tmp_path / "logs" / "day1" / "log.txt"
    path.parent.mkdir(parents=True)
    log.drop(columns=TIME).to_csv(path, sep="\t", decimal=",", index=False, encoding="utf-16")
    form = {"delimiter": "\t", "decimal": ",", "encoding": "utf-16", "period": 0.01}
    own, suggested = tmp_path / "own.toml", tmp_path / "suggested.toml"
    own.write_text('[csv]\ndelimiter = "tab"\ndecimal = ","\nencoding = "utf-16"\nperiod = 0.01\n')
    suggested.write_text(suggested_map([path], IngestSettings(map_file=own)), encoding="utf-8")
    assert tomllib.loads(suggested.read_text(encoding="utf-8"))["csv"] == form
    ingest([path.parent], tmp_path / "work", IngestSettings(map_file=suggested))
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(samples["time"], log[TIME] - log[TIME].iloc[0], atol=1e-9)


def named_log(folder, **columns):
    """Write a log of a clean joint; each column is made of its position, velocity and torque."""
    log = clean_log(3, period=0.01)
    position, velocity, torque = (log[name].to_numpy() for name in (POSITION, VELOCITY, TORQUE))
    made = {name: make(position, velocity, torque) for name, make in columns.items()}
    pd.DataFrame({"t_ms": np.arange(len(log)) * 10, **made}).to_csv(folder / "log.csv", index=False)
    return folder / "log.csv"


def test_a_speed_is_no_torque_and_counts_need_their_size(tmp_path):
    """A motor with an encoder and a PWM: nothing measures its torque."""
    path = named_log(
        tmp_path,
        pwm=lambda q, v, tau: np.round(20 * tau),
        enc_count=lambda q, v, tau: np.round(q * 100),
        speed_rpm=lambda q, v, tau: v / 6,
    )
    text = suggested_map([path], IngestSettings())
    assert "torque" not in tomllib.loads(text)["channels"]
    assert tomllib.loads(text)["scale"] == {"position": 0}


@pytest.mark.parametrize("name", ["tau_cmd", "tau_ext", "TorqueDes"])
def test_a_torque_that_was_not_measured_is_a_guess(name, tmp_path):
    path = named_log(
        tmp_path,
        q=lambda q, v, tau: q,
        qd=lambda q, v, tau: v,
        **{name: lambda q, v, tau: tau},
    )
    text = suggested_map([path], IngestSettings())
    assert tomllib.loads(text)["channels"]["torque"] == name
    (reason,) = (one for one in text.splitlines() if "by its name: name the measured one" in one)
    assert reason.startswith("# a guess: ")


def test_a_measured_torque_goes_before_a_commanded_one(tmp_path):
    path = named_log(
        tmp_path,
        q=lambda q, v, tau: q,
        tau_cmd=lambda q, v, tau: tau + 0.01 * np.arange(len(q)) % 2,
        tau_cor=lambda q, v, tau: tau,
    )
    text = suggested_map([path], IngestSettings())
    assert tomllib.loads(text)["channels"]["torque"] == "tau_cor"


def test_temperatures_are_no_motion(tmp_path):
    path = named_log(
        tmp_path,
        temp_mos=lambda q, v, tau: 30 + q / 100,
        temp_mos_rate=lambda q, v, tau: v / 100,
        current=lambda q, v, tau: tau,
    )
    with pytest.raises(LogError, match="no column looks like a joint's position"):
        suggested_map([path], IngestSettings())


def test_beside_a_torque_without_friction_others_are_named(tmp_path):
    path = named_log(
        tmp_path,
        q=lambda q, v, tau: q,
        qd=lambda q, v, tau: v,
        tau=lambda q, v, tau: 10 * np.cos(np.radians(q)),
        motorwert=lambda q, v, tau: tau,
    )
    text = suggested_map([path], IngestSettings())
    assert '# torque = "motorwert"' in text


def test_a_drive_without_position_and_with_unknown_names(tmp_path):
    """The speed is known by its unit, the current by its dependence on the direction."""
    path = named_log(
        tmp_path,
        vel_target_RPM=lambda q, v, tau: v / 6,
        vel_X85_RPM=lambda q, v, tau: v / 6,
        i_X85_mA=lambda q, v, tau: 900 * np.sign(v),
    )
    text = suggested_map([path], IngestSettings())
    channels = tomllib.loads(text)["channels"]
    assert channels == {"time": "t_ms", "velocity": "vel_X85_RPM", "torque": "i_X85_mA"}
    assert tomllib.loads(text)["units"] == {"time": "ms", "velocity": "rpm", "torque": "mA"}
    assert "half the difference of torque is 0.9" in text


def test_the_speeds_of_an_arm_make_no_positions(tmp_path):
    path = named_log(
        tmp_path,
        shoulder_rpm=lambda q, v, tau: v / 6,
        elbow_rpm=lambda q, v, tau: np.abs(v) / 6,
        i_shoulder_mA=lambda q, v, tau: 900 * np.sign(v),
    )
    with pytest.raises(LogError, match="a friction test needs positions"):
        suggested_map([path], IngestSettings())


def test_a_log_without_names_and_without_time(tmp_path):
    """The refusal asks for the period; with it, numbers of columns are no joints."""
    log = clean_log(3, period=0.01)
    columns = [log[name] for name in (POSITION, VELOCITY, TORQUE)]
    path = tmp_path / "log.txt"
    np.savetxt(path, np.column_stack(columns), fmt="%.6f", delimiter="\t")
    with pytest.raises(LogError, match=r"\[csv\] period"):
        suggested_map([path], IngestSettings())
    map_file = tmp_path / "period.toml"
    map_file.write_text("[csv]\nperiod = 0.01\n")
    text = suggested_map([path], IngestSettings(map_file=map_file))
    channels = tomllib.loads(text)["channels"]
    expected = {"position": "column 1", "velocity": "column 2", "torque": "column 3"}
    assert channels == {"time": "time [s]", **expected}
