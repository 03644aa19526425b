"""HDF5 files as logs."""

import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.errors import LogError
from frictioncli.logs.formats import open_log
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .containers import COLUMNS, POSITION, TEMPERATURE, TIME, TORQUE, VELOCITY, assert_same_as_csv

h5py = pytest.importorskip("h5py", reason="the optional package h5py is not installed")


def refused(path):
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    return found


def test_datasets_of_a_group_with_units_in_attributes(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        for name, unit, values in (
            ("time", "ms", TIME * 1e3),
            ("position", "rad", np.radians(np.c_[POSITION * 0, POSITION])),
            ("velocity", "rad/s", np.radians(np.c_[VELOCITY * 0, VELOCITY])),
            ("torque", "Nm", np.c_[TORQUE * 0, TORQUE]),
            ("motor_temperature", "K", np.c_[TEMPERATURE, TEMPERATURE] + 273.15),
        ):
            dataset = file.create_dataset(f"run/{name}", data=values, chunks=True, compression=4)
            dataset.attrs["unit" if name != "time" else "units"] = unit
        file["run/comment"] = "text is no column"
        file["camera/stamps"] = np.arange(7.0)
    source = open_log(path, CsvHints())
    assert "group /run" in source.form
    assert "left out: /camera/stamps" in source.form
    assert "position[1] [rad]" in source.columns
    assert_same_as_csv(path, tmp_path)


def test_a_table_of_records(tmp_path):
    kind = [(name.split(" ")[0], "f8") for name in COLUMNS] + [("label", "S4"), ("spare", "i2", 3)]
    rows = np.zeros(len(TIME), kind)
    for name, values in COLUMNS.items():
        rows[name.split(" ")[0]] = values
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["table"] = rows
    source = open_log(tmp_path / "log.h5", CsvHints())
    assert source.columns[:2] == ("table.time", "table.position_2")
    assert source.columns[-1] == "table.spare[2]"
    (tmp_path / "map.toml").write_text("")  # names of a table's fields carry the table's name
    values = next(source.batches([1], 1 << 20)).values[1]
    np.testing.assert_array_equal(values, POSITION)


def test_joints_in_groups_of_their_own(tmp_path):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["time"] = TIME
        file["joint_2/position"] = POSITION
        file["joint_2/velocity"] = VELOCITY
        file["joint_2/torque"] = TORQUE
        file["joint_2/motor_temperature"] = TEMPERATURE
    assert_same_as_csv(tmp_path / "log.h5", tmp_path)


def test_rows_of_matlab_files_run_along_the_second_axis(tmp_path):
    with h5py.File(tmp_path / "log.mat", "w", userblock_size=512) as file:
        file["t"] = TIME[None, :]
        joint_2 = {"q": POSITION, "dq": VELOCITY, "tau": TORQUE, "temperature": TEMPERATURE}
        for name, values in joint_2.items():
            dataset = file.create_dataset(name, data=np.c_[values * 0, values].T)
            dataset.attrs["MATLAB_class"] = np.bytes_(b"double")
    with (tmp_path / "log.mat").open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64")
    assert_same_as_csv(tmp_path / "log.mat", tmp_path)


@settings(max_examples=25)
@given(
    values=st.lists(st.floats(allow_nan=True, width=32), min_size=2, max_size=300),
    chunk=st.integers(1, 70),
    size=st.integers(1, 3000),
)
def test_rows_come_in_order_whatever_the_chunks(tmp_path_factory, values, chunk, size):
    path = tmp_path_factory.mktemp("hdf5") / "log.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("x", data=values, chunks=(min(chunk, len(values)),), compression=1)
    parts = list(open_log(path, CsvHints()).batches([0], size))
    np.testing.assert_array_equal(np.concatenate([part.values[0] for part in parts]), values)
    lines = np.concatenate([part.lines for part in parts])
    assert lines.tolist() == list(range(1, len(values) + 1))


def test_several_recordings_in_one_file_are_refused(tmp_path):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        for name in ("demo_0", "demo_1"):
            for column, values in COLUMNS.items():
                file[f"data/{name}/{column.split(' ')[0]}"] = values
    found = refused(tmp_path / "log.h5")
    assert found.reason == "several_recordings"
    assert "/data/demo_0, /data/demo_1" in found.text


def test_nothing_is_read_from_other_files(tmp_path):
    """Links to other files, external and virtual datasets, and objects are skipped."""
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["torque_2"] = TORQUE
    (tmp_path / "raw.bin").write_bytes(TORQUE.tobytes())
    layout = h5py.VirtualLayout(shape=TORQUE.shape, dtype="f8")
    layout[:] = h5py.VirtualSource("other.h5", "torque_2", shape=TORQUE.shape)
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["time"], file["position_2"] = TIME, POSITION
        file["torque_2"] = h5py.ExternalLink("other.h5", "torque_2")
        file.create_dataset(
            "current_2",
            TORQUE.shape,
            "f8",
            external=[(str(tmp_path / "raw.bin"), 0, TORQUE.nbytes)],
        )
        file.create_virtual_dataset("moment_2", layout)
        file["objects"] = np.array(["a", "b"], dtype=h5py.string_dtype())
    assert open_log(tmp_path / "log.h5", CsvHints()).columns == ("position_2", "time")
    with pytest.raises(LogError, match="no torque channel"):
        ingest([tmp_path / "log.h5"], tmp_path / "work")


def test_huge_chunks_are_refused(tmp_path):
    """A file of a few kilobytes must not be decompressed to gigabytes at once."""
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file.create_dataset("x", (1 << 22,), "f8", chunks=(1 << 22,), compression="gzip")
    assert "more than 16 MiB; store it in smaller chunks" in refused(tmp_path / "log.h5").text


def test_damaged_files_are_refused(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        for name, values in COLUMNS.items():
            file.create_dataset(name.split(" ")[0], data=values, compression=9)
    whole = path.read_bytes()
    for length in (8, 600, len(whole) // 2, len(whole) - 50):
        path.write_bytes(whole[:length])
        assert refused(path).reason == "unreadable_file"
    middle = len(whole) // 2
    path.write_bytes(whole[:middle] + bytes(4000) + whole[middle + 4000 :])
    with pytest.raises(LogError, match="no usable log"):
        ingest([path], tmp_path / "work")
    assert not (tmp_path / "work" / "samples.parquet").exists()


def test_a_file_without_numbers_is_no_log(tmp_path):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["comment"] = "nothing"
    assert refused(tmp_path / "log.h5").reason == "not_a_log"


def test_without_the_package_the_message_says_how_to_get_it(tmp_path, monkeypatch):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["time"] = TIME
    monkeypatch.setitem(sys.modules, "h5py", None)
    assert "pip install 'frictioncli[hdf5]'" in refused(tmp_path / "log.h5").text
