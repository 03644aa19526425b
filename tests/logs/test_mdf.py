"""ASAM MDF measurements as logs."""

import json
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.errors import LogError
from frictioncli.logs.formats import open_log
from frictioncli.logs.formats.mdf_process import base_of, merged_rows, opened, signals_of
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .containers import (
    COLUMNS,
    POSITION,
    TEMPERATURE,
    TIME,
    TORQUE,
    VELOCITY,
    assert_same_as_csv,
    samples,
)

asammdf = pytest.importorskip("asammdf", reason="the optional package asammdf is not installed")


def signal(name, unit, values, times=TIME, **more):
    return asammdf.Signal(values, times, name=name, unit=unit, **more)


def saved(path, *groups, version="4.10", compression=0):
    with asammdf.MDF(version=version) as file:
        for group in groups:
            file.append(list(group))
        return file.save(path, overwrite=True, compression=compression)


def motion(keep=slice(None)):
    return [
        signal("position_2", "rad", np.radians(POSITION)[keep], TIME[keep]),
        signal("velocity_2", "rad/s", np.radians(VELOCITY)[keep], TIME[keep]),
        signal("torque_2", "Nm", TORQUE[keep], TIME[keep]),
    ]


def refused(path):
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    return found


@pytest.mark.parametrize(
    ("version", "compression"),
    [
        ("4.10", 2),
        pytest.param("4.20", 0, marks=pytest.mark.long),
        pytest.param("3.30", 0, marks=pytest.mark.long),
    ],
)
def test_a_measurement_gives_the_samples_of_the_csv(tmp_path, version, compression):
    temperature = signal("motor_temperature_2", "°C", TEMPERATURE)
    mode = signal("mode", "", np.array([b"auto"] * len(TIME)), encoding="utf-8")
    ending = "mf4" if version > "4" else "mdf"
    path = saved(
        tmp_path / f"log.{ending}",
        [*motion(), temperature, mode],
        version=version,
        compression=compression,
    )
    assert "mode" not in open_log(path, CsvHints()).columns
    assert_same_as_csv(path, tmp_path)


def test_a_slower_group_is_merged_by_zero_order_hold(tmp_path):
    slow = slice(None, None, 50)
    temperature = signal("motor_temperature_2", "°C", TEMPERATURE[slow], TIME[slow])
    path = saved(tmp_path / "log.mf4", [temperature], motion())
    assert "samples of group 2, last values of group 1" in open_log(path, CsvHints()).form
    held = {**COLUMNS, "motor_temperature_2 [°C]": np.repeat(TEMPERATURE[slow], 50)[: len(TIME)]}
    assert_same_as_csv(path, tmp_path, held)


@pytest.mark.long
def test_before_and_after_its_samples_a_group_has_no_values(tmp_path):
    """Positions from 1 s to 5 s only: rows outside have none and are counted."""
    part = (TIME >= 1.0) & (TIME <= 5.0)
    path = saved(
        tmp_path / "log.mf4",
        [signal("position_2", "deg", POSITION[part], TIME[part])],
        [signal("torque_2", "Nm", TORQUE)],
    )
    summary = ingest([path], tmp_path / "work")
    # the last position stands for one more period
    assert summary.rows_rejected == {"missing_value": len(TIME) - part.sum() - 1}


@settings(max_examples=30)
@given(
    slow=st.lists(st.floats(0, 7), min_size=2, max_size=60, unique=True).map(sorted),
    rows=st.integers(1, 600),
)
def test_zero_order_hold(tmp_path_factory, slow, rows):
    """Each row has the value of the latest slow sample that is not later than it."""
    times = np.array(slow)
    path = saved(
        tmp_path_factory.mktemp("mdf") / "log.mf4",
        [signal("torque", "Nm", TORQUE)],
        [signal("count", "", np.arange(len(times), dtype=float), times)],
    )
    with opened(path) as file:
        signals = signals_of(file)
        asked = [s for s in signals if s.name in ("torque [Nm]", "count")]
        parts = list(merged_rows(file, asked, base_of(file, signals), rows))
    assert all(len(part[0]) <= rows for part in parts)
    np.testing.assert_array_equal(np.concatenate([part[0] for part in parts]), TORQUE)
    found = np.concatenate([part[1] for part in parts])
    end = times[-1] + 1.001 * np.diff(times).max()  # the last stands as long as any did
    expected = [
        np.nan if t < times[0] or t > end else np.count_nonzero(times <= t) - 1 for t in TIME
    ]
    np.testing.assert_array_equal(found, expected)


