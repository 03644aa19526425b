"""DIAdem recordings are read as their header says, or refused where it contradicts itself."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.errors import LogError
from frictioncli.logs.formats import open_log
from frictioncli.logs.formats.diadem import DiademRecording
from frictioncli.logs.ingest import ingest
from frictioncli.logs.log_source import CsvHints, Refusal

from .diadem_files import raw_numbers, write_diadem
from .logs import back_and_forth, write

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
TRACE = {"AxisPos_Act2[°]": POSITION, "AxisVel_Act2[°/s]": VELOCITY, "GearTorq_Act2[Nm]": TORQUE}


def stored(columns=TRACE):
    return {column: raw_numbers(column, values) for column, values in columns.items()}


def opened(path) -> DiademRecording:
    found = open_log(path, CsvHints())
    assert isinstance(found, DiademRecording), found
    return found


def values(recording, size=1 << 20):
    batches = list(recording.batches(range(len(recording.columns)), size))
    return {
        name: np.concatenate([batch.values[i] for batch in batches])
        for i, name in enumerate(recording.columns)
    }


def test_a_trace_becomes_the_same_samples_as_its_scaled_csv(tmp_path):
    write_diadem(tmp_path / "native" / "log.dat", stored())
    columns = {"Zeit[sec]": TIME, **TRACE}
    write(tmp_path / "text" / "log.csv", columns, encoding="cp1252", digits=15)
    found = []
    for kind in ("native", "text"):
        summary = ingest([tmp_path / kind], tmp_path / "work" / kind)
        assert summary.files_rejected == ()
        found.append(tables.read(tmp_path / "work" / kind / "samples.parquet", schemas.SAMPLES))
    for column in ("time", "position", "velocity", "torque"):
        np.testing.assert_allclose(found[0][column], found[1][column], rtol=1e-9, atol=1e-11)
    assert len(found[0]) == len(TIME)


def test_names_units_and_scale(tmp_path):
    """Stored k with factor 0.5 and offset 10 means 0.5 k + 10; time is 0.012 k."""
    columns = {"Drehmoment_A1[Nm]": np.arange(50), "Ohne": np.arange(50) ** 2}
    scales = {"Drehmoment_A1[Nm]": (0.5, 10)}
    found = values(opened(write_diadem(tmp_path / "x.dat", columns, scales=scales)))
    assert list(found) == ["Zeit[sec]", "Drehmoment_A1[Nm]", "Ohne"]
    np.testing.assert_allclose(found["Zeit[sec]"], [0.012 * k for k in range(50)], rtol=1e-12)
    np.testing.assert_allclose(found["Drehmoment_A1[Nm]"], [0.5 * k + 10 for k in range(50)])
    np.testing.assert_allclose(found["Ohne"], [k * k for k in range(50)])


def test_the_missing_value_becomes_nan_before_it_is_scaled(tmp_path):
    columns = {"a": [1.0, 9.9e34, 3.0], "b": [9.9e34, 2.0, 3.0]}
    kinds, scales = {"b": "REAL32"}, {"a": (1e-6, 5)}
    found = values(opened(write_diadem(tmp_path / "x.dat", columns, kinds=kinds, scales=scales)))
    np.testing.assert_allclose(found["a"], [5 + 1e-6, np.nan, 5 + 3e-6])
    np.testing.assert_allclose(found["b"], [np.nan, 2, 3])


@pytest.mark.parametrize("storage", ["BLOCK", "CHANNEL"])
@pytest.mark.parametrize("order", ["High -> Low", "Low -> High"])
def test_all_types_storages_and_byte_orders(tmp_path, storage, order):
    n = 40
    limits = {
        "INT16": 2**15 - 1,
        "INT32": 2**31 - 1,
        "WORD8": 255,
        "WORD16": 65535,
        "WORD32": 2**32 - 1,
    }
    kinds = {"c0": "REAL64", "c1": "REAL32", **{f"c{k}": f"{t}" for k, t in enumerate(limits, 2)}}
    columns = {"c0": np.sin(np.arange(n)), "c1": np.arange(n) / 8}
    for name, kind in list(kinds.items())[2:]:
        low = -limits[kind] - 1 if kind.startswith("INT") else 0
        columns[name] = np.linspace(low, limits[kind], n).astype(np.int64)
    if storage == "CHANNEL":  # positions count in the channel's own type: widest first fits
        kinds = dict(
            sorted(kinds.items(), key=lambda one: -{"8": 1, "6": 2, "2": 4, "4": 8}[one[1][-1]])
        )
        columns = {name: columns[name] for name in kinds}
    header = write_diadem(tmp_path / "x.dat", columns, kinds=kinds, storage=storage, order=order)
    found = values(opened(header), size=64)
    for name, expected in columns.items():
        np.testing.assert_array_equal(found[name], expected, err_msg=f"{name} {kinds[name]}")


@pytest.mark.parametrize(
    "form",
    [
        {"words": ("IMPLICIT", "EXPLICIT")},
        {"newline": "\n"},
        {"encoding": "utf-8"},
        {"encoding": "utf-8-sig"},
        {"named": r"D:\TRACE\log.r64"},
        {"named": "someone_renamed_the_pair.r64"},
    ],
)
def test_forms_of_headers(tmp_path, form):
    header = write_diadem(tmp_path / "log.dat", stored(), **form)
    found = values(opened(header))
    np.testing.assert_allclose(found["AxisPos_Act2[°]"], POSITION, rtol=1e-12)


def test_leading_blanks_and_any_suffix(tmp_path):
    header = write_diadem(tmp_path / "log.dat", stored())
    odd = tmp_path / "log.txt"
    odd.write_bytes(b" \r\n  " + header.read_bytes())
    np.testing.assert_allclose(values(opened(odd))["GearTorq_Act2[Nm]"], TORQUE)


def test_krl_data_with_the_same_suffix_is_no_recording(tmp_path):
    path = tmp_path / "points.dat"
    path.write_text("&ACCESS RVP\nDEFDAT points\nDECL E6POS XP1={X 1,Y 2}\nENDDAT\n")
    found = open_log(path, CsvHints())
    assert isinstance(found, Refusal)
    assert found.text == "KRL program"


@settings(max_examples=25)
@given(size=st.integers(1, 5000), storage=st.sampled_from(["BLOCK", "CHANNEL"]))
def test_batches_of_any_size_hold_the_same(tmp_path_factory, size, storage):
    header = tmp_path_factory.mktemp("any") / "log.dat"
    recording = opened(write_diadem(header, stored(), storage=storage))
    batches = list(recording.batches([0, 3], size))
    np.testing.assert_array_equal(
        np.concatenate([b.lines for b in batches]), range(1, len(TIME) + 1)
    )
    np.testing.assert_array_equal(np.concatenate([b.values[3] for b in batches]), TORQUE)


def test_texts_of_samples(tmp_path):
    columns = {"a": [1.5, 2.5, 9.9e34, 4.5]}
    recording = opened(write_diadem(tmp_path / "x.dat", columns, period=0.25))
    assert list(recording.texts(np.array([2, 3]), 100)) == [(2, "0.25;2.5"), (3, "0.5;")]


def test_a_sample_without_a_value_is_rejected_by_number(tmp_path):
    columns = stored()
    columns["GearTorq_Act2[Nm]"] = np.where(np.arange(len(TIME)) == 7, 9.9e34, TORQUE)
    write_diadem(tmp_path / "run" / "log.dat", columns)
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    assert summary.rows_rejected == {"missing_value": 1}
    rejected = tables.read(tmp_path / "work" / "rejected.parquet", schemas.REJECTED)
    assert rejected["row"].tolist() == [8]
    assert rejected["text"][0].startswith("0.084;")


def cut(header):
    samples = header.with_suffix(".r64")
    samples.write_bytes(samples.read_bytes()[:-5])


def grown(header):
    samples = header.with_suffix(".r64")
    samples.write_bytes(samples.read_bytes() + bytes(24))


def changed(old, new, count=-1):
    def change(header):
        content = header.read_bytes()
        assert old in content
        header.write_bytes(content.replace(old, new, count))

    return change


N = len(TIME)
DAMAGE = [
    (cut, "log.r64 holds"),
    (grown, "copy both files again"),
    (lambda header: header.with_suffix(".r64").unlink(), "log.r64 is not beside it"),
    (lambda header: header.with_suffix(".r64").write_bytes(b""), "holds 0 bytes"),
    (changed(f"220,{N}".encode(), b"220,99", 1), "key 220 is 99 in channel 1 and"),
    (changed(f"220,{N}".encode(), b"220,999999999999999"), "holds"),
    (changed(f"220,{N}".encode(), b"220,1e300"), "holds"),
    (changed(f"220,{N}".encode(), b"220,-4"), "'-4'; expected a whole number"),
    (changed(f"220,{N}".encode(), b"220,0"), "declares no samples"),
    (changed(b"241,1.000000e+00", b"241,NaN"), "key 241 of channel 3 is 'NaN'"),
    (changed(b"241,1.000000e+00", b"241,0"), "expected a factor other than 0"),
    (changed(b"241,1.000000e+00", b"241,1e999"), "expected a number"),
    (changed(b"240,0\r", b"240,zero\r"), "key 240 of channel 2 is 'zero'"),
    (changed(b"221,3", b"221,0"), "expected a position from 1"),
    (changed(b"221,3", b"221,2"), "expected 1, 2, 3 without gap"),
    (changed(b"221,3", b"221,7"), "expected 1, 2, 3 without gap"),
    (changed(b"214,REAL64", b"214,REAL48"), "'REAL48'; expected one of REAL32"),
    (changed(b"213,BLOCK", b"213,ASCII"), "expected BLOCK or CHANNEL"),
    (changed(b"112,High -> Low", b"112,sideways"), "'sideways'; expected 'High -> Low'"),
    (changed(b"210,EXPLIZIT", b"210,PERHAPS", 1), "expected EXPLIZIT or IMPLIZIT"),
    (changed(b"210,EXPLIZIT", b"210,IMPLIZIT"), "names no explicit channel"),
    (changed(b"211,log.r64", b"211,../log.r64"), "expected a file in the header's own folder"),
    (changed(b"211,log.r64", b"211,..\\..\\x.r64"), "expected a file in the header's own folder"),
    (
        lambda header: header.write_bytes(header.read_bytes() + b"x" * (5 << 20)),
        "longer than 4 MiB",
    ),
    (lambda header: header.write_bytes(header.read_bytes()[:300]), "names no explicit channel"),
]


@pytest.mark.parametrize(("damage", "message"), DAMAGE)
def test_damage_is_refused_with_a_reason(tmp_path, damage, message):
    header = write_diadem(tmp_path / "run" / "log.dat", stored())
    damage(header)
    with pytest.raises(LogError) as caught:
        ingest([tmp_path / "run"], tmp_path / "work")
    assert "log.dat" in str(caught.value)
    assert message in str(caught.value)
    assert not (tmp_path / "work").exists()


def test_samples_elsewhere_are_never_read(tmp_path):
    """The header names an existing file outside its folder."""
    write_diadem(tmp_path / "run" / "log.dat", stored(), named=str(tmp_path / "secret.r64"))
    (tmp_path / "run" / "log.r64").rename(tmp_path / "secret.r64")
    found = open_log(tmp_path / "run" / "log.dat", CsvHints())
    assert isinstance(found, Refusal)
    assert found.reason == "samples_missing"


def test_samples_that_shrink_while_they_are_read(tmp_path):
    header = write_diadem(tmp_path / "log.dat", stored())
    recording = opened(header)
    cut(header)
    with pytest.raises(LogError, match="samples end before number"):
        list(recording.batches([3], 1 << 20))


def test_samples_without_a_header_are_refused_by_name(tmp_path):
    write_diadem(tmp_path / "run" / "log.dat", stored()).unlink()
    write(tmp_path / "run" / "good.csv", {"Zeit[sec]": TIME, **TRACE})
    summary = ingest([tmp_path / "run"], tmp_path / "work")
    (refused,) = summary.files_rejected
    assert (refused.file, refused.reason) == ("log.r64", "format_not_read")
    assert "header log.dat is missing" in refused.text


@settings(max_examples=60)
@given(
    at=st.integers(0, 1300),
    new=st.binary(min_size=0, max_size=6),
    count=st.integers(0, 6),
)
def test_any_damaged_header_is_read_or_refused(tmp_path_factory, at, new, count):
    """Whatever bytes change, the result is values or a refusal."""
    header = write_diadem(tmp_path_factory.mktemp("any") / "log.dat", stored())
    content = header.read_bytes()
    header.write_bytes(content[:at] + new + content[at + count :])
    found = open_log(header, CsvHints())
    if isinstance(found, Refusal):
        assert found.text
    elif isinstance(found, DiademRecording):
        assert len(values(found)) == len(found.columns)
