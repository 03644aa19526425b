"""The mapping file names columns, units and the joint where detection fails."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import MappingError
from frictioncli.logs.channels.channel_map import read_map
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import back_and_forth, kuka_columns, write

MAP = """
[channels]
time = "Uhr"
position = "Winkel-Wert"
torque = "M"
[units]
time = "ms"
position = "rad"
torque = "mNm"
[joint]
number = 4
"""


def write_map(tmp_path, text):
    path = tmp_path / "channels.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_map_names_columns_units_and_joint(tmp_path):
    time, position, _, torque = back_and_forth()
    columns = {
        "Uhr": time * 1000,
        "Winkel-Wert [bogus]": np.radians(position),
        "M": torque * 1000,
        "torque_1": torque * 0,
    }
    log = write(tmp_path / "log.csv", columns, digits=12)
    ingest([log], tmp_path / "work", IngestSettings(map_file=write_map(tmp_path, MAP)))
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    assert set(table["joint"]) == {4}
    np.testing.assert_allclose(table["time"], time, atol=1e-9)
    np.testing.assert_allclose(table["position"], position, atol=1e-9)
    np.testing.assert_allclose(table["torque"], torque, atol=1e-9)
    assert "channels.toml" in tables.metadata(tmp_path / "work" / "samples.parquet")["inputs"]


def test_a_mapped_column_that_is_missing(tmp_path):
    log = write(tmp_path / "log.csv", kuka_columns())
    channel_map = write_map(tmp_path, '[channels]\ntorque = "GearTorque_Act2"\nposition = "X"\n')
    with pytest.raises(MappingError, match=r"no column 'GearTorque_Act2'.*close: GearTorq_Act2"):
        ingest([log], tmp_path / "work", IngestSettings(map_file=channel_map))
    assert not (tmp_path / "work").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[channels\n", "cannot be read as a mapping file"),
        ("[chanels]\n", "unknown section: chanels.*did you mean channels"),
        ('[channels]\npositon = "a"\n', "unknown name in .channels.: positon.*position"),
        ("[channels]\nposition = 3\n", "expected a column name"),
        ('[units]\nposition = "furlong"\n', "'furlong'; expected one of deg, rad, udeg"),
        ('[units]\ntorque = "%"\n', "expected one of N·m"),
        ('[csv]\ndelimiter = "x"\n', "delimiter = 'x'"),
        ('[csv]\ndecimal = "."\nencodng = "utf-8"\n', "encodng.*did you mean encoding"),
        ('[csv]\nencoding = "klingon"\n', "'klingon'"),
        ("[joint]\nnumber = 0\n", "number = 0"),
        ("[joint]\ngear_ratio = 0\n", "gear_ratio = 0"),
        ("channels = 3\n", "expected a section"),
    ],
)
def test_a_bad_map_says_where_and_what(tmp_path, text, message):
    with pytest.raises(MappingError, match=message) as caught:
        read_map(write_map(tmp_path, text))
    assert "channels.toml" in str(caught.value)


def test_a_missing_map(tmp_path):
    with pytest.raises(MappingError, match=r"nothing\.toml"):
        read_map(tmp_path / "nothing.toml")
