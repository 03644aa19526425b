"""Help and usage errors answer at once: no heavy library is imported for them."""

import subprocess
import sys

import pytest

from frictioncli.cli.commands import app

COMMANDS = sorted(command.callback.__name__ for command in app.registered_commands)

PROBE = """
import sys
from frictioncli.cli import main
try:
    main()
finally:
    heavy = {"numpy", "pandas", "scipy", "pyarrow", "matplotlib", "pydantic"} & set(sys.modules)
    print("imported:", *sorted(heavy))
"""


def answered(*arguments):
    """Return the exit status, and the heavy libraries that were imported for the answer."""
    done = subprocess.run(
        [sys.executable, "-c", PROBE, *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert "Traceback" not in done.stderr
    return done.returncode, done.stdout.splitlines()[-1].split()[1:]


@pytest.mark.parametrize("arguments", [[], *([command] for command in COMMANDS)], ids=" ".join)
def test_help_imports_nothing_heavy(arguments):
    assert answered(*arguments, "--help") == (0, [])


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["fit", "--fast"],
        ["run"],
        ["pair", "--bin-width", "wide"],
        ["pair", "--bin-width", "0"],
        ["ingest", "logs", "--torque-unit", "furlong"],
        ["separate", "--sign", "up"],
        ["fit", "--method", "magic"],
        ["simulate", "--criterion", "often"],
        ["evaluate", "--k", "two"],
        ["diagnose", "--fail-on", "doubt"],
        ["run", "logs", "--tmax", "-1"],
        ["synthesize", "made", "--protocol", "hasty"],
    ],
    ids=" ".join,
)
def test_usage_errors_import_nothing_heavy(arguments):
    assert answered(*arguments) == (2, [])


def test_work_would_be_seen(tmp_path):
    """The probe itself is tried: a command that reads a table needs the libraries for it."""
    status, imported = answered("fit", "-w", str(tmp_path))
    assert status == 2
    assert "pandas" in imported


LAZY = """
import sys
from frictioncli.stages import ingest, pair, separate
assert "scipy" not in sys.modules and "matplotlib" not in sys.modules
from frictioncli.stages import fit
effects = [name for name in sys.modules if name.startswith("frictioncli.effects")]
diagnosis = [name for name in sys.modules if name.startswith("frictioncli.diagnosis")]
assert not effects and not diagnosis, effects + diagnosis
"""


def test_reading_logs_needs_no_scipy_and_a_fit_no_diagnosis():
    subprocess.run([sys.executable, "-c", LAZY], check=True)
