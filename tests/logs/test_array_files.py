"""Arrays saved by NumPy and MATLAB give the samples that the same table gives as text."""

import zipfile

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy.io import savemat

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth


def check(path, tmp_path, *, joints=(1,)):
    _, position, velocity, torque = back_and_forth()
    summary = ingest([path], tmp_path / "work")
    assert tuple(summary.samples) == joints
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    table = table[table["joint"] == joints[0]]
    np.testing.assert_allclose(table["position"], position, atol=1e-5)
    np.testing.assert_allclose(table["velocity"], velocity, atol=1e-5)
    np.testing.assert_allclose(table["torque"], torque, atol=1e-5)
    return summary


def test_npz(tmp_path):
    time, position, velocity, torque = back_and_forth()
    path = tmp_path / "log.npz"
    np.savez(
        path,
        time=time,
        position=position,
        velocity=velocity,
        torque_feedback=torque,
        motor_id=np.array(5),
        phase_name=np.full(len(time), "hold"),
    )
    check(path, tmp_path)


@pytest.mark.parametrize("transposed", [False, True])
def test_npz_of_matrices_has_a_column_per_joint(transposed, tmp_path):
    time, position, velocity, torque = back_and_forth()
    matrices = {
        "q": np.stack([position, 0 * position + 7], axis=1),
        "qd": np.stack([velocity, 0 * velocity], axis=1),
        "tau": np.stack([torque, 0 * torque + 1], axis=1),
    }
    if transposed:
        matrices = {name: values.T for name, values in matrices.items()}
    np.savez_compressed(tmp_path / "log.npz", t=time, **matrices)
    check(tmp_path / "log.npz", tmp_path, joints=(1, 2))


def test_npy_of_a_structured_array(tmp_path):
    names = ["time", "position", "velocity", "torque"]
    rows = np.rec.fromarrays(back_and_forth(), names=names)
    np.save(tmp_path / "log.npy", np.asarray(rows))
    check(tmp_path / "log.npy", tmp_path)


@pytest.mark.parametrize("nested", [False, True])
def test_mat_before_7_3(nested, tmp_path):
    time, position, velocity, torque = back_and_forth()
    content = {"t": time, "q": position, "qd": velocity, "tau": torque[np.newaxis]}
    if nested:
        content = {"log": {f"{name}_1": values for name, values in content.items()}}
        content["log"]["t"] = content["log"].pop("t_1")
        content = {"time": time, **content["log"]}
        del content["t"]
    savemat(tmp_path / "log.mat", content | {"author": "somebody"})
    check(tmp_path / "log.mat", tmp_path)


def test_lists_of_lerobot(tmp_path):
    """One list of numbers per row, as LeRobot's Parquet files hold state, velocity and effort."""
    time, position, velocity, torque = back_and_forth()
    columns = {
        "observation.state": np.stack([position, 0 * position + 7], axis=1),
        "observation.velocity": np.stack([velocity, 0 * velocity], axis=1),
        "observation.effort": np.stack([torque, 0 * torque + 1], axis=1),
    }
    table = {name: pa.array(list(v), pa.list_(pa.float64())) for name, v in columns.items()}
    table |= {"timestamp": time, "frame_index": np.arange(len(time)), "episode_index": 0 * time}
    pq.write_table(pa.table(table), tmp_path / "episode_000000.parquet")
    check(tmp_path / "episode_000000.parquet", tmp_path, joints=(1, 2))


@pytest.mark.parametrize("restarts", [True, False])
@pytest.mark.parametrize("batch_bytes", [1 << 22, 1 << 12])
def test_episodes_of_lerobot_in_one_file_follow_each_other(restarts, batch_bytes, tmp_path):
    """Three episodes, each with a time of its own from 0, or with one that goes on."""
    time, position, _, torque = back_and_forth()
    own = time - time[0]
    length = own[-1] + 2.0
    start = np.zeros(3) if restarts else length * np.arange(3)
    state, effort = ([np.tile(values, 3)] for values in (position, torque))
    table = {
        "observation.state": pa.array(list(np.stack(state, axis=1)), pa.list_(pa.float64())),
        "observation.effort": pa.array(list(np.stack(effort, axis=1)), pa.list_(pa.float64())),
        "timestamp": (start[:, np.newaxis] + own).ravel(),
        "episode_index": np.repeat([7, 8, 9], len(time)),
    }
    pq.write_table(pa.table(table), tmp_path / "file-000.parquet")
    settings = IngestSettings(batch_bytes=batch_bytes)
    summary = ingest([tmp_path / "file-000.parquet"], tmp_path / "work", settings)
    assert summary.rows_kept == 3 * len(time)
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    pause = 1.0 if restarts else 2.0
    expected = (own + (own[-1] + pause) * np.arange(3)[:, np.newaxis]).ravel()
    np.testing.assert_allclose(samples["time"], expected, atol=1e-9)


def test_archives_that_are_no_arrays_are_named(tmp_path):
    with zipfile.ZipFile(tmp_path / "logs.zip", "w") as archive:
        archive.writestr("a.csv", "t;q\n")
    with pytest.raises(LogError, match=r"zip archive of a\.csv; unpack it"):
        ingest([tmp_path / "logs.zip"], tmp_path / "work")
    with zipfile.ZipFile(tmp_path / "book.xlsx", "w") as archive:
        archive.writestr("xl/workbook.xml", "")
    with pytest.raises(LogError, match="Excel workbook; save the log as CSV"):
        ingest([tmp_path / "book.xlsx"], tmp_path / "work")


def test_objects_are_not_loaded(tmp_path):
    np.savez(tmp_path / "log.npz", time=np.array([{"a": 1}], dtype=object))
    with pytest.raises(LogError, match="without columns of numbers"):
        ingest([tmp_path / "log.npz"], tmp_path / "work")
