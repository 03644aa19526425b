"""Checks that a change of the code leaves every output as it was, byte for byte.

Runs the program over sample logs, synthetic logs and, where they are at hand, real logs, and
compares the SHA-256 of every file written and of everything printed with the list kept in
``same.sha256``. The list holds for one platform and one set of library versions: write it with the
state before a change, on the machine on which the change is checked.

Outputs of ``fleet`` name the folder of the logs, so everything is made in one fixed folder, where
it stays until the next call; a second call at the same time waits.

Usage: python -m tests.studies.same [GROUP ...] [--write]
"""

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from filelock import FileLock

from frictioncli.cli.commands import app

ROOT = Path(__file__).parents[2]
REAL = Path(os.environ.get("FRICTIONCLI_REAL", ROOT.parent / "shared" / "real"))
LIST = Path(__file__).with_name("same.sha256")
PLACE = Path(tempfile.gettempdir()) / "frictioncli-same"
SAMPLE = ROOT / "sample_logs" / "kr10"

_SECONDS = re.compile(rb"[0-9]+ s of work")


class Outputs:
    """Runs commands in a folder and collects what they print.

    Parameters
    ----------
    folder : Path
        Folder of one group; every path that a command is given is relative to it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True)

    def call(self, name: str, *words: object) -> None:
        """Run one command; keep its status and what it printed as ``NAME.txt``."""
        environment = os.environ | {
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "COLUMNS": "100",
            "PYTHONPATH": str(ROOT),
            "MPLBACKEND": "agg",
        }
        done = subprocess.run(
            [sys.executable, "-m", "frictioncli", *map(str, words)],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            check=False,
        )
        said = b"status %d\n" % done.returncode + done.stdout + b"--- stderr\n" + done.stderr
        said = said.replace(str(self.folder.resolve()).encode(), b".")
        (self.folder / f"{name}.txt").write_bytes(_SECONDS.sub(b"", said))

    def link(self, name: str, target: Path) -> None:
        """Make a folder visible under a name, so that no path of the machine is printed."""
        (self.folder / name).symlink_to(target, target_is_directory=True)


def command_help(out: Outputs) -> None:
    """``--help`` of every command."""
    out.call("help", "--help")
    for command in app.registered_commands:
        name = command.callback.__name__
        out.call(name, name, "--help")


def sample(out: Outputs) -> None:
    """The whole chain over the sample logs, and every way to go on from there."""
    out.link("kr10", SAMPLE)
    out.call("run", "run", "kr10", "-w", "RUN")
    out.call("inspect", "inspect", "kr10")
    out.call("inspect-json", "inspect", "kr10", "--json")
    for target in ("c", "urdf", "mjcf", "json", "csv"):
        out.call(f"export-{target}", "export", "-w", "RUN", "--to", target)
        out.call(f"export-x-{target}", "export", "-w", "RUN", "--to", target, "--extended")
        for file in (out.folder / "RUN" / "export").iterdir():
            file.rename(out.folder / f"extended-{target}-{file.name}")
        out.call(f"export-{target}", "export", "-w", "RUN", "--to", target)
    for target in ("csv", "krl", "urscript"):
        out.call(f"plan-{target}", "plan", "-w", "RUN", "--to", target, "--rated-speed", 225)
        new = ("plan", "--new", "-w", f"NEW-{target}", "--from", -100, "--to-angle", 0)
        speeds = ("--max-speed", 150, "--rated-speed", 225)
        out.call(f"plan-new-{target}", *new, *speeds, "--to", target)
    out.call("evaluate-extended", "evaluate", "-w", "RUN", "--extended")
    (out.folder / "RUN/evaluation.parquet").rename(out.folder / "evaluation-extended.parquet")
    uncertainty = ("--criterion", "uncertainty", "--bound", 2)
    out.call("simulate-uncertainty", "simulate", "-w", "RUN", *uncertainty)
    (out.folder / "RUN/schedule.parquet").rename(out.folder / "schedule-uncertainty.parquet")
    out.call("fit-paper", "fit", "-w", "RUN", "--method", "paper")
    out.call("simulate-paper", "simulate", "-w", "RUN", "--k", 5, "--tmax", 60)
    out.call("report-stale", "report", "-w", "RUN")


def synthetic(out: Outputs) -> None:
    """Simulated joints with several effects, ``compare`` and ``fleet`` over small runs."""
    effects = ("position_ripple:0.8", "stribeck:1", "drift", "payload_change", "inertia:0.3")
    hidden = [word for effect in effects for word in ("--effect", effect)]
    small = ("--thin", 16, "--runs", 3)
    out.call("synthesize", "synthesize", "hidden", *hidden, *small, "--joint-kind", "plain")
    others = ("thermal_lag", "run_in", "rest_recovery", "reversal_transient", "dress_pack")
    rest = [word for effect in others for word in ("--effect", effect)]
    enriched = ("--protocol", "enriched", "--noise-kind", "outliers", "--blind")
    out.call("synthesize-blind", "synthesize", "blind", *rest, "--thin", 64, *enriched)
    wrong = ("synthesize", "wrong", "--effect", "no_such_effect")
    out.call("synthesize-wrong", *wrong)
    out.call("synthesize-zones", "synthesize", "zones", *small, "--seed", 3)
    for day in (1, 2, 3):
        out.call(f"run-day{day}", "run", f"hidden/day{day}", "-w", f"RUN{day}")
    out.call("compare", "compare", "RUN1", "RUN2", "RUN3", "-w", "COMPARED", "--fail-above", "3%")
    for robot, logs in (("a", "hidden"), ("b", "zones")):
        place = out.folder / "FLEET" / f"robot={robot}" / "joint=2"
        place.mkdir(parents=True)
        for day in (1, 2, 3):
            shutil.copytree(out.folder / logs / f"day{day}", place / f"run=day{day}")
    out.call("fleet", "fleet", "FLEET", "-w", "OUT")


def real(out: Outputs) -> None:
    """``inspect``, ``--suggest-map`` and ``run`` over real logs, if they are at hand."""
    for folder in sorted(path for path in REAL.iterdir() if path.is_dir()):
        name = folder.name
        out.link(name, folder)
        out.call(f"{name}-inspect", "inspect", name)
        out.call(f"{name}-inspect-json", "inspect", name, "--json")
        out.call(f"{name}-suggest-map", "inspect", name, "--suggest-map")
        out.call(f"{name}-run", "run", name, "-w", f"RUN-{name}")


GROUPS: dict[str, Callable[[Outputs], None]] = {
    "help": command_help,
    "sample": sample,
    "synthetic": synthetic,
    "real": real,
}


def digests(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield name and SHA-256 of every file below a folder, links aside."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not any(part.is_symlink() for part in (path, *path.parents)):
            content = path.read_bytes()
            yield path.relative_to(folder).as_posix(), hashlib.sha256(content).hexdigest()


def main() -> int:
    """Make everything, compare it with the list or write the list."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=f"of {', '.join(GROUPS)}")
    parser.add_argument("--write", action="store_true", help="write the list instead")
    asked = parser.parse_args()
    names = asked.groups or list(GROUPS)
    if unknown := set(names) - set(GROUPS):
        parser.error(f"{', '.join(sorted(unknown))}: expected {', '.join(GROUPS)}")
    if not REAL.is_dir() and "real" in names:
        names.remove("real")
        print(f"real: left out, no folder {REAL.name} beside the project")
    PLACE.mkdir(exist_ok=True)
    with FileLock(PLACE.with_suffix(".lock")):
        shutil.rmtree(PLACE)
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda name: GROUPS[name](Outputs(PLACE / name)), names))
        found = dict(digests(PLACE))
    lines = LIST.read_text(encoding="utf-8").splitlines() if LIST.exists() else []
    known = {name: digest for digest, _, name in (line.partition("  ") for line in lines)}
    kept = {name: known[name] for name in known if name.partition("/")[0] not in names}
    if asked.write:
        text = "".join(f"{digest}  {name}\n" for name, digest in sorted((kept | found).items()))
        LIST.write_text(text, encoding="utf-8")
        print(f"{len(found)} digests written")
        return 0
    expected = {name: known[name] for name in known if name not in kept}
    changed = sorted(n for n in expected.keys() & found.keys() if expected[n] != found[n])
    for word, faults in (
        ("changed", changed),
        ("missing", sorted(expected.keys() - found.keys())),
        ("new", sorted(found.keys() - expected.keys())),
    ):
        for name in faults:
            print(f"{word}: {name}")
    print(f"{len(found)} outputs, {len(changed)} changed")
    return int(found != expected)


if __name__ == "__main__":
    raise SystemExit(main())
