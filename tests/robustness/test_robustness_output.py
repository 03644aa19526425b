"""Output that nobody takes: closed, full, or a pipe whose reader has gone."""

import os
import subprocess
import sys

import pytest

from tests.command_line import called
from tests.fleet.fleets import ENVIRONMENT, PROGRAM
from tests.logs.logs import kuka_columns, write


@pytest.fixture
def log(tmp_path):
    """A log of a few moves."""
    return write(tmp_path / "day" / "log.csv", kuka_columns())


def ended(words, *, closed=(), environment=ENVIRONMENT, **streams):
    """Call the program with some of its streams closed; return status and what it said."""

    def prepare():
        for number in closed:
            os.close(number)

    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *map(str, words)],
        env=environment,
        preexec_fn=prepare,
        text=True,
        check=False,
        **options,
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("closed", [(1,), (2,), (0, 1, 2)])
def test_closed_streams_lose_what_is_said_and_nothing_else(tmp_path, log, closed):
    """Their numbers are those that the next opened file would get."""
    work = tmp_path / "work"
    assert called("ingest", log.parent, "-w", work).returncode == 0
    expected = {path.name: path.read_bytes() for path in work.iterdir()}
    for path in work.iterdir():
        path.unlink()
    status, said = ended(["ingest", log.parent, "-w", work], closed=closed)
    assert (status, said) == (0, "")
    assert {path.name: path.read_bytes() for path in work.iterdir()} == expected
    status, said = ended(["pair", "-w", tmp_path / "other"], closed=closed)
    assert status == 2
    assert "Traceback" not in said


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux")
def test_output_that_is_full_is_told_and_not_taken_for_the_work_folder(tmp_path, log):
    work = tmp_path / "work"
    with open("/dev/full", "w") as full:
        status, said = ended(["ingest", log.parent, "-w", work], stdout=full)
        assert (status, said.count("\n")) == (2, 1)
        assert "output cannot be written (No space left on device)" in said
        assert ended(["pair", "-w", tmp_path / "other"], stderr=full)[0] == 2


def test_a_reader_that_has_gone_ends_the_call_quietly(tmp_path, log):
    read, write_end = os.pipe()
    os.close(read)
    with os.fdopen(write_end, "w") as pipe:
        status, said = ended(["ingest", log.parent, "-w", tmp_path / "work"], stdout=pipe)
    assert (status, said) == (141, "")
    assert sorted(path.name for path in (tmp_path / "work").iterdir()) == [
        "recordings.parquet",
        "rejected.parquet",
        "samples.parquet",
    ]


def test_a_list_of_numbers_of_threads(tmp_path, log):
    """OpenMP takes one number per level; numexpr, which pandas imports, does not."""
    environment = ENVIRONMENT | {"OMP_NUM_THREADS": "4,2"}
    words = ["ingest", log.parent, "-w", tmp_path / "work"]
    assert ended(words, environment=environment) == (0, "")
