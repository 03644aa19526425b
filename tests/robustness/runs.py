"""A small warm-up of a joint, the program in processes of its own, and what it leaves behind."""

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq

from tests.equation_16 import friction, write_recording
from tests.moves import move_sequence

PROGRAM = (sys.executable, "-c", "from frictioncli.cli import main; main()")
SPEEDS = (20.0, 50.0, 90.0)
TRUTH = {"tau_c": 5.0, "alpha": 0.0, "beta": 2.0, "gamma": 8.0, "delta": 0.05}


def write_warm_up(folder: Path, *, levels=(25, 32, 39, 46, 53, 60, 67), seed=0, ripple=0.0) -> Path:
    """Write a run that makes every table: pairs at three speeds, warmer from file to file.

    Friction is that of equation (16) with ``TRUTH``, gravity 80 cos(q) N·m; a ripple [N·m] of six
    periods per turn comes with the direction.
    """
    rng = np.random.default_rng(seed)
    folder.mkdir(parents=True)
    rows = ["file;started_at;phase"]
    for number, celsius in enumerate(levels):
        motion = move_sequence([0, 100] * len(SPEEDS) + [0], np.repeat(SPEEDS, 2))
        speed = motion["velocity"].abs()
        torque = (
            80 * np.cos(np.radians(motion["position"]))
            + np.sign(motion["velocity"])
            * (
                friction(TRUTH, load=0.0, speed=speed, temperature=celsius)
                + ripple * np.sin(np.radians(6 * motion["position"]))
            )
            + rng.normal(0, 0.1, len(motion))
        )
        warmth = {"Motortemperatur2[°C]": float(celsius)}
        write_recording(folder / f"s{number}.csv", motion, torque, **warmth)
        rows.append(f"s{number}.csv;2024-05-17T{8 + number:02d}:00:00;heat-up")
    (folder / "manifest.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return folder


def started(*arguments: object, env: Mapping[str, str] | None = None, **how) -> subprocess.Popen:
    """Start the program and do not wait for it."""
    return subprocess.Popen(
        [*PROGRAM, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
        env=os.environ | dict(env or {}),
        **how,
    )


def finished(*arguments: object, **how) -> subprocess.CompletedProcess:
    """Run the program to its end."""
    process = started(*arguments, **how)
    out, err = process.communicate()
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def refused(result: subprocess.CompletedProcess) -> str:
    """Return the one message of a run that had to end with status 2."""
    assert result.returncode == 2, result
    assert "Traceback" not in result.stderr
    assert result.stderr.count("\n") == 1, result.stderr
    return result.stderr


def outputs(work: Path) -> Iterator[Path]:
    """Yield the files that a user sees in a work folder: hidden ones are drafts and locks."""
    for path in sorted(work.rglob("*")):
        hidden = any(part.startswith(".") for part in path.relative_to(work).parts)
        if path.is_file() and not hidden:
            yield path


def digests(work: Path) -> dict[str, str]:
    """Return relative name -> SHA-256 of everything in a work folder, hidden files too."""
    return {
        path.relative_to(work).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(work.rglob("*"))
        if path.is_file()
    }


def check_readable(path: Path) -> None:
    """Fail unless a file is whole, as its kind is read by other programs."""
    if path.suffix == ".parquet":
        pq.read_table(path)
    elif path.suffix == ".json":
        json.loads(path.read_text(encoding="utf-8"))
    elif path.suffix == ".png":
        assert path.read_bytes().endswith(b"IEND\xaeB`\x82"), path
    elif path.suffix == ".csv":
        assert len(pd.read_csv(path)), path
    else:
        ends = {".html": "</html>", ".svg": "</svg>"}
        assert path.read_text(encoding="utf-8").rstrip().endswith(ends[path.suffix]), path
