"""A fleet of small joints under everything at once; it must end as if nothing had happened.

Call after call of ``fleet`` on one folder is disturbed: workers and the call itself are killed,
files may not grow beyond a limit as on a full disk, logs are overwritten while they are read and
put back, outputs are damaged, and on Dask the scheduler is killed. After each call every output of
a joint that is done is compared with that of an undisturbed call, unless its record says that it
was made of other logs: a joint may be done before an overwritten log is put back. The last call,
left alone, must give all bytes. Writes its counts into docs/robustness.md.

Usage: python -m tests.studies.soak [JOINTS] [--calls N] [--minutes M] [--seed SEED]
"""

import argparse
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path

from frictioncli.fleet.joint_record import RECORD, JointRecord
from tests.fleet.clusters import scheduler, worker
from tests.fleet.fleets import ENVIRONMENT, PROGRAM, WITHOUT, all_records, children, contents
from tests.fleet.joints import Joint, write_joint
from tests.studies.robustness_page import put

WORKERS = 2

_INPUTS = "inputs_sha256"

KINDS = ("workers", "parent", "disk", "logs", "outputs", "dask")
"""Kinds of disturbance. Each round of so many calls has all of them, in any order."""


@dataclass(slots=True)
class Soak:
    """The world of a soak.

    Attributes
    ----------
    folder : Path
        Its place: ``logs``, ``calm`` with the outputs of an undisturbed call, ``out``.
    draw : random.Random
        Where, when and what.
    round : list of str
        Kinds of disturbance that are left of this round.
    counts : Counter of str
        What was done.
    whole : dict of str to bytes
        All files that the undisturbed call made.
    inputs : dict of str to str
        Digest of the logs of each joint, by its place.
    largest : int
        Size of the largest output of a joint. [bytes]
    joint_time : float
        Time in which a worker makes one joint. [s]
    pause : float
        Longest time between two disturbances; several fall into each call. [s]
    """

    folder: Path
    draw: random.Random
    round: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    whole: dict[str, bytes] = field(default_factory=dict)
    inputs: dict[str, str] = field(default_factory=dict)
    largest: int = 0
    joint_time: float = 0.0
    pause: float = 0.0

    def build(self, joints: int) -> None:
        """Write the logs, and run the undisturbed call."""
        for number in range(joints):
            place = self.folder / "logs" / f"robot={number // 6:03d}" / f"joint={number % 6 + 1}"
            # one in three warms up, and has all outputs; the others are made sooner
            cycle = 2 if number % 3 else 4
            write_joint(place, Joint(seed=number, runs=1, cycle=cycle), axis=number % 6 + 1)
        began = time.monotonic()
        status, said = self._ended(self._started("calm"))
        assert (status, f"{joints} done, 0 failed" in said) == (0, True), said
        call_time = time.monotonic() - began
        self.joint_time = WORKERS * call_time / joints
        # workers that are killed more often than they finish a joint would never end
        self.pause = min(4 * self.joint_time, call_time / 4)
        self.whole = contents(self.folder / "calm")
        self.inputs = {place: one.row[_INPUTS] for place, one in self._done("calm").items()}
        self.largest = max(len(one) for name, one in self.whole.items() if "/" in name)
        # the first call has something to lose, too
        shutil.copytree(self.folder / "calm", self.folder / "out")

    def disturbed_call(self) -> None:
        """Call once, with one kind of disturbance from begin to end."""
        self.round = self.round or self.draw.sample(KINDS, len(KINDS))
        kind = self.round.pop()
        self.counts[f"calls: {kind}"] += 1
        with ExitStack() as stack:
            more: list[str] = []
            limit = round(self.draw.choice((0.1, 0.5, 0.9)) * self.largest)
            if kind == "outputs":
                self._damage_outputs()
            if kind == "dask":
                address, process = stack.enter_context(scheduler())
                for name in "ab":
                    stack.enter_context(worker(address, self.folder / name))
                more = ["--scheduler", address]
            else:
                process = None
            if kind != "outputs":
                # where all is done already, there is nothing to disturb
                more.append("--redo")
            done = self._records()
            call = self._started("out", *more, limit=limit if kind == "disk" else None)
            until = self.draw.uniform(0.1, 0.7) * len(self._records("calm"))
            disturb = {"workers": lambda: self._kill_worker(call), "logs": self._overwrite_log}
            longest = self.pause if kind in disturb else 0.2 * self.joint_time
            while call.poll() is None and len(self._records() - done) < until:
                time.sleep(self.draw.uniform(0.1, 1.0) * longest)
                disturb.get(kind, lambda: None)()
            if kind == "parent" and call.poll() is None:
                number = self.draw.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGINT))
                call.send_signal(number)
                self.counts[f"parents ended by {number.name}"] += 1
            elif process is not None and call.poll() is None:
                process.send_signal(self.draw.choice((signal.SIGKILL, signal.SIGSTOP)))
                self.counts["schedulers killed or stopped"] += 1
            status, said = self._ended(call)
        if kind == "disk" and "too large" in said:
            self.counts["disks full"] += 1
        assert "Traceback" not in said, said
        assert status in (0, 2, 130, -signal.SIGKILL, -signal.SIGTERM), (status, said)
        self.check()

    def check(self) -> None:
        """Compare every joint that is done with the undisturbed one."""
        for place, record in self._done("out").items():
            if record.row[_INPUTS] != self.inputs[place]:
                self.counts["joints of a log as it was before it was put back"] += 1
                continue
            for name in record.outputs:
                found = (self.folder / "out" / place / name).read_bytes()
                assert found == self.whole[f"{place}/{name}"], f"{place}/{name} is another"
            self.counts["joints compared"] += 1

    def _done(self, name: str) -> dict[str, JointRecord]:
        """Return the records of the joints that are done, by place."""
        folder = self.folder / name
        records = all_records(folder) if folder.exists() else {}
        return {
            work.relative_to(folder).as_posix(): record
            for work, record in records.items()
            if record is not None and record.key is not None
        }

    def _records(self, out: str = "out") -> set[tuple[Path, int]]:
        """Return the records of joints with the time at which they were written."""
        found = set()
        for path in (self.folder / out).glob(f"*/*/{RECORD}"):
            with suppress(FileNotFoundError):  # being made anew
                found.add((path, path.stat().st_mtime_ns))
        return found

    def last_call(self) -> None:
        """Call undisturbed; everything must be as in the calm."""
        status, said = self._ended(self._started("out"))
        assert status == 0, said
        found = contents(self.folder / "out")
        wrong = [n for n in {*found, *self.whole} if found.get(n) != self.whole.get(n)]
        assert not wrong, f"{sorted(wrong)[:9]}\n{said}"

    def _started(self, out: str, *more: str, limit: int | None = None) -> subprocess.Popen[str]:
        def prepare() -> None:
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_DFL)
            if limit is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        where = () if "--scheduler" in more else ("--workers", str(WORKERS))
        words = ["fleet", "logs", "-w", out, *WITHOUT, *where, *more]
        return subprocess.Popen(
            [sys.executable, "-c", PROGRAM, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            cwd=self.folder,
            env=ENVIRONMENT | {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5s"},
            preexec_fn=prepare,
        )

    @staticmethod
    def _ended(call: subprocess.Popen[str]) -> tuple[int, str]:
        said, _ = call.communicate(timeout=3600)
        return call.returncode, said

    def _kill_worker(self, call: subprocess.Popen[str]) -> None:
        for pid in children(call.pid):
            with suppress(OSError):
                if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes():
                    os.kill(pid, signal.SIGKILL)
                    self.counts["workers killed"] += 1
                    return

    def _overwrite_log(self) -> None:
        """Overwrite a log, for a moment or for longer, and put it back."""
        path = self.draw.choice(sorted((self.folder / "logs").rglob("*.csv")))
        content = path.read_bytes()
        lines = content.split(b"\n")
        path.write_bytes(b"\n".join(lines[: self.draw.randrange(2, len(lines))]))
        time.sleep(self.draw.choice((0.0, 0.1, 1.0)))
        path.write_bytes(content)
        self.counts["logs overwritten and put back"] += 1

    def _damage_outputs(self) -> None:
        """Cut, change or remove outputs."""
        out = self.folder / "out"
        files = sorted(p for p in out.glob("*/*/*") if p.is_file())
        for path in self.draw.sample(files, min(len(files), 5)):
            content = bytearray(path.read_bytes())
            # a folder without its record is never emptied: the call would end there
            if not content or (path.name != RECORD and self.draw.random() < 0.2):
                path.unlink()
            else:
                content[self.draw.randrange(len(content))] ^= 0xFF
                path.write_bytes(content)
            self.counts["outputs damaged"] += 1


def soaked(joints: int, calls: int, minutes: float, seed: int) -> Soak:
    """Run a soak to its end, and return what was done."""
    until = time.monotonic() + 60 * minutes
    folder = Path(tempfile.mkdtemp(prefix="soak-"))
    try:
        soak = Soak(folder, random.Random(seed))
        soak.build(joints)
        for number in range(calls):
            if time.monotonic() > until:
                break
            soak.disturbed_call()
            print(f"call {number + 1}: {dict(soak.counts)}", flush=True)
        soak.last_call()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return soak


def main() -> None:
    """Soak, and tell."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("joints", type=int, nargs="?", default=300)
    parser.add_argument("--calls", type=int, default=40)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    soak = soaked(asked.joints, asked.calls, asked.minutes, asked.seed)
    files, done = len(soak.whole), sorted(soak.counts.items())
    put(
        "soak",
        f"{asked.joints} joints, seed {asked.seed}. "
        + "; ".join(f"{what} {count:,}" for what, count in done)
        + f". The last call, left alone, gave all {files:,} files of an undisturbed one, byte for"
        " byte.",
    )


if __name__ == "__main__":
    main()
