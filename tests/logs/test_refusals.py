"""A refusal says what to do with the file."""

import json

import numpy as np
import pytest

from frictioncli.errors import LogError
from frictioncli.inspection.inspect import inspect
from frictioncli.logs.formats import open_log
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.logs.log_source import CsvHints, Refusal
from tests.command_line import invoke


def refused(path, text):
    path.write_text(text)
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    return found.text


@pytest.mark.parametrize(
    ("document", "told"),
    [
        ({"mass": 0.5, "entries": [{"position": 1.0}]}, "write its list 'entries' as a CSV table"),
        ([{"position": 1.0}], "write its list of records as a CSV table"),
        ({"q": [1.0, 2.0]}, "write its rows as a CSV table"),
    ],
)
@pytest.mark.parametrize("indent", [None, 2])
def test_json(tmp_path, document, told, indent):
    text = refused(tmp_path / "log.json", json.dumps(document, indent=indent))
    if indent is None or not isinstance(document, list):
        assert told in text
        assert "a header line and a column for each quantity" in text


@pytest.mark.parametrize("form", ["{:.6f}", "{:.3e}", "{:+.2f}"])
def test_one_number_per_line(tmp_path, form):
    text = refused(tmp_path / "q.txt", "\n".join(map(form.format, np.linspace(0, 1, 50))))
    assert text.startswith("one number per line; expected a table: join the files")


def test_files_of_one_number_per_line_share_a_remark(tmp_path):
    for name in ("q", "dq", "tau", "t", "temperature"):
        (tmp_path / f"{name}.txt").write_text("\n".join(map(str, range(50))))
    told = " ".join(invoke("inspect", tmp_path).stdout.split())
    assert told.count("one number per line") == 1
    assert "one_column" not in told


def test_files_refused_for_many_reasons_are_named(tmp_path):
    for number in range(6):
        width = number + 4
        (tmp_path / f"log{number}.csv").write_text("a,b,c\n" + (",".join("1" * width) + "\n") * 9)
    told = " ".join(invoke("inspect", tmp_path).stdout.split())
    assert "log3.csv, log4.csv and log5.csv: for similar reasons, see --json" in told


def test_pairs_of_x_and_y_have_the_names_above(tmp_path):
    rows = [
        "Torque [0x1],,Position [0x2],",
        "X,Y,X,Y",
        *(f"{i},{i % 3},{i},{i % 5}" for i in range(9)),
    ]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    source = open_log(tmp_path / "log.csv", CsvHints())
    assert source.columns == ("X", "Torque [0x1]", "", "Position [0x2]")
    batch = next(source.batches([1, 3], 1000))
    np.testing.assert_array_equal(batch.values[1], np.arange(9) % 3)


def test_a_cell_that_is_no_number_is_named(tmp_path):
    rows = ["time [s];position [deg];torque [Nm]"]
    rows += [f"{i / 100:.2f};{i};1,5".replace(".", ",") for i in range(90)]
    rows[2:] = [row.replace("1,5", "1.234,5") for row in rows[2:]]
    (tmp_path / "log.csv").write_text("\n".join(rows))
    (file,) = inspect([tmp_path / "log.csv"]).files
    assert "line 3" in file.refusal
    assert "torque [Nm] is '1.234,5'; expected a number with decimal comma" in file.refusal


def test_a_log_with_an_added_column_names_its_damaged_cells(tmp_path):
    """The position that is integrated, and the time that a period gives, stand in no cell."""
    (tmp_path / "log.csv").write_text("velocity [deg/s],torque [Nm]\n" + "1.0,1.2.3\n" * 40)
    chart = tmp_path / "map.toml"
    chart.write_text("[csv]\nperiod = 0.01\n", encoding="utf-8")
    with pytest.raises(LogError, match=r"line 2: 1\.0,1\.2\.3: torque .* expected a number"):
        ingest([tmp_path / "log.csv"], tmp_path / "work", IngestSettings(map_file=chart))


def test_rows_without_a_time_are_told_to_give_the_period(tmp_path):
    (tmp_path / "log.csv").write_text("q,tau\n" + "1.0,2.0\n2.0,3.0\n" * 20)
    (file,) = inspect([tmp_path / "log.csv"]).files
    assert "[csv] period = 0.005" in file.refusal
