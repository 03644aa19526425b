"""Files of a work folder that belong to its torques and its model; the report shows no others."""

from dataclasses import dataclass
from pathlib import Path

from frictioncli.errors import TableError
from frictioncli.workfiles import (
    CHALLENGE,
    DIAGNOSIS,
    EVALUATION,
    EXTENDED,
    MODEL,
    PAIRS,
    PLAN,
    RECORDINGS,
    REJECTED,
    SAMPLES,
    SCHEDULE,
    TORQUES,
)
from frictioncli.workfolder import Origin, origin_of

_RESULTS = {
    DIAGNOSIS: "diagnosis",
    EXTENDED: "extended model",
    SCHEDULE: "simulated corrections",
    EVALUATION: "comparison of corrections",
    PLAN: "next experiment",
    CHALLENGE: "planted effects",
}
"""Files made from torques and model, and what the page shows of them."""

_SOURCES = {
    PAIRS: "counts of pairing",
    SAMPLES: "counts of samples",
    RECORDINGS: "counts of the logs",
    REJECTED: "counts of rejected rows",
}
"""Files that torques are made from, nearest first, and what the page shows of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Belonging:
    """Which files of a work folder belong together.

    Attributes
    ----------
    files : frozenset of str
        Names of the files that belong to the torques and the model.
    left_out : tuple of str
        One sentence per part that the page leaves out, with the command that makes it anew.
    """

    files: frozenset[str]
    left_out: tuple[str, ...]


def belonging_files(work: Path) -> Belonging:
    """Return the files of a work folder that belong to its torques and its model.

    A file belongs to them if it was made from them, or they from it, with the content that is
    there now. Files without provenance are taken to belong.

    Parameters
    ----------
    work : Path
        The work folder, with torques and model.

    Raises
    ------
    TableError
        If the model was made from other torques.
    """
    if TORQUES in origin_of(work / MODEL).replaced:
        raise TableError(
            f"{work / MODEL}: was made from a different {TORQUES};"
            f" run 'frictioncli fit -w {work}' again"
        )
    sentences: dict[str, str] = {}
    for name, what in _RESULTS.items():
        if fault := _result_fault(work, name):
            sentences[name] = f"{what.capitalize()} left out: {fault}."
    sentences |= _foreign_sources(work)
    present = {path.name for path in work.iterdir() if path.is_file()}
    return Belonging(files=frozenset(present - set(sentences)), left_out=tuple(sentences.values()))


def _result_fault(work: Path, name: str) -> str:
    """Return why a result does not belong to torques and model; empty if it does."""
    origin = origin_of(work / name)
    for source in origin.inputs:
        if source in origin.replaced:
            return _replaced(name, origin, source)
        if source in _RESULTS and (fault := _result_fault(work, source)):
            return fault
    return ""


def _foreign_sources(work: Path) -> dict[str, str]:
    """Return a sentence per file that the torques were not made from."""
    sentences: dict[str, str] = {}
    users, lost = [TORQUES], ""
    for name, what in _SOURCES.items():
        if not (work / name).exists():
            continue
        for user in users:
            origin = origin_of(work / user)
            if not lost and name in origin.replaced:
                lost = _replaced(user, origin, name)
        if lost:
            sentences[name] = f"{what.capitalize()} left out: {lost}."
        users.append(name)
    return sentences


def _replaced(file: str, origin: Origin, source: str) -> str:
    return f"{file} was made from a different {source}; run 'frictioncli {origin.stage}' again"
