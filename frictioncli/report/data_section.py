"""What the page says of the data's way through the stages: counts, notes, settings, inputs."""

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import schemas, tables
from frictioncli.report.labels import count_text, thousands_text
from frictioncli.report.page_tables import TextTable
from frictioncli.report.quality_ratings import IngestCounts
from frictioncli.report.results import JointResults, read_optional

_STORED = ("samples", "recordings", "rejected", "pairs", "torques", "schedule", "evaluation")

_MODELS = ("model.json", "diagnosis.json", "extended-model.json")

_MOST_INPUTS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class FileOrigin:
    """Where one file of the work folder comes from.

    Attributes
    ----------
    file, stage, version : str
        Its name, and the stage and version of the program that made it.
    settings : tuple of (str, str)
        The stage's settings.
    inputs : tuple of (str, str)
        Name and SHA-256 of what it was made from.
    more_inputs : int
        Inputs that are not listed.
    like : str
        Another file made from the same inputs, which are listed there; empty where there is none.
    """

    file: str
    stage: str
    version: str
    settings: tuple[tuple[str, str], ...]
    inputs: tuple[tuple[str, str], ...]
    more_inputs: int
    like: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class DataSection:
    """What became of the data.

    Attributes
    ----------
    counts : tuple of TextTable
        Rows read, rejected and left out by pairing.
    notes : tuple of (str, str)
        Stage and what it noted.
    origins : tuple of FileOrigin
        Settings, versions and inputs per file.
    sentence : str
        The counts in a sentence.
    files : tuple of str
        The logs that were read.
    reading : IngestCounts
        The counts that the lights judge.
    """

    counts: tuple[TextTable, ...]
    notes: tuple[tuple[str, str], ...]
    origins: tuple[FileOrigin, ...]
    sentence: str
    files: tuple[str, ...]
    reading: IngestCounts


def data_section(work: Path, results: list[JointResults]) -> DataSection:
    """Collect counts, notes and provenance from the files of a work folder.

    Parameters
    ----------
    work : Path
        The work folder.
    results : list of JointResults
        What the report draws from.
    """
    documents = {
        f"{name}.parquet": tables.document(work / f"{name}.parquet")
        for name in _STORED
        if (work / f"{name}.parquet").exists()
    }
    recordings = read_optional(work, schemas.RECORDINGS)
    # a file's rows stand once per joint that they hold
    files = recordings.drop_duplicates(["run", "recording"])
    rejected = read_optional(work, schemas.REJECTED)
    pairing = documents.get("pairs.parquet", {}).get("facts", {})
    torques = pd.read_parquet(work / "torques.parquet", columns=["joint", "n_forward", "n_reverse"])
    used = int(torques["n_forward"].sum() + torques["n_reverse"].sum())
    counts = [_read_table(files), _rejected_table(rejected), _dropped_table(pairing, used)]
    origins = [_origin(file, document) for file, document in documents.items()]
    for name in _MODELS:
        if (work / name).exists():
            model = json.loads((work / name).read_text(encoding="utf-8"))
            origins.append(_origin(name, model.get("provenance") or {}))
    return DataSection(
        counts=tuple(table for table in counts if table.rows),
        notes=(*_left_out(torques, results), *_notes(documents, recordings, results)),
        origins=_listed_once(origins),
        sentence=_sentence(files, rejected, pairing, used),
        files=tuple(str(file) for file in files["file"]),
        reading=_reading(files, rejected, documents.get("pairs.parquet", {}).get("facts", {})),
    )


def _reading(files: pd.DataFrame, rejected: pd.DataFrame, facts: Mapping[str, Any]) -> IngestCounts:
    return IngestCounts(
        rows=int(files["rows_read"].sum()),
        rejected=int(files["rows_rejected"].sum()),
        files=len(files),
        lost=int(rejected["row"].isna().sum()),
        time_known=facts.get("time_known"),
        warnings=len(_as_list(facts.get("warnings"))),
    )


def _left_out(torques: pd.DataFrame, results: list[JointResults]) -> list[tuple[str, str]]:
    without = sorted({int(joint) for joint in torques["joint"]} - {own.joint for own in results})
    return [
        ("fit", f"joint {joint} has pairs but no model; 'frictioncli fit' says why")
        for joint in without
    ]


