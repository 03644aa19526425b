"""Small recordings of every binary container that is read with an optional package."""

import functools
import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from pyarrow import feather
from scipy.io import savemat

from tests.studies.fuzz_layout import POSITION, TIME, TORQUE, VELOCITY

COLUMNS = {"time": TIME, "position_2": POSITION, "velocity_2": VELOCITY, "torque_2": TORQUE}

Columns = Mapping[str, NDArray[np.float64]]


def _npy(path: Path, columns: Columns) -> None:
    np.save(path, np.rec.fromarrays(list(columns.values()), names=list(columns)))


def _hdf5(path: Path, columns: Columns) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        for name, values in columns.items():
            file.create_dataset(f"run/{name}", data=values, chunks=True, compression=4)


def _csv(path: Path, columns: Columns) -> None:
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    lines = [";".join(columns), *(";".join(map(repr, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


_TYPE = "sensor_msgs/msg/JointState"


def _ros(path: Path, columns: Columns) -> None:
    """Write a message per row; a time that is no time of ROS becomes the nearest that is one."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    if path.suffix == ".bag":
        store, folder, writer = get_typestore(Stores.ROS1_NOETIC), path, Writer1(path)
    else:
        plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
        store, folder = get_typestore(Stores.ROS2_HUMBLE), path.with_suffix("")
        writer = Writer(folder, version=9, storage_plugin=plugin)
    stamps = np.clip(np.nan_to_num(columns["time"]), 0.0, 2.0e9)
    serialize = store.serialize_ros1 if path.suffix == ".bag" else store.serialize_cdr
    types = store.types
    with writer:
        connection = writer.add_connection("/joint_states", _TYPE, typestore=store)
        for number, seconds in enumerate(stamps.tolist()):
            second, nanosecond = divmod(round(seconds * 1e9), 10**9)
            stamp = types["builtin_interfaces/msg/Time"](sec=second, nanosec=nanosecond)
            header = {"stamp": stamp, "frame_id": ""}
            if path.suffix == ".bag":
                header["seq"] = number
            values = (
                np.array([columns[f"{name}_2"][number]])
                for name in ("position", "velocity", "torque")
            )
            names = ("position", "velocity", "effort")
            message = types[_TYPE](
                header=types["std_msgs/msg/Header"](**header),
                name=["joint_2"],
                **dict(zip(names, values, strict=True)),
            )
            writer.write(connection, 10**9 + number * 10**7, serialize(message, _TYPE))
    if folder != path:
        (folder / f"{folder.name}{path.suffix}").rename(path)
        shutil.rmtree(folder)


def _mdf(path: Path, columns: Columns) -> None:
    import asammdf

    names = [name for name in columns if name != "time"]
    with asammdf.MDF(version="4.10") as file:
        signals = [asammdf.Signal(columns[name], columns["time"], name=name) for name in names]
        # otherwise asammdf leaves out rows whose times are repeated
        file.append(signals, common_timebase=True)
        file.save(path, overwrite=True)


WRITERS: dict[str, Callable[[Path, Columns], None]] = {
    "log.csv": _csv,
    "log.parquet": lambda path, columns: pq.write_table(pa.table(dict(columns)), path),
    "log.feather": lambda path, columns: feather.write_feather(pa.table(dict(columns)), path),
    "log.h5": _hdf5,
    "log.npy": _npy,
    "log.npz": lambda path, columns: np.savez(path, **columns),
    "log.mat": lambda path, columns: savemat(path, dict(columns)),
    "log.mcap": _ros,
    "log.db3": _ros,
    "log.bag": _ros,
    "log.mf4": _mdf,
}
"""File name -> writer of a table."""


_PACKED = "packed.mcap"

RECORDINGS = (*sorted(WRITERS), _PACKED)
"""Names of the recordings that are damaged byte by byte."""


@functools.cache
def recording(name: str) -> bytes:
    """Return the content of a recording that is read."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        if name == _PACKED:
            from tests.logs.test_ros import recorded, states

            path = recorded(Path(folder), "mcap", {"/joint_states": states()}, packed=True)
        else:
            WRITERS[name](path, COLUMNS)
        return path.read_bytes()
