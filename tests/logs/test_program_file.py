"""What ``_PROG.TXT`` beside a trace tells: motions, payload, date."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.logs.runs.program_file import read_program

from .kuka_traces import interpolator, read, recordings, write_file, write_trace

PROGRAM = """#BEGINHEADER
TIME: 15:03:53
DATE: 19-05-2021
#ENDHEADER

#BEGINMOTIONINFO
TIME: 0.024000
ENDTIME: 1.103705
TYPE: PTP
SIGNAL: START
LINE: 135
VELOCITIES: { a1 10.000000, a2 20.000000, a6 10.000000 }
LOAD: { m 0.661000, cm { x 12.18, y 2.33, z 48.63, a 0, b 0, c 0 }, j { x 0.00098 } }
LOAD A3: { m 4.000000, cm { x 20.0 } }
#ENDMOTIONINFO

#BEGINMOTIONINFO
TIME: 1.320000
TYPE: PTP
SIGNAL: END
LINE: 135
LOAD: { m 0.661000 }
#ENDMOTIONINFO

#BEGINMOTIONINFO
TIME: 1.400000
ENDTIME: 2.500000
TYPE: LIN
SIGNAL: START
LINE: 152
VELOCITIES: { a1 50.000000 }
LOAD: { m 0.661000 }
#ENDMOTIONINFO
"""


def test_a_programme_is_understood(tmp_path):
    path = tmp_path / "t_PROG.TXT"
    path.write_text(PROGRAM.replace("\n", "\r\n"))
    program = read_program(path)
    assert [(m.kind, m.start, m.end) for m in program.motions] == [
        ("PTP", 0.024, 1.32),
        ("LIN", 1.4, 2.5),
    ]
    assert [motion.speeds for motion in program.motions] == [(10, 20, 10), (50,)]
    assert program.payload == 0.661
    assert program.started_at.isoformat() == "2021-05-19T15:03:53+00:00"
    assert str(program) == "lists LIN and PTP motions at 10 to 50 % of axis speed, payload 0.661 kg"


@pytest.mark.parametrize(
    ("old", "new", "payload"),
    [
        ("LINE: 152", "LINE: 152", 0.661),
        ("50.000000 }\nLOAD: { m 0.661000 }", "50.000000 }\nLOAD: { m 2.0 }", None),
        ("m 0.661000", "m -1.000000", None),  # the controller's sign of a load that is not set
        ("m 0.661000", "m nan", None),
        ("LOAD: {", "LOAD: ", None),
    ],
)
def test_payloads_of_a_programme(tmp_path, old, new, payload):
    path = tmp_path / "t_PROG.TXT"
    path.write_text(PROGRAM.replace(old, new))
    assert read_program(path).payload == payload


def test_payload_and_start_reach_the_recordings(tmp_path):
    for name in ("a", "b"):
        write_file(tmp_path / "run", f"{name}_KRCIpo", interpolator(), native=False)
        text = PROGRAM.replace("15:03:53", "15:04:53") if name == "a" else PROGRAM
        (tmp_path / "run" / f"{name}_PROG.TXT").write_text(text)
    summary, _ = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    rows = recordings(tmp_path / "work")
    assert summary.files_rejected == ()
    assert rows["recording"].tolist() == ["b", "a"]
    assert rows["payload"].tolist() == [0.661, 0.661]
    assert rows["started_at"].tolist()[0] == "2021-05-19T15:03:53+00:00"
    assert rows["start"].tolist() == [0, 60]


def test_the_native_header_tells_the_start_more_exactly(tmp_path):
    write_trace(tmp_path / "run")
    (tmp_path / "run" / "t_PROG.TXT").write_text(PROGRAM)
    read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert recordings(tmp_path / "work")["started_at"][0] == "2021-05-19T15:03:52.944500+00:00"


def test_payloads_that_differ_reach_the_samples_of_their_motions(tmp_path):
    write_file(tmp_path / "run", "t_KRCIpo", interpolator(), native=False)
    two = PROGRAM.replace("50.000000 }\nLOAD: { m 0.661000 }", "50.000000 }\nLOAD: { m 2.0 }")
    (tmp_path / "run" / "t_PROG.TXT").write_text(two)
    summary, samples = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert recordings(tmp_path / "work")["payload"].isna().all()
    np.testing.assert_array_equal(samples["payload"], np.where(samples["time"] < 1.4, 0.661, 2.0))
    assert any("payloads 0.661, 2 kg: by motion" in note for note in summary.notes)


def test_a_manifest_s_payload_goes_before_those_of_motions(tmp_path):
    write_file(tmp_path / "run", "t_KRCIpo", interpolator(), native=False)
    two = PROGRAM.replace("50.000000 }\nLOAD: { m 0.661000 }", "50.000000 }\nLOAD: { m 2.0 }")
    (tmp_path / "run" / "t_PROG.TXT").write_text(two)
    (tmp_path / "run" / "manifest.csv").write_text(
        "file;started_at;payload\nt_KRCIpo.csv;2024-01-02T03:04:05;2.5\n"
    )
    _, samples = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert samples["payload"].isna().all()
    assert recordings(tmp_path / "work")["payload"].tolist() == [2.5]


@pytest.mark.parametrize("listed", ["t", "t_KRCIpo", "t_KRCIpo.csv", "t_KRCIpo.dat"])
def test_a_manifest_wins_whatever_file_of_the_trace_it_names(tmp_path, listed):
    write_trace(tmp_path / "run")
    (tmp_path / "run" / "t_PROG.TXT").write_text(PROGRAM)
    (tmp_path / "run" / "manifest.csv").write_text(
        f"file;started_at;payload\n{listed};2024-01-02T03:04:05;2.5\n"
    )
    summary, _ = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    row = recordings(tmp_path / "work").iloc[0]
    assert (row["payload"], row["started_at"]) == (2.5, "2024-01-02T03:04:05+00:00")
    assert any("the manifest's is taken" in text for text in summary.warnings)


def test_a_payload_told_for_some_recordings_is_taken_for_none(tmp_path):
    for name in ("a", "b"):
        write_trace(tmp_path / "run", name)
    (tmp_path / "run" / "a_PROG.TXT").write_text(PROGRAM)
    summary, _ = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert recordings(tmp_path / "work")["payload"].isna().all()
    assert any("1 of 2 recordings: not used" in text for text in summary.warnings)


@settings(max_examples=60)
@given(at=st.integers(0, len(PROGRAM)), new=st.binary(max_size=8), count=st.integers(0, 200))
def test_a_damaged_programme_is_never_fatal(tmp_path_factory, at, new, count):
    path = tmp_path_factory.mktemp("any") / "t_PROG.TXT"
    content = PROGRAM.encode()
    path.write_bytes(content[:at] + new + content[at + count :])
    program = read_program(path)
    assert program is None or str(program)


def test_a_programme_that_is_no_text(tmp_path):
    write_trace(tmp_path / "run")
    (tmp_path / "run" / "t_PROG.TXT").write_bytes(bytes(range(256)) * 10)
    summary, _ = read(tmp_path / "run", tmp_path / "work", joints=(3,))
    assert any("cannot be understood" in note for note in summary.notes)
    assert summary.files_rejected == ()
