"""Text exports of TwinCAT Scope, in the forms that its options give."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.logs.ingest import ingest

from .logs import back_and_forth

START = 132_000_000_000_000_000


def export(*, timelines, delimiter, decimal, full_time=False, full_head=True, eof=True):
    """Return the text of an export of a joint's position, velocity and torque."""
    time, position, velocity, torque = back_and_forth()
    names = ["Axes.Axis 2.ActPos", "Axes.Axis 2.ActVelo", "Axes.Axis 2.ActTorque"]
    units = ["°", "°/s", "Nm"]
    clock = START + np.round(1e7 * time) if full_time else 1000 * time
    digits = ".0f" if full_time else ".6f"

    def row(key, values):
        cells = [key]
        for number, value in enumerate(values):
            cells += [key, value] if timelines == "all" and number else [value]
        return delimiter.join(cells)

    head = ["Name\tYT Scope Project", "File\tC:\\scope.svdx"]
    head += [f"Starttime of export\t{START}", f"Endtime of export\t{START + 60_000_000}", ""]
    lines = [line.replace("\t", delimiter) for line in head]
    lines.append(row("Name", names))
    if full_head:
        for key, values in (
            ("SymbolComment", ["", "", ""]),
            ("Data-Type", ["REAL64"] * 3),
            ("SampleTime[ms]", ["12", "12", "12"]),
            ("ScaleFactor", ["1", "1", "1"]),
            ("Unit", units),
        ):
            lines.append(row(key, values))
    lines.append("")
    for t, *values in zip(clock, position, velocity, torque, strict=True):
        text = [f"{value:.9f}" for value in values]
        lines.append(row(format(t, digits), text).replace(".", decimal))
    return "\r\n".join([*lines, *(["EOF"] if eof else [])])


@pytest.mark.parametrize("full_time", [False, True])
@pytest.mark.parametrize("full_head", [False, True])
@pytest.mark.parametrize("timelines", ["all", "each"])
@pytest.mark.parametrize(("delimiter", "decimal"), [("\t", ","), (";", ","), (",", ".")])
def test_an_export_gives_the_samples(delimiter, decimal, timelines, full_head, full_time, tmp_path):
    text = export(
        timelines=timelines,
        delimiter=delimiter,
        decimal=decimal,
        full_time=full_time,
        full_head=full_head,
    )
    (tmp_path / "scope.csv").write_text(text, encoding="utf-8")
    summary = ingest([tmp_path / "scope.csv"], tmp_path / "work")
    assert summary.rows_rejected == {"wrong_field_count": 1}  # EOF
    assert summary.time_known
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    time, position, velocity, torque = back_and_forth()
    assert set(table["joint"]) == {2}
    np.testing.assert_allclose(table["time"], time, atol=1e-5)
    for name, values in (("position", position), ("velocity", velocity), ("torque", torque)):
        np.testing.assert_allclose(table[name], values, atol=1e-8)


def test_channels_of_another_period_are_left_out(tmp_path):
    """Their values stand in rows of other times."""
    text = export(timelines="all", delimiter="\t", decimal=",", eof=False)
    lines = text.split("\r\n")
    at = next(i for i, line in enumerate(lines) if line.startswith("SampleTime"))
    lines[at] = "SampleTime[ms]\t12\tSampleTime[ms]\t48\tSampleTime[ms]\t12"
    (tmp_path / "scope.csv").write_text("\n".join(lines), encoding="utf-8")
    summary = ingest([tmp_path / "scope.csv"], tmp_path / "work")
    assert any("no velocity channel" in note for note in summary.notes)


@pytest.mark.parametrize(
    "parts", [lambda row: [row[:9], row[9:]], lambda row: [f"# {row}"], lambda row: [f'"{row}']]
)
def test_a_first_row_that_is_damaged_is_counted(parts, tmp_path):
    lines = export(timelines="all", delimiter="\t", decimal=",").split("\r\n")
    at = lines.index("", 6) + 1
    damaged = parts(lines[at])
    lines[at : at + 1] = damaged
    (tmp_path / "scope.csv").write_text("\r\n".join(lines), encoding="utf-8")
    summary = ingest([tmp_path / "scope.csv"], tmp_path / "work")
    assert summary.rows_read == len(back_and_forth()[0]) + len(damaged)  # and EOF
    assert summary.rows_kept == len(back_and_forth()[0]) - 1
