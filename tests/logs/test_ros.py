"""ROS recordings as logs: ROS 2 in SQLite and MCAP, ROS 1."""

import shutil
import sqlite3
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.formats import open_log
from frictioncli.logs.formats.ros import joint_numbers
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .containers import COLUMNS, POSITION, TIME, TORQUE, VELOCITY, assert_same_as_csv, without

pytest.importorskip("rosbags", reason="the optional package rosbags is not installed")

TYPE = "sensor_msgs/msg/JointState"
KINDS = ("db3", "mcap", "bag")
kinds = pytest.mark.parametrize("kind", KINDS)
STATES = {
    "joint_1": (POSITION * 0, VELOCITY * 0, TORQUE * 0 + 1.0),
    "joint_2": (np.radians(POSITION), np.radians(VELOCITY), TORQUE),
    "joint_3": (POSITION * 0 + 0.5, VELOCITY * 0, TORQUE * 0 + 2.0),
}


def state(names, *fields):
    """Names, positions, velocities and efforts of one message."""
    return list(names), *(np.array(values, float) for values in fields)


def states(joints=STATES, effort=True, velocity=True, turned=True):
    """Return one message per sample; the order of the joints changes from one to the next."""
    messages = []
    for i in range(len(TIME)):
        names = list(joints)
        if turned and i % 2:
            names = names[1:] + names[:1]
        q, dq, tau = ([joints[name][field][i] for name in names] for field in range(3))
        messages.append(state(names, q, dq if velocity else [], tau if effort else []))
    return messages


