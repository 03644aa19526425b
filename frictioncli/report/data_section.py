"""Sections of the page on data quality and provenance: counts, notes, settings, inputs."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.report.page_tables import TextTable
from frictioncli.report.quality_ratings import IngestCounts
from frictioncli.report.results import JointResults, WorkFolderResults
from frictioncli.wording import count_text, in_words, thousands_text
from frictioncli.workfiles import PAIRS, TORQUES

_MOST_INPUTS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class FileOrigin:
    """Provenance of one file of the work folder.

    Attributes
    ----------
    file, stage, version : str
        File name, and the stage and version of the program that wrote it.
    settings : tuple of (str, str)
        Settings of the stage.
    inputs : tuple of (str, str)
        Name and SHA-256 of each file that it was made from.
    more_inputs : int
        Number of inputs that are not listed.
    same_inputs_as : str
        Another file made from the same inputs, which are listed there; empty if there is none.
    """

    file: str
    stage: str
    version: str
    settings: tuple[tuple[str, str], ...]
    inputs: tuple[tuple[str, str], ...]
    more_inputs: int
    same_inputs_as: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class DataSection:
    """Data quality and provenance as the page states them.

    Attributes
    ----------
    sentence : str
        The counts in a sentence.
    counts : tuple of TextTable
        Rows read, rejected, and left out by pairing.
    notes : tuple of (str, str)
        Stage and its note or warning.
    origins : tuple of FileOrigin
        Provenance per file.
    """

    sentence: str
    counts: tuple[TextTable, ...]
    notes: tuple[tuple[str, str], ...]
    origins: tuple[FileOrigin, ...]


def ingest_counts(results: WorkFolderResults) -> IngestCounts:
    """Return how many rows and files of the logs were read and rejected.

    Parameters
    ----------
    results : WorkFolderResults
        Contents of the work folder.
    """
    files = results.log_files
    facts = _pairing_facts(results)
    return IngestCounts(
        rows=int(files["rows_read"].sum()),
        rejected=int(files["rows_rejected"].sum()),
        files=len(files),
        unusable_files=_unusable_files(results.rejected),
        time_known=facts.get("time_known"),
        warnings=len(_as_list(facts.get("warnings"))),
    )


def data_section(results: WorkFolderResults) -> DataSection:
    """Return counts, notes and provenance of the files of a work folder.

    Parameters
    ----------
    results : WorkFolderResults
        Contents of the work folder.
    """
    pairing = _pairing_facts(results)
    used = int(results.torques["n_forward"].sum() + results.torques["n_reverse"].sum())
    counts = (
        _ingest_table(results.log_files),
        _rejected_table(results.rejected),
        _dropped_table(pairing, used, by_regression=_is_regressed(results)),
    )
    origins = [_file_origin(file, metadata) for file, metadata in results.metadata.items()]
    return DataSection(
        sentence=_counts_sentence(results, pairing, used),
        counts=tuple(table for table in counts if table.rows),
        notes=(*_joints_without_model(results), *_notes(results)),
        origins=_without_repeated_inputs(origins),
    )


def _pairing_facts(results: WorkFolderResults) -> Mapping[str, Any]:
    """Return the facts of the pairs, or of the torques where none come from pairs."""
    source = TORQUES if _is_regressed(results) or PAIRS not in results.metadata else PAIRS
    return dict(results.metadata.get(source, {}).get("facts", {}))


def _is_regressed(results: WorkFolderResults) -> bool:
    """Return whether all torques come from regressions."""
    facts = results.metadata.get(TORQUES, {}).get("facts", {})
    return set(facts.get("separated_by", {}).values()) == {"regression"}


def _unusable_files(rejected: pd.DataFrame) -> int:
    """Return the number of files rejected as a whole; their entries name no row."""
    return int(rejected["row"].isna().sum())


def _joints_without_model(results: WorkFolderResults) -> list[tuple[str, str]]:
    measured = {int(joint) for joint in results.torques["joint"]}
    without = sorted(measured - {joint.joint for joint in results.joints})
    return [
        ("fit", f"joint {joint} has torques but no model; 'frictioncli fit' says why")
        for joint in without
    ]


def _ingest_table(files: pd.DataFrame) -> TextTable:
    columns = ("rows_read", "rows_kept", "rows_rejected")
    rows = [
        (str(run), str(len(own)), *(thousands_text(int(own[name].sum())) for name in columns))
        for run in runs_in_order(files)
        for own in [files[files["run"] == run]]
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
        rows=tuple(
            (in_words(str(reason)), thousands_text(int(n))) for reason, n in reasons.items()
        ),
    )


def _dropped_table(pairing: Mapping[str, Any], used: int, *, by_regression: bool) -> TextTable:
    dropped = pairing.get("dropped") or {}
    rows = [(in_words(str(reason)), thousands_text(int(n))) for reason, n in dropped.items() if n]
    if rows:
        kind = "groups" if by_regression else "pairs"
        rows.append((f"used in {kind}", thousands_text(used)))
    way = "the regression" if by_regression else "pairing"
    return TextTable(
        title=f"Samples used and left out by {way}", header=("reason", "samples"), rows=tuple(rows)
    )


def _counts_sentence(results: WorkFolderResults, pairing: Mapping[str, Any], used: int) -> str:
    files = results.log_files
    parts = []
    if len(files):
        rejected = int(files["rows_rejected"].sum())
        parts.append(
            f"{count_text(int(files['rows_read'].sum()), 'row')} were read from"
            f" {count_text(len(files), 'file')}, {count_text(rejected, 'row')} rejected"
        )
    unusable = _unusable_files(results.rejected)
    if unusable:
        parts.append(f"{count_text(unusable, 'file')} could not be used at all")
    if pairing.get("samples"):
        share = 100.0 * used / float(pairing["samples"])
        kind = "the regression" if _is_regressed(results) else "pairs"
        parts.append(f"{share:.0f} % of the samples went into {kind}")
    return f"{'; '.join(parts)}." if parts else ""


def _notes(results: WorkFolderResults) -> list[tuple[str, str]]:
    """Return the notes of the stages, each once, with the first stage that made it."""
    stages: dict[str, str] = {}
    for metadata in results.metadata.values():
        facts = metadata.get("facts", {})
        for note in (*_as_list(facts.get("warnings")), *_as_list(facts.get("notes"))):
            stages.setdefault(note, str(metadata.get("stage", "")))
    if not stages:
        for note in _recording_notes(results.recordings):
            stages[note] = "ingest"
    for joint in results.joints:
        for note in _model_notes(joint, several_joints=len(results.joints) > 1):
            stages.setdefault(note, "fit")
    return [(stage, note) for note, stage in stages.items()]


def _recording_notes(recordings: pd.DataFrame) -> list[str]:
    """Return the notes on recordings, each once, with the number of recordings if not all."""
    lines = [line for notes in recordings["notes"].dropna() for line in str(notes).splitlines()]
    return [
        note if count == len(recordings) else f"{note} ({count_text(count, 'recording')})"
        for note, count in Counter(line for line in lines if line).items()
    ]


def _model_notes(joint: JointResults, *, several_joints: bool) -> list[str]:
    prefix = f"joint {joint.joint}: " if several_joints else ""
    return [f"{prefix}{note}" for note in joint.model.notes]


def _as_list(notes: Any) -> list[str]:
    if isinstance(notes, str):
        return [notes]
    return [str(note) for note in notes or ()]


def _file_origin(file: str, metadata: Mapping[str, Any]) -> FileOrigin:
    settings = metadata.get("settings") or {}
    inputs = sorted((metadata.get("inputs") or {}).items())
    return FileOrigin(
        file=file,
        stage=str(metadata.get("stage", "unknown")),
        version=str(metadata.get("version", "unknown")),
        settings=tuple((str(name), _setting_text(value)) for name, value in settings.items()),
        inputs=tuple((str(name), str(digest)) for name, digest in inputs[:_MOST_INPUTS]),
        more_inputs=max(len(inputs) - _MOST_INPUTS, 0),
    )


def _without_repeated_inputs(origins: Sequence[FileOrigin]) -> tuple[FileOrigin, ...]:
    """Replace long lists of inputs by a reference to the first file with the same inputs."""
    first: dict[tuple[tuple[str, str], ...], str] = {}
    shortened = []
    for origin in origins:
        file = first.setdefault(origin.inputs, origin.file)
        repeated = len(origin.inputs) > 2 and file != origin.file
        shortened.append(
            replace(origin, inputs=(), more_inputs=0, same_inputs_as=file) if repeated else origin
        )
    return tuple(shortened)


def _setting_text(value: Any) -> str:
    if value is None or value == {}:
        return "not set"
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