@pytest.mark.long
def test_samples_marked_as_invalid_have_no_value(tmp_path):
    invalid = np.zeros(len(TIME), bool)
    invalid[[3, 250]] = True
    marked = signal("torque_2", "Nm", TORQUE, invalidation_bits=invalid)
    path = saved(tmp_path / "log.mf4", [signal("position_2", "deg", POSITION), marked])
    summary = ingest([path], tmp_path / "work")
    assert summary.rows_rejected == {"missing_value": 2}


@pytest.mark.long
def test_scaled_integers(tmp_path):
    """Raw counts with a linear conversion, as data loggers write them."""
    counts = np.round((POSITION + 100) / 0.01).astype(np.uint16)
    path = saved(
        tmp_path / "log.mf4",
        [
            signal("position_2", "deg", counts, conversion={"a": 0.01, "b": -100.0}),
            signal("torque_2", "Nm", TORQUE.astype(np.float32)),
        ],
    )
    np.testing.assert_allclose(
        samples(path, tmp_path / "work")["position"], counts * 0.01 - 100, atol=1e-9
    )


def test_damaged_files_are_refused(tmp_path):
    path = saved(tmp_path / "log.mf4", motion(), compression=2)
    whole = path.read_bytes()
    for length in (8, 200, len(whole) // 2):
        path.write_bytes(whole[:length])
        with pytest.raises(LogError, match="no usable log"):
            ingest([path], tmp_path / "work")
    assert not (tmp_path / "work" / "samples.parquet").exists()


@pytest.mark.slow
def test_damage_late_in_the_file_is_not_taken_as_its_end(tmp_path):
    """A late one of separately compressed blocks is damaged: the file is refused as a whole."""
    times = np.arange(400_000) * 1e-3
    with asammdf.MDF() as file:
        file.configure(write_fragment_size=1 << 19)
        file.append(
            [
                signal("position_2", "deg", 50 * np.sin(times), times),
                signal("torque_2", "Nm", np.cos(times), times),
            ]
        )
        path = file.save(tmp_path / "log.mf4", compression=1)
    whole = path.read_bytes()
    last = whole.rindex(b"##DZ")
    assert last > len(whole) / 2
    path.write_bytes(whole[: last + 100] + bytes(200) + whole[last + 300 :])
    with pytest.raises(LogError, match="cannot be read to its end as an MDF measurement"):
        ingest([path], tmp_path / "work")
    assert not (tmp_path / "work" / "samples.parquet").exists()


def test_a_measurement_without_samples_is_no_log(tmp_path):
    path = saved(tmp_path / "log.mf4")
    assert refused(path).reason == "not_a_log"


def test_without_the_package_the_message_says_how_to_get_it(tmp_path, monkeypatch):
    path = saved(tmp_path / "log.mf4", motion())
    monkeypatch.setitem(sys.modules, "asammdf", None)
    assert "pip install 'frictioncli[mdf]'" in refused(path).text


@pytest.mark.long
def test_a_block_that_names_itself_as_the_next_ends(tmp_path):
    """asammdf would follow it for ever; the process that uses it has a limit of time."""
    path = tmp_path / "log.mf4"
    saved(path, [signal("position", "deg", POSITION)])
    content = bytearray(path.read_bytes())
    group = content.index(b"##CG")
    struct.pack_into("<Q", content, group + 24, group)
    path.write_bytes(content)
    call = (
        "import frictioncli.logs.formats.mdf_process as process; process._TIME_LIMIT = 5;"
        "process.main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", call],
        input=json.dumps({"path": str(path)}).encode(),
        capture_output=True,
        cwd=Path(__file__).parents[2],
        timeout=120,
        check=False,
    )
    assert done.returncode < 0
    assert done.stdout == b""
