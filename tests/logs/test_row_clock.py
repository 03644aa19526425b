"""The time of a log without a column of time follows from a period that the map gives."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import MappingError
from frictioncli.logs.channels.channel_map import read_map
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import PERIOD, back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
MAP = """
[channels]
position = 1
velocity = 2
torque = "3"
[units]
position = "rad"
[csv]
period = {}
"""


def written(path, header=(), damaged=()):
    rows = [
        f"{p:.9f},{v:.9f},{u}"
        for p, v, u in zip(np.radians(POSITION), VELOCITY, TORQUE, strict=True)
    ]
    for row in damaged:
        rows[row] = "torn"
    path.write_text("\n".join([*header, *rows]) + "\n")
    return path


def mapped(folder, period=PERIOD):
    path = folder / "map.toml"
    path.write_text(MAP.format(period))
    return path


@pytest.mark.parametrize("header", [(), ("q,dq,tau",)])
@pytest.mark.parametrize("size", [1000, 1 << 22])
def test_the_time_is_the_number_of_the_row_times_the_period(tmp_path, header, size):
    settings = IngestSettings(map_file=mapped(tmp_path), batch_bytes=size)
    folder = tmp_path / "logs"
    folder.mkdir()
    written(folder / "a.csv", header)
    written(folder / "b.csv", header, damaged=(70, 71, 300))
    summary = ingest([folder], tmp_path / "work", settings)
    assert summary.rows_read == 2 * len(TIME)
    assert summary.rows_rejected == {"wrong_field_count": 3}
    samples = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    for name, kept in (("a", TIME), ("b", np.delete(TIME, [70, 71, 300]))):
        found = samples[samples["recording"].str.startswith(name)]
        np.testing.assert_allclose(found["time"] - found["time"].iloc[0], kept, atol=1e-9)


@pytest.mark.parametrize(
    "period", ["0", "-0.1", "nan", "inf", "1e300", "9" * 400, '"5 ms"', "true"]
)
def test_a_period_that_is_none(tmp_path, period):
    with pytest.raises(
        MappingError, match=r"\[csv\] period = .*; expected the time from row to row"
    ):
        read_map(mapped(tmp_path, period))


def test_a_number_beyond_the_columns_is_not_the_time_that_is_made(tmp_path):
    log = tmp_path / "log.csv"
    log.write_text("".join(f"{p:.6f},{u}\n" for p, u in zip(POSITION, TORQUE, strict=True)))
    with pytest.raises(MappingError, match=r"names column '3' as torque, but that is the time"):
        ingest([log], tmp_path / "work", IngestSettings(map_file=mapped(tmp_path)))
