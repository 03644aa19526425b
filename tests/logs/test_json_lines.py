"""Logs with a JSON object in each line."""

import gzip
import json

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.formats import open_log
from frictioncli.logs.formats.json_lines import JsonLines
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints

from .logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()


def flat(t, q, v, u):
    return {"t": t, "q_deg": q, "qd_deg_s": v, "tau_Nm": u, "mode": "auto"}


def lists(t, q, v, u):
    """A message of joint states; the second joint moves."""
    state = {"position": [0.1, np.radians(q)], "velocity": [0, np.radians(v)], "effort": [1, u]}
    return {"timestamp": t, "name": ["a", "b"], **state}


def objects(t, q, v, u):
    joint = {"position_deg": q, "velocity_deg_s": v, "torque_Nm": u, "ok": True}
    return {"stamp": t, "joints": [joint, joint]}


def dated(t, q, v, u):
    when = np.datetime64("2024-05-17T09:30:00", "us") + round(t * 1e6)
    return {"time": f"{when}Z", "q_deg": q, "qd_deg_s": v, "tau_Nm": u}


def log_lines(form):
    return [json.dumps(form(*row)) for row in np.stack(back_and_forth(), axis=1).tolist()]


@pytest.mark.parametrize(("form", "joint"), [(flat, 1), (lists, 2), (objects, 2), (dated, 1)])
def test_values_are_those_of_the_objects(form, joint, tmp_path):
    (tmp_path / "log.jsonl").write_text("\n".join(log_lines(form)) + "\n")
    ingest([tmp_path / "log.jsonl"], tmp_path / "work")
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    own = table[table["joint"] == joint]
    for name, expected in (("time", TIME), ("position", POSITION), ("torque", TORQUE)):
        np.testing.assert_allclose(own[name], expected, atol=1e-5)
    np.testing.assert_allclose(own["velocity"], VELOCITY, atol=1e-5)


def test_each_row_is_kept_or_rejected(tmp_path):
    lines = log_lines(flat)
    lines[5] = lines[5][:20]
    lines[6] = "[" * 100_000
    lines[7] = '{"t": "yesterday", "q_deg": 1, "tau_Nm": 1}'
    lines[8] = json.dumps({"q_deg": 1.0})  # no time
    lines[9] = '{"t": 0.1, "q_deg": ' + "9" * 5_000 + "}"
    (tmp_path / "log.jsonl.gz").write_bytes(gzip.compress("\n".join(lines).encode()))
    summary = ingest([tmp_path / "log.jsonl.gz"], tmp_path / "work")
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert rejected["row"].tolist() == [6, 7, 8, 9, 10]
    assert summary.rows_read == len(lines)


def test_names_of_members(tmp_path):
    row = {"a": {"q": [1, 2]}, "joints": [{"q": 1}, {"q": 2}], "text": "x", "none": None}
    (tmp_path / "log").write_text(f"{json.dumps(row)}\n" * 3)
    log = open_log(tmp_path / "log", CsvHints())
    assert isinstance(log, JsonLines)
    assert log.columns == ("a.q_0", "a.q_1", "joint_0.q", "joint_1.q")


def test_objects_of_settings_are_no_log(tmp_path):
    (tmp_path / "settings.jsonl").write_text('{"a": 1}\n{"b": 2}\n')
    with pytest.raises(LogError, match="no time and no position and no torque channel"):
        ingest([tmp_path / "settings.jsonl"], tmp_path / "work")


def test_an_object_of_a_million_numbers_is_no_sample(tmp_path):
    (tmp_path / "log.jsonl").write_text('{"t": [' + "1," * 1_000_000 + "1]}\n" + '{"t": 1}\n' * 30)
    with pytest.raises(LogError, match="objects of more than 10000 numbers"):
        ingest([tmp_path / "log.jsonl"], tmp_path / "work")
