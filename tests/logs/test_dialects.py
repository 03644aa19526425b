"""The same table gives the same samples in every dialect."""

import gzip
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.ingest import IngestSettings, ingest

from .logs import kuka_columns, text_of, write

NUMBERS = ["time", "position", "velocity", "torque"]


def samples(work):
    return tables.read(work / "samples.parquet", schemas.SAMPLES)


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain")
    write(folder / "run" / "log.csv", kuka_columns())
    ingest([folder / "run"], folder / "work")
    return samples(folder / "work")[NUMBERS].to_numpy()


def test_plain_log_gives_what_was_written(expected):
    columns = kuka_columns()
    np.testing.assert_allclose(expected, np.stack(list(columns.values()), axis=1), atol=1e-8)


FORMS = st.fixed_dictionaries(
    {
        "delimiter": st.sampled_from([";", "\t", ",", " "]),
        "decimal": st.sampled_from([".", ","]),
        "encoding": st.sampled_from(
            ["utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le", "utf-16-be"]
        ),
        "newline": st.sampled_from(["\n", "\r\n", "\r"]),
        "names": st.sampled_from(["german", "english", "broken"]),
        "blank_lines": st.booleans(),
        "trailing": st.booleans(),
        "position_in_rad": st.booleans(),
        "velocity_in_rad": st.booleans(),
        "time_in_ms": st.booleans(),
    }
)
NAMES = {
    "german": ("Zeit [{t}]", "AxisPos_Act2 [{p}]", "AxisVel_Act2 [{v}]", "GearTorq_Act2 [Nm]"),
    "english": ("time ({t})", "q_2 ({p})", "qd_2 ({v})", "torque_2 (N·m)"),
    "broken": ("Zeit[{t}]", "AxisPos_Act2[{p}]", "AxisVel_Act2[{v}]", "GearTorq_Act2[Nm]"),
}


@settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])
@given(form=FORMS)
def test_any_form_gives_the_same_samples(form, expected):
    if form["delimiter"] == "," and form["decimal"] == ",":
        form["decimal"] = "."
    time, position, velocity, torque = kuka_columns().values()
    broken = form["names"] == "broken"
    degree = "ï¿½" if broken else "°"
    unit = {"t": "s", "p": degree, "v": f"{degree}/s"}
    if form["position_in_rad"]:
        position = np.radians(position)
        unit["p"] = "rad"
    if form["velocity_in_rad"]:
        velocity = np.radians(velocity)
        unit["v"] = "rad/s"
    if form["time_in_ms"]:
        time = time * 1000
        unit["t"] = "ms"
    names = [name.format(**unit) for name in NAMES[form["names"]]]
    if form["delimiter"] == " ":
        names = [name.replace(" ", "") for name in names]
    text = text_of(
        dict(zip(names, (time, position, velocity, torque), strict=True)),
        delimiter=form["delimiter"],
        decimal=form["decimal"],
        newline="\n",
        digits=12,
    )
    if form["trailing"] and form["delimiter"] != " ":
        text = text.replace("\n", form["delimiter"] + "\n")
    if form["blank_lines"]:
        text = text.replace("\n", "\n\n")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "run").mkdir()
        content = text.replace("\n", form["newline"]).encode(form["encoding"], "replace")
        (folder / "run" / "log.csv").write_bytes(content)
        summary = ingest([folder / "run"], folder / "work")
        found = samples(folder / "work")[NUMBERS].to_numpy()
    assert summary.rows_read == summary.rows_kept == len(expected)
    np.testing.assert_allclose(found, expected, atol=2e-8)


def test_utf16_tab_decimal_comma_is_bit_identical(tmp_path, expected):
    write(
        tmp_path / "run" / "log.asc",
        kuka_columns(),
        encoding="utf-16",
        delimiter="\t",
        decimal=",",
        newline="\r\n",
    )
    ingest([tmp_path / "run"], tmp_path / "work")
    np.testing.assert_array_equal(samples(tmp_path / "work")[NUMBERS].to_numpy(), expected)


