"""Little that unpacks to much: work ends early, not only memory."""

import gzip
import struct
import subprocess
import sys
import zlib

import pytest

from tests.fleet.fleets import ENVIRONMENT, PROGRAM

MIB = 1 << 20
SECONDS = 60
"""Processor time; to read all of it would take many minutes."""
MEMORY = 500
HEAD = b"Zeit[sec];AxisPos_Act2[deg];GearTorq_Act2[Nm]\n"
ROWS = b"".join(b"%.3f;%.4f;%.3f\n" % (i * 0.012, i * 0.1, i % 7 * 0.3) for i in range(2000))

CALL = f"""
import resource, sys
resource.setrlimit(resource.RLIMIT_CPU, ({SECONDS}, {SECONDS}))
import atexit, pathlib, re
status = pathlib.Path("/proc/self/status")
# ru_maxrss would count the process that has started this one
atexit.register(lambda: print(int(re.search(r"VmHWM:\\s*(\\d+)", status.read_text())[1]) // 1000))
{PROGRAM}
"""


def packed(path, part, mebibytes):
    """Write a log that goes on with the same part for long; each mebibyte is packed alike."""
    plain = part * (MIB // len(part))
    check = zlib.crc32(HEAD + ROWS)
    for _ in range(mebibytes):
        check = zlib.crc32(plain, check)
    length = len(HEAD + ROWS) + mebibytes * len(plain)
    path.write_bytes(
        b"\x1f\x8b\x08\0\0\0\0\0\0\xff"
        + _deflated(HEAD + ROWS)
        + _deflated(plain) * mebibytes
        + _deflated(b"", zlib.Z_FINISH)
        + struct.pack("<LL", check, length)
    )
    assert path.stat().st_size < 3 * MIB


def _deflated(content, end=zlib.Z_FULL_FLUSH):
    """Return a part of a deflated stream, which may follow any other."""
    packer = zlib.compressobj(6, zlib.DEFLATED, -zlib.MAX_WBITS)
    return packer.compress(content) + packer.flush(end)


def test_what_is_packed_is_a_gzip_file(tmp_path):
    packed(tmp_path / "log.gz", b"0;0;0\n", 3)
    plain = gzip.decompress((tmp_path / "log.gz").read_bytes())
    assert plain == HEAD + ROWS + b"0;0;0\n" * (MIB // 6) * 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "part", "reason"),
    [
        ("ingest", b"\n", "not blank"),
        ("inspect", b"        \r\n", "not blank"),
        pytest.param("ingest", b"x\n", "wrong_field_count", marks=pytest.mark.long),
        pytest.param("ingest", b"0;0;0\n", "time_not_increasing", marks=pytest.mark.long),
        pytest.param("inspect", b"0;0;0\n", "time_not_increasing", marks=pytest.mark.long),
    ],
)
def test_gigabytes_in_kilobytes_end_early(tmp_path, command, part, reason):
    """Both commands read by the same way, blank text and rows that are none."""
    (tmp_path / "day").mkdir()
    packed(tmp_path / "day" / "log.csv.gz", part, 400)
    arguments = [command, str(tmp_path / "day")]
    if command == "ingest":
        arguments += ["-w", str(tmp_path / "work")]
    done = subprocess.run(
        [sys.executable, "-c", CALL, *arguments],
        env=ENVIRONMENT | {"COLUMNS": "500"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == (2 if command == "ingest" else 0), done
    assert reason in done.stdout + done.stderr
    assert int(done.stdout.split()[-1]) < MEMORY


def test_the_limit_of_processor_time_is_one():
    """The limit ends a call that goes on."""
    call = CALL.replace(f"({SECONDS}, {SECONDS})", "(1, 1)").replace(PROGRAM, "while True: pass")
    done = subprocess.run([sys.executable, "-c", call], env=ENVIRONMENT, check=False)
    assert done.returncode < 0
