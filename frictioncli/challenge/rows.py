"""Rows of ``challenge.parquet``: written after each trial, and taken up again by the next call."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import tables
from frictioncli.challenge.judged import Judgement, judged
from frictioncli.challenge.search_size import SizeFound
from frictioncli.challenge.subject import Subject
from frictioncli.challenge.trial import Trial
from frictioncli.challenge_schema import (
    AS_LOGGED,
    CANNOT,
    DONE,
    NOTHING,
    Row,
)
from frictioncli.challenge_schema import CHALLENGE as CHALLENGE_TABLE
from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.errors import TableError
from frictioncli.provenance import Provenance
from frictioncli.report.challenge_words import rows_of_table
from frictioncli.workfiles import DIAGNOSIS

SEPARATOR = "; "
"""Between the names of two causes."""


@dataclass(slots=True)
class ChallengeTable:
    """The table of a work folder, with the rows of earlier calls on the same data.

    Attributes
    ----------
    path : Path
        The file.
    provenance : Provenance
        Settings of the chain, and digests of what was diagnosed and of what was said of it; rows of
        other ones are dropped. The diagnosis may claim other sizes.
    facts : mapping
        Facts of the table, as its torque unit.
    rows : list of dict
        The rows.
    """

    path: Path
    provenance: Provenance
    facts: Mapping[str, Any]
    rows: list[Row] = field(default_factory=list)

    def take_up(self) -> int:
        """Take over the rows of an earlier call on the same data; return how many."""
        self.rows = _earlier(self.path, self.provenance)
        return len(self.rows)

    def of(self, joint: int, effect: str, seed: int, asked: float) -> Row | None:
        """Return the row of a trial that was made before; None if there is none.

        Parameters
        ----------
        joint, effect, seed : int, str, int
            What was planted.
        asked : float
            Its size. [unit of its channel]
        """
        return next(
            (
                row
                for row in self.rows
                if (row["joint"], row["effect"], row["seed"]) == (joint, effect, seed)
                and row["asked"] is not None
                and abs(row["asked"] / asked - 1.0) < 1e-9
            ),
            None,
        )

    def add(self, row: Row) -> Row:
        """Add a row and write the table."""
        self.rows.append(row)
        self.write()
        return row

    def write(self) -> None:
        """Write all rows."""
        names = [column.name for column in CHALLENGE_TABLE.columns]
        frame = pd.DataFrame(self.rows, columns=names)
        for column in CHALLENGE_TABLE.columns:
            if column.type == "double":
                frame[column.name] = frame[column.name].astype(float)
        tables.write(self.path, frame, CHALLENGE_TABLE, self.provenance, self.facts)

    def set_claimed(self, joint: int, claimed: Mapping[str, float | None]) -> None:
        """State the sizes that the diagnosis of a joint claims in all its rows."""
        for row in self.rows:
            if row["joint"] == joint:
                row["claimed"] = claimed.get(row["effect"])
        self.write()

    def is_searched(self, joint: int, effect: str, seed: int) -> bool:
        """Return whether the least size of an effect was searched for before."""
        return any(
            (row["joint"], row["effect"], row["seed"]) == (joint, effect, seed)
            and (row["size_found_low"] is not None or row["size_found_high"] is not None)
            for row in self.rows
        )

    def set_found(self, joint: int, effect: str, seed: int, found: SizeFound) -> None:
        """State the least size that was found in the rows of an effect."""
        for row in self.rows:
            if (row["joint"], row["effect"], row["seed"]) == (joint, effect, seed):
                row |= {
                    "size_found": found.size,
                    "size_found_low": found.low,
                    "size_found_high": found.high,
                }
        self.write()


def _earlier(path: Path, provenance: Provenance) -> list[Row]:
    """Return the rows of a table of the same data; none of other data, or of a damaged one."""
    if not path.exists():
        return []
    try:
        origin = tables.metadata(path)
        if _comparable(origin) != _comparable(provenance.as_dict()):
            return []
        frame = tables.read(path, CHALLENGE_TABLE)
    except TableError:
        return []
    return rows_of_table(frame)


def _comparable(origin: Mapping[str, Any]) -> dict[str, Any]:
    """Return what must be the same: all but the claims of the diagnosis."""
    names = [one.name for one in fields(Provenance)]
    known = {name: origin.get(name) for name in names if name != "inputs"}
    inputs = {name: one for name, one in origin.get("inputs", {}).items() if name != DIAGNOSIS}
    return known | {"inputs": inputs}


def row_as_logged(subject: Subject) -> Row:
    """Return the row of a joint without anything planted."""
    diagnosis = subject.diagnosis
    judgement = judged(NOTHING, diagnosis, diagnosis)
    return _row(subject, NOTHING, 0, AS_LOGGED, None, "friction") | _said(diagnosis, judgement)


def row_of_trial(
    subject: Subject, effect: str, seed: int, purpose: str, asked: float, trial: Trial
) -> Row:
    """Return the row of a trial.

    Parameters
    ----------
    subject : Subject
        The joint.
    effect, seed : str, int
        What was planted.
    purpose : {"given", "share", "search"}
        Why in this size.
    asked : float
        Size that was asked for. [unit of its channel]
    trial : Trial
        The diagnosed trial.
    """
    judgement = judged(effect, subject.diagnosis, trial.diagnosis)
    return (
        _row(subject, effect, seed, purpose, asked, trial.channel)
        | _said(trial.diagnosis, judgement)
        | {
            "size": trial.size,
            "share": trial.size / subject.reference(trial.channel),
            "seconds": trial.seconds,
        }
    )


def row_refused(
    subject: Subject, effect: str, seed: int, purpose: str, asked: float, message: str
) -> Row:
    """Return the row of an effect that the data cannot show, or do not allow a diagnosis with.

    Parameters
    ----------
    subject, effect, seed, purpose, asked
        As of :func:`row_of_trial`.
    message : str
        Why.
    """
    row = _row(subject, effect, seed, purpose, asked, subject.channel_of(effect))
    return row | {"status": CANNOT, "message": message}


def _row(
    subject: Subject, effect: str, seed: int, purpose: str, asked: float | None, channel: str
) -> Row:
    nothing: Row = {column.name: None for column in CHALLENGE_TABLE.columns}
    return nothing | {
        "joint": subject.joint,
        "effect": effect,
        "seed": seed,
        "purpose": purpose,
        "status": DONE,
        "message": "",
        "unit": subject.diagnosis.unit_of(channel),
        "asked": asked,
        "claimed": subject.diagnosis.detectable.get(effect),
        "names": "",
        "structure": "",
        "already": False,
        "right_in_set": False,
        "right_alone": False,
        "wrong": "",
    }


def _said(diagnosis: DiagnosisDocument, judgement: Judgement) -> Row:
    gain = diagnosis.gain
    said: Row = {
        "verdict": diagnosis.verdict,
        "names": SEPARATOR.join(judgement.names),
        "structure": judgement.structure,
        "already": judgement.already,
        "right_in_set": judgement.in_set,
        "right_alone": judgement.alone,
        "wrong": SEPARATOR.join(judgement.wrong),
        "rmse_before": diagnosis.simulation.rmse,
    }
    if gain is not None:
        said |= {
            "gain": gain.reduction,
            "gain_low": gain.ci95[0],
            "gain_high": gain.ci95[1],
            "gain_basis": gain.basis,
            "rmse_before": gain.rmse_before,
            "rmse_after": gain.rmse_after,
        }
    return said