def recorded(folder, kind, topics, *, stamped=True, packed=False):
    """Write a recording: topic to messages; they arrive up to 5 ms later than they are stamped."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    if kind == "bag":
        path = folder / "log.bag"
        writer, store = Writer1(path), get_typestore(Stores.ROS1_NOETIC)
    else:
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        path = folder / "bag" / f"bag.{kind}"
        shutil.rmtree(folder / "bag", ignore_errors=True)
        writer = Writer(folder / "bag", version=9, storage_plugin=plugin)
        store = get_typestore(Stores.ROS2_HUMBLE)
        if packed:
            writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    late = np.random.default_rng(5).uniform(0, 5e-3, len(TIME))
    with writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, TYPE, typestore=store)
            for number, (names, q, dq, tau) in enumerate(messages):
                nanoseconds = round(TIME[number] * 1e9) if stamped else 0
                header = {"stamp": stamp_of(store, nanoseconds), "frame_id": ""}
                if kind == "bag":
                    header["seq"] = number
                message = store.types[TYPE](
                    header=store.types["std_msgs/msg/Header"](**header),
                    name=names,
                    position=q,
                    velocity=dq,
                    effort=tau,
                )
                serialize = store.serialize_ros1 if kind == "bag" else store.serialize_cdr
                arrived = 10**9 + round((TIME[number] + late[number]) * 1e9)
                writer.write(connection, arrived, serialize(message, TYPE))
    return path


def stamp_of(store, nanoseconds):
    return store.types["builtin_interfaces/msg/Time"](
        sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9
    )


def joint_2(log, work):
    ingest([log], work)
    table = tables.read(work / "samples.parquet", schemas.SAMPLES)
    return table[table["joint"] == 2]


def refused(path):
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    return found


@kinds
def test_joints_are_identified_by_name_and_times_by_the_stamp(tmp_path, kind):
    table = joint_2(recorded(tmp_path, kind, {"/joint_states": states()}), tmp_path / "work")
    np.testing.assert_allclose(table["time"], TIME, atol=1e-9)
    np.testing.assert_allclose(table["position"], POSITION, atol=1e-9)
    np.testing.assert_allclose(table["velocity"], VELOCITY, atol=1e-9)
    np.testing.assert_allclose(table["torque"], TORQUE, atol=1e-9)


@kinds
def test_a_recording_gives_the_samples_of_the_csv(tmp_path, kind):
    """One joint without velocities, which are differentiated in both."""
    messages = states({"joint_2": STATES["joint_2"]}, velocity=False)
    log = recorded(tmp_path, kind, {"/joint_states": messages})
    assert "velocity of joint_2 is empty in all messages" in open_log(log, CsvHints()).form
    assert_same_as_csv(log, tmp_path, without(COLUMNS, "velocity", "motor_temperature"))


def test_a_folder_of_a_bag_is_a_run(tmp_path):
    """metadata.yaml is part of the recording, not a rejected file."""
    recorded(tmp_path, "db3", {"/joint_states": states()})
    summary = ingest([tmp_path / "bag"], tmp_path / "work")
    assert summary.files_rejected == ()
    assert summary.rows_kept == len(TIME)


@pytest.mark.parametrize("name", ["a#b.db3", "a%31.db3", "a?mode=memory.db3", "a b.db3"])
def test_names_that_mean_something_in_a_uri(tmp_path, name):
    """The library names the database in a URI: of 'a%31.db3' it would read 'a1.db3'."""
    log = recorded(tmp_path, "db3", {"/joint_states": states()})
    expected = open_log(log, CsvHints()).columns
    found = open_log(log.rename(tmp_path / name), CsvHints())
    assert found.columns == expected
    assert len(next(found.batches([0], 1 << 20)).lines)


def test_messages_compressed_one_by_one(tmp_path):
    log = recorded(tmp_path, "db3", {"/joint_states": states()}, packed=True)
    table = joint_2(log, tmp_path / "work")
    np.testing.assert_allclose(table["torque"], TORQUE, atol=1e-9)


def test_without_stamps_the_time_of_reception_is_read(tmp_path):
    log = recorded(tmp_path, "mcap", {"/joint_states": states()}, stamped=False)
    assert "no time stamps: times of reception are read" in open_log(log, CsvHints()).form
    table = joint_2(log, tmp_path / "work")
    late = table["time"].to_numpy() - TIME
    assert np.ptp(late) > 1e-3  # the jitter of the network is in them
    assert np.all(np.abs(late) < 6e-3)


@kinds
@pytest.mark.parametrize("empty", ["missing", "nan"])
def test_empty_efforts_are_refused_by_name(tmp_path, kind, empty):
    messages = states(effort=False)
    if empty == "nan":
        messages = [(names, q, dq, q * np.nan) for names, q, dq, _ in messages]
    found = refused(recorded(tmp_path, kind, {"/joint_states": messages}))
    assert found.reason == "no_torque_channel"
    assert f"effort of joint_1, joint_2, joint_3 is empty in all {len(TIME)} messages" in found.text


def test_joints_without_effort_are_named(tmp_path):
    joints = {**STATES, "joint_3": (*STATES["joint_3"][:2], TORQUE * np.nan)}
    source = open_log(recorded(tmp_path, "db3", {"/joint_states": states(joints)}), CsvHints())
    assert "effort of joint_3 is empty in all messages" in source.form
    assert "effort_3" not in source.columns


def test_messages_without_an_effort_lose_their_rows(tmp_path):
    messages = states()
    for number in (4, 9):
        names, q, dq, _ = messages[number]
        messages[number] = state(names, q, dq, [])
    summary = ingest([recorded(tmp_path, "mcap", {"/joint_states": messages})], tmp_path / "work")
    assert summary.rows_rejected == {"missing_value": 2}


def test_other_publishers_are_left_out_and_named(tmp_path):
    gripper = [state(["finger"], [0.1], [0.0], []) for _ in range(50)]
    mixed = [message for pair in zip(states()[:50], gripper, strict=True) for message in pair]
    topics = {"/joint_states": mixed, "/old/joint_states": states(effort=False)[:9]}
    source = open_log(recorded(tmp_path, "db3", topics), CsvHints())
    assert "50 messages of /joint_states, joints 1 joint_1" in source.form
    assert "left out: 50 messages of /joint_states (finger), 9 messages of /old" in source.form


@given(order=st.permutations(["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2"]))
def test_numbers_of_joints(order):
    assert joint_numbers(["joint_3", "joint_1"]) == {"joint_3": 3, "joint_1": 1}
    assert joint_numbers(["joint0", "joint1"]) == {"joint0": 1, "joint1": 2}
    assert joint_numbers(["left_1", "right_1"]) == {"left_1": 1, "right_1": 2}
    assert joint_numbers(["hip", "knee"]) == {"hip": 1, "knee": 2}
    numbers = joint_numbers([f"ur_{name}_joint" for name in order])
    assert numbers["ur_shoulder_pan_joint"] == 1
    assert numbers["ur_elbow_joint"] == 3
    assert numbers["ur_wrist_2_joint"] == 5


def test_recordings_without_joint_states_name_their_topics(tmp_path):
    log = recorded(tmp_path, "db3", {"/tf": []})
    with sqlite3.connect(log) as database:
        database.execute("UPDATE topics SET type = 'tf2_msgs/msg/TFMessage'")
    database.close()
    assert "its topics are /tf" in refused(log).text


def test_an_mcap_of_another_kind_is_refused(tmp_path):
    (tmp_path / "log.mcap").write_bytes(
        b"\x89MCAP0\r\n\x01" + (17).to_bytes(8, "little") + b"\x09\0\0\0protobuf1\0\0\0\0"
    )
    assert (
        "MCAP recording of profile 'protobuf1', expected 'ros2'"
        in refused(tmp_path / "log.mcap").text
    )


def test_a_database_that_is_no_bag_is_refused(tmp_path):
    with sqlite3.connect(tmp_path / "log.db3") as database:
        database.execute("CREATE TABLE robots (name TEXT)")
    database.close()
    assert refused(tmp_path / "log.db3").reason == "unreadable_file"


@kinds
def test_damaged_recordings_are_refused(tmp_path, kind):
    path = recorded(tmp_path, kind, {"/joint_states": states()})
    whole = path.read_bytes()
    for length in (20, 600, len(whole) // 2):
        path.write_bytes(whole[:length])
        with pytest.raises(LogError, match="no usable log"):
            ingest([path], tmp_path / "work")
    assert not (tmp_path / "work" / "samples.parquet").exists()


@kinds
def test_without_the_package_the_message_says_how_to_get_it(tmp_path, kind, monkeypatch):
    path = recorded(tmp_path, kind, {"/joint_states": states()[:3]})
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    assert "pip install 'frictioncli[mcap]'" in refused(path).text
