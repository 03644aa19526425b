"""Small recordings of every binary container that is read with an optional package."""

import functools
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from pyarrow import feather
from scipy.io import savemat

from tests.studies.fuzz_layouts import POSITION, TIME, TORQUE, VELOCITY

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


WRITERS: dict[str, Callable[[Path, Columns], None]] = {
    "log.csv": _csv,
    "log.parquet": lambda path, columns: pq.write_table(pa.table(dict(columns)), path),
    "log.feather": lambda path, columns: feather.write_feather(pa.table(dict(columns)), path),
    "log.h5": _hdf5,
    "log.npy": _npy,
    "log.npz": lambda path, columns: np.savez(path, **columns),
    "log.mat": lambda path, columns: savemat(path, dict(columns)),
}
"""File name -> writer of a table."""


@functools.cache
def recordings() -> dict[str, bytes]:
    """Return file name -> content of a recording that is read."""
    from tests.logs.test_ros import recorded, states

    found = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kind in ("mcap", "db3", "bag"):
            path = recorded(folder, kind, {"/joint_states": states()})
            found[f"log.{kind}"] = path.read_bytes()
        path = recorded(folder, "mcap", {"/joint_states": states()}, packed=True)
        found["packed.mcap"] = path.read_bytes()
        for name, write in WRITERS.items():
            write(folder / name, COLUMNS)
            found[name] = (folder / name).read_bytes()
    return found
