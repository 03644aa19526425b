"""A small fleet with good and bad joints, and the command on it as a user would call it."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from frictioncli.fleet.joint_logs import JointLogs
from frictioncli.fleet.joint_record import read_record
from tests.command_line import called
from tests.fleet.joints import Joint, write_joint

WITHOUT = ("--no-report", "--no-diagnosis")
ROOT = Path(__file__).parents[2]
SMALL = {"runs": 2, "cycle": 6}
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
PROGRAM = "from frictioncli.cli import main; main()"


def write_fleet(folder):
    """Write four good joints, one whose only log is empty, and one without runs."""
    write_joint(folder / "robot=A" / "joint=2", Joint(seed=1, **SMALL))
    write_joint(folder / "robot=A" / "joint=3", Joint(seed=2, wear=2.0, **SMALL), axis=3)
    write_joint(folder / "robot=B" / "joint=2", Joint(seed=3, **SMALL))
    write_joint(folder / "robot=B" / "joint=4", Joint(seed=4, **SMALL), axis=4)
    bad = folder / "robot=B" / "joint=5" / "run=2024-01-08"
    bad.mkdir(parents=True)
    (bad / "000.csv").write_bytes(b"")
    (folder / "robot=C" / "joint=1").mkdir(parents=True)
    return folder


def _interruptible():
    """Let signals act as usual even if the tests were started as a background job."""
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)


def started(*arguments, **environment):
    """Start the command in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "fleet", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        env=ENVIRONMENT | environment,
        start_new_session=True,
        preexec_fn=_interruptible,
    )


def fleet(*arguments):
    """Run the command to its end, in this process; its workers are processes of their own."""
    with patch.dict(os.environ, ENVIRONMENT):
        return called("fleet", *arguments)


def children(pid):
    """Return the numbers of a process's children, from the system's list."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                state = (entry / "stat").read_text(encoding="utf-8")
            except OSError:
                continue
            if int(state.rpartition(")")[2].split()[1]) == pid:
                found.append(int(entry.name))
    return found


def all_records(out):
    """Return work folder -> record."""
    return {path.parent: read_record(path.parent) for path in out.glob("*/*/fleet.json")}


def begun(out):
    """Return the work folders that a joint was begun in and is not done."""
    return [work for work, record in all_records(out).items() if record and record.key is None]


def done(out):
    """Return the work folders of joints that are done."""
    return [work for work, record in all_records(out).items() if record and record.key is not None]


def until(condition, seconds=300):
    """Wait until the condition gives something, and return it."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.02)
    raise TimeoutError(f"{condition} gave nothing for {seconds} s")


def contents(out):
    """Return file name -> bytes of everything below a folder."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in sorted(out.rglob("*"))
        if path.is_file()
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class Deadly(JointLogs):
    """Logs that take down the process which reads them, so many times."""

    counter: Path
    deaths: int

    def runs(self):
        """Die like a process that the system kills."""
        with self.counter.open("a") as stream:
            stream.write("x")
        if self.counter.stat().st_size <= self.deaths:
            os.kill(os.getpid(), signal.SIGKILL)
        return JointLogs.runs(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Endless(JointLogs):
    """Logs that hold up the process which reads them for ever."""

    def runs(self):
        """Do not come back."""
        while True:
            time.sleep(60)


def is_alive(pid):
    """Return whether a process works; one that has ended and waits for its parent does not."""
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8")
    except OSError:
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"
