"""How soon the command line answers: help and usage errors."""

import os

from frictioncli.cli.commands import app
from tests.studies.benching import Disagreement, Goal, Round, Work, command

ERRORS = {
    "no such command": ("fly",),
    "no such option": ("fit", "--fast"),
    "not a number": ("pair", "--bin-width", "wide"),
}


def works(small: bool) -> list[Work]:
    """Return the one work; it is never large."""
    del small
    commands = sorted(str(one.name or one.callback.__name__) for one in app.registered_commands)
    helps = [command("--help", "{frictioncli}", "--help")]
    helps += [command(f"{name} --help", "{frictioncli}", name, "--help") for name in commands]
    errors = [
        command(name, "{frictioncli}", *words, status=2, shown=f"frictioncli {' '.join(words)}")
        for name, words in ERRORS.items()
    ]
    return [
        Work(
            name="start",
            title="Help and usage errors",
            contestants=[command("bare Python", "{python}", "-c", "pass"), *helps, *errors],
            goals=[
                slowest("slowest help", [one.name for one in helps]),
                slowest("slowest usage error", [one.name for one in errors]),
            ],
            check=answered,
        )
    ]


def slowest(text: str, names: list[str]) -> Goal:
    """Return the goal that the slowest of some commands answers in time."""
    return Goal(
        text=f"{text}, s",
        figure=lambda runs: max(runs[name].wall for name in names),
        must=0.2,
        reach=0.1,
        at_most=True,
    )


def answered(runs: Round) -> str:
    """Check that every command said something, on stdout or stderr."""
    for name, run in runs.items():
        told = sum(os.path.getsize(run.out / file) for file in ("stdout.txt", "stderr.txt"))
        if name != "bare Python" and not told:
            raise Disagreement(f"{name}: said nothing")
    return "Every command answered, with the exit status that it must have."
