"""The parser of plain numbers agrees with Python bit for bit, or leaves the text to pyarrow."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictioncli.logs.formats import plain_numbers
from frictioncli.logs.formats.delimited import read_delimited
from frictioncli.logs.formats.plain_numbers import line_feeds, plain_columns
from frictioncli.logs.log_source import CsvHints
from tests.compiler import has_compiler

CELL = re.compile(r"(-?\d+([.,]\d*)?([eE][+-]?\d+)?)?")

built = pytest.mark.skipif(
    plain_numbers._plain_numbers is None, reason="installed without a C compiler"
)


def parsed(rows, *, wanted=(0, 1), fields=2, delimiter=";", decimal=".", end="\n"):
    content = "".join(row + end for row in rows).encode("latin-1")
    return plain_columns(content, delimiter, decimal, fields, list(wanted), len(rows))


def bits(values):
    return np.asarray(values, float).view(np.int64).tolist()


@pytest.mark.skipif(not has_compiler(), reason="no C compiler")
def test_the_parser_is_built_where_there_is_a_compiler():
    assert plain_numbers._plain_numbers is not None


@built
@given(
    st.lists(
        st.tuples(*[st.decimals(-999_999_999, 999_999_999, places=6) for _ in range(3)]),
        min_size=1,
        max_size=20,
    ),
    st.sampled_from([";", "\t", ",", " "]),
    st.sampled_from([".", ","]),
    st.sampled_from(["\n", "\r\n"]),
)
def test_every_number_of_a_log_is_the_nearest_double(numbers, delimiter, decimal, end):
    if delimiter == decimal:
        delimiter = ";"
    rows = [delimiter.join(f"{n:f}".replace(".", decimal) for n in row) for row in numbers]
    found = parsed(rows, wanted=(0, 2), fields=3, delimiter=delimiter, decimal=decimal, end=end)
    assert found is not None
    for column, of_row in zip(found, (0, 2), strict=True):
        assert bits(column) == bits([float(row[of_row]) for row in numbers])


@built
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(["r", ".6g", ".12e"]))
def test_any_float_is_the_nearest_double_or_left_to_pyarrow(value, form):
    text = repr(value) if form == "r" else f"{value:{form}}"
    found = parsed([f"{text};{text}"])
    assert found is None or bits(found) == bits([[float(text)], [float(text)]])


@built
@given(st.text("0123456789-+.,;eE \"'xn\r\n\0\xb0", max_size=40), st.sampled_from([".", ","]))
def test_any_text_is_understood_as_python_does_or_left_to_pyarrow(text, decimal):
    lines = text.removesuffix("\n").split("\n")
    found = plain_columns(text.encode("latin-1"), ";", decimal, 2, [0, 1], len(lines))
    if found is None:
        return
    for row, line in enumerate(lines):
        cells = line.removesuffix("\r").split(";")
        assert len(cells) == 2
        for cell, value in zip(cells, found[:, row], strict=True):
            assert CELL.fullmatch(cell)
            assert bits(value) == bits(float(cell.replace(decimal, ".")) if cell else np.nan)


@built
@pytest.mark.parametrize(
    ("first", "value"),
    [
        ("-0", -0.0),
        ("007", 7.0),
        ("5.", 5.0),
        ("9007199254740992", 2.0**53),
        ("1e18", 1e18),
        ("-2.5E-3", -0.0025),
        ("0.000000000000000001", 1e-18),
    ],
)
def test_limits_of_what_is_plain(first, value):
    assert bits(parsed([f"{first};1"])) == bits([[value], [1.0]])


@built
@pytest.mark.parametrize(
    "first",
    [
        "9007199254740993",  # 2^53 + 1, a tie between two doubles
        "1e23",  # 10^23 is no double
        "12345678901234567890",  # does not fit into 64 bits
        "1e99999999999999999999",
        *("+1", ".5", "-", "--1", "1e", "1e+", "1.2.3", "1 ", " 1", "nan", "inf", "0x1", '"1"'),
    ],
)
def test_what_is_not_plain_is_left_to_pyarrow(first):
    assert parsed([f"{first};1", "2;3"]) is None
    assert parsed(["2;3", f"{first};1"]) is None


@built
@pytest.mark.parametrize("damage", ["1", "1;2;3", "", "1;2\r3;4", "1;2\0", "1,5;2"])
def test_a_damaged_row_is_left_to_pyarrow(damage):
    assert parsed(["1;2", damage, "3;4"]) is None


@built
def test_skipped_columns_may_hold_words_but_no_quotes():
    assert parsed(["1;now", "2;"], wanted=[0]).tolist() == [[1.0, 2.0]]
    assert parsed(['1;"now;3"', "2;"], wanted=[0]) is None


@built
def test_the_number_of_rows_must_be_right():
    assert plain_columns(b"1;2\n3;4", ";", ".", 2, [0], 2).tolist() == [[1.0, 3.0]]
    assert plain_columns(b"1;2\n3;4\n", ";", ".", 2, [0], 1) is None
    assert plain_columns(b"1;2\n3;4\n", ";", ".", 2, [0], 3) is None


DAMAGES = {
    "none": [],
    "word": ["0,5;oops;3,0;4,0"],
    "missing": ["0,5;;3,0;nan"],
    "quoted": ['0,5;"2,0";3,0;4,0'],
    "short": ["0,5;2,0"],
    "blank": [""],
    "infinite": ["0,5;9,9e34;3,0;inf"],
}


@built
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_log_gives_the_same_rows_without_the_parser(tmp_path, monkeypatch, damage):
    rows = [f"{i / 100:.3f};{-i};{i / 7:.9f};{i}e-2".replace(".", ",") for i in range(90)]
    lines = ["Zeit [s];AxisPos_Act2 [°];AxisVel_Act2 [°/s];GearTorq_Act2 [Nm]", *rows[:50]]
    path = tmp_path / "log.csv"
    path.write_text("\n".join([*lines, *DAMAGES[damage], *rows[50:]]) + "\n", "utf-8")

    def batches():
        source = read_delimited(path, path.read_bytes(), CsvHints())
        return list(source.batches([0, 1, 3], 1 << 9))

    with_parser = batches()
    monkeypatch.setattr(plain_numbers, "_plain_numbers", None)
    without = batches()
    for one, other in zip(with_parser, without, strict=True):
        assert one.lines.tolist() == other.lines.tolist()
        assert one.bad_lines.tolist() == other.bad_lines.tolist()
        assert one.bad_reasons == other.bad_reasons
        assert {k: bits(v) for k, v in one.values.items()} == {
            k: bits(v) for k, v in other.values.items()
        }


@given(st.binary(max_size=2000), st.integers(0, 600))
def test_line_feeds_are_counted(content, more):
    content += b"\n" * more
    assert line_feeds(content) == sum(byte == 10 for byte in content)


@built
@pytest.mark.parametrize("text", ["9.9e34", "1e19", "-9007199254740992e19", "1e-23"])
def test_numbers_larger_than_any_measurement_are_left_to_pyarrow(text):
    assert parsed([f"{text};1"]) is None


@built
@pytest.mark.parametrize("text", ["9007199254740992e18", "-1e18", "1e-22"])
def test_the_largest_powers_are_parsed(text):
    assert bits(parsed([f"{text};1"])[0]) == bits([float(text)])