def test_batch_size_does_not_matter(tmp_path):
    columns = kuka_columns()
    del columns["AxisVel_Act2[°/s]"]
    log = write(tmp_path / "run" / "log.csv", columns)
    found = []
    for size in (97, 1000, 1 << 22):
        ingest([log], tmp_path / str(size), IngestSettings(batch_bytes=size))
        found.append(samples(tmp_path / str(size))[NUMBERS].to_numpy())
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_gzip_is_read(tmp_path, expected):
    (tmp_path / "run").mkdir()
    with gzip.open(tmp_path / "run" / "log.csv.gz", "wb") as stream:
        stream.write(text_of(kuka_columns()).encode())
    ingest([tmp_path / "run"], tmp_path / "work")
    table = samples(tmp_path / "work")
    np.testing.assert_array_equal(table[NUMBERS].to_numpy(), expected)
    assert set(table["recording"]) == {"log"}


def test_units_in_a_line_of_their_own(tmp_path, expected):
    names = ["Zeit", "AxisPos_Act2", "AxisVel_Act2", "GearTorq_Act2"]
    lines = text_of(dict(zip(names, kuka_columns().values(), strict=True))).split("\n")
    lines.insert(1, "s;rad;°/s;Nm")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    np.testing.assert_array_equal(samples(tmp_path / "work")[NUMBERS].to_numpy(), expected)
    assert any("says rad" in note and "read as deg" in note for note in summary.notes)


def test_iso_times_with_decimal_comma(tmp_path):
    time, position, _, torque = kuka_columns().values()
    rows = ["Timestamp;position [deg];torque [Nm];"]
    for t, p, u in zip(time, position, torque, strict=True):
        stamp = f"2022-10-26T08:17:{20 + t:09.6f}Z"
        rows.append(f"{stamp};{p:.6f};{u:.3f};".replace(".", ","))
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "log.csv").write_text("\n".join(rows))
    ingest([tmp_path / "run"], tmp_path / "work")
    table = samples(tmp_path / "work")
    np.testing.assert_allclose(table["time"], time, atol=1e-6)
    recordings = tables.read(tmp_path / "work" / "recordings.parquet", schemas.RECORDINGS)
    assert recordings["started_at"][0].startswith("2022-10-26T08:17:20")


def test_a_date_of_the_year_1_is_a_time_like_others(tmp_path):
    """A damaged cell, or a clock that was never set: nanoseconds would overflow."""
    rows = ["Timestamp;position [deg];torque [Nm]", "0001-01-01T00:00:00Z;0.0;0.0"]
    rows += [f"2022-10-26T08:17:{20 + n / 10:04.1f}Z;{n / 10:.1f};{n % 7}.5" for n in range(300)]
    (tmp_path / "log.csv").write_text("\n".join(rows))
    summary = ingest([tmp_path / "log.csv"], tmp_path / "work")
    assert summary.rows_read == 301
    assert summary.rows_kept + sum(summary.rows_rejected.values()) == 301


def test_short_logs_that_share_a_task_give_the_same_samples(tmp_path):
    """One log has a damaged row, one is truncated, one compressed: each keeps its rows."""
    text = text_of(kuka_columns(seconds=1.5))
    lines = text.splitlines()
    lines[20] = "torn"
    texts = {"a": text, "b": "\n".join(lines), "d": text.replace("-4", "-3")}
    (tmp_path / "logs").mkdir()
    for name, content in texts.items():
        (tmp_path / "logs" / f"{name}.csv").write_text(content)
    packed = gzip.compress(text.encode())
    (tmp_path / "logs" / "c.csv").write_bytes(packed[: len(packed) // 2])
    (tmp_path / "logs" / "e.csv").write_bytes(packed)
    summary = ingest([tmp_path / "logs"], tmp_path / "together")
    assert [file.file for file in summary.files_rejected] == ["c.csv"]
    assert summary.rows_rejected == {"wrong_field_count": 1}
    together = samples(tmp_path / "together")
    assert list(dict.fromkeys(together["recording"])) == ["a", "b", "d", "e"]
    for name in ("a", "b", "d", "e"):
        ingest([tmp_path / "logs" / f"{name}.csv"], tmp_path / name)
        alone = samples(tmp_path / name)
        found = together[together["recording"] == name]
        for column in ("position", "velocity", "torque"):
            np.testing.assert_array_equal(found[column], alone[column])
        assert len(alone) == len(lines) - 1 - (name == "b")