def _read_table(files: pd.DataFrame) -> TextTable:
    rows = [
        (
            str(run),
            str(len(own)),
            *(
                thousands_text(int(own[c].sum()))
                for c in ("rows_read", "rows_kept", "rows_rejected")
            ),
        )
        for run, own in files.groupby("run")
    ]
    return TextTable(
        title="Reading",
        header=("run", "files", "rows read", "kept", "rejected"),
        rows=tuple(rows),
    )


def _rejected_table(rejected: pd.DataFrame) -> TextTable:
    reasons = rejected["reason"].value_counts().sort_index(kind="stable")
    return TextTable(
        title="Rejected rows and files",
        header=("reason", "count"),
        rows=tuple((_words(reason), thousands_text(int(n))) for reason, n in reasons.items()),
    )


def _dropped_table(pairing: Mapping[str, Any], used: int) -> TextTable:
    dropped = pairing.get("dropped") or {}
    rows = [(_words(reason), thousands_text(int(n))) for reason, n in dropped.items() if n]
    if rows:
        rows.append(("used in pairs", thousands_text(used)))
    return TextTable(
        title="Samples left out by pairing", header=("reason", "samples"), rows=tuple(rows)
    )


def _words(reason: object) -> str:
    return str(reason).replace("_", " ")


def _sentence(
    files: pd.DataFrame, rejected: pd.DataFrame, pairing: Mapping[str, Any], used: int
) -> str:
    parts = []
    if len(files):
        gone = int(files["rows_rejected"].sum())
        parts.append(
            f"{count_text(int(files['rows_read'].sum()), 'row')} were read from"
            f" {count_text(len(files), 'file')}, {count_text(gone, 'row')} rejected"
        )
    whole_files = int(rejected["row"].isna().sum())
    if whole_files:
        parts.append(f"{count_text(whole_files, 'file')} could not be used at all")
    if pairing.get("samples"):
        share = 100.0 * used / float(pairing["samples"])
        parts.append(f"{share:.0f} % of the samples went into pairs")
    return f"{'; '.join(parts)}." if parts else ""


def _notes(
    documents: Mapping[str, Mapping[str, Any]],
    recordings: pd.DataFrame,
    results: list[JointResults],
) -> list[tuple[str, str]]:
    """Return what the stages noted, each note once, with the stage that noted it first."""
    found: dict[str, str] = {}
    for document in documents.values():
        facts = document.get("facts", {})
        for note in (*_as_list(facts.get("warnings")), *_as_list(facts.get("notes"))):
            found.setdefault(note, str(document.get("stage", "")))
    if not found:
        told = [n for notes in recordings["notes"].dropna() for n in str(notes).splitlines() if n]
        for note, count in Counter(told).items():
            where = "" if count == len(recordings) else f" ({count_text(count, 'recording')})"
            found[f"{note}{where}"] = "ingest"
    for joint in results:
        where = f"joint {joint.joint}: " if len(results) > 1 else ""
        for note in joint.model.notes:
            found.setdefault(f"{where}{note}", "fit")
    return [(stage, note) for note, stage in found.items()]


def _as_list(notes: Any) -> list[str]:
    if isinstance(notes, str):
        return [notes]
    return [str(note) for note in notes or ()]


def _origin(file: str, document: Mapping[str, Any]) -> FileOrigin:
    settings = document.get("settings") or {}
    inputs = sorted((document.get("inputs") or {}).items())
    return FileOrigin(
        file=file,
        stage=str(document.get("stage", "unknown")),
        version=str(document.get("version", "unknown")),
        settings=tuple((str(name), _shown(value)) for name, value in settings.items()),
        inputs=tuple((str(name), str(digest)) for name, digest in inputs[:_MOST_INPUTS]),
        more_inputs=max(len(inputs) - _MOST_INPUTS, 0),
    )


def _listed_once(origins: list[FileOrigin]) -> tuple[FileOrigin, ...]:
    """Let a file refer to the first one with the same inputs, where those are many."""
    first: dict[tuple[tuple[str, str], ...], str] = {}
    told = []
    for origin in origins:
        known = first.setdefault(origin.inputs, origin.file)
        repeats = len(origin.inputs) > 2 and known != origin.file
        told.append(replace(origin, inputs=(), more_inputs=0, like=known) if repeats else origin)
    return tuple(told)


def _shown(value: Any) -> str:
    if value is None or value == {}:
        return "not set"
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
