"""The page on real logs: a section per case, in the program's own words."""

from pathlib import Path
from textwrap import fill

import pandas as pd

from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.diagnosis.documents.remainder_words import remainder_text
from frictioncli.diagnosis.documents.sentences import (
    chance_text,
    detectable_text,
    finding_text,
    lasting_text,
    margin_text,
    note_text,
    size_text,
    standing_text,
)
from frictioncli.report.diagnosis_text import gain_sentence
from frictioncli.wording import count_text, number_text, range_text
from tests.studies.real_cases import CASES, Case

_LONGEST = 420
"""Characters of a refusal; that of many files repeats itself."""

_HEAD = (
    "Logs written by others, from public repositories; they are not part of this one."
    " `make real-diagnoses REAL=FOLDER` reads them from FOLDER and writes this page. Each went"
    " through the chain with default settings and, where its channels cannot be found, a mapping"
    " file (`tests/studies/real_maps`). Sentences on findings are the program's own; what is known"
    " from elsewhere and our opinion of the result are marked as such. Figures: means of measured"
    " minus simulated torque with twice their standard error over pairs, against the quantity in"
    " which the finding shows."
)


def without_path(text: str, logs: Path) -> str:
    """Return a message without the folder in which the logs happen to be."""
    return text.replace(f"{logs}/", "")


def shortened(refusal: str) -> str:
    """Return the beginning of a refusal; that of many files repeats itself."""
    if len(refusal) <= _LONGEST:
        return refusal
    return f"{refusal[: max(refusal.rfind('; ', 0, _LONGEST), refusal.rfind(' ', 0, 200))]}; …"


def refusal_text(refusal: str) -> str:
    """Return the section on logs that are refused."""
    return f"Refused: “{shortened(refusal)}”"


def diagnosis_sentence(document: DiagnosisDocument) -> str:
    """Return a joint's diagnosis in one sentence: the verdict, what is named, what is only seen."""
    named = [
        " or ".join(f"`{name}`" for name in cause.effects) or "structure without a name"
        for cause in document.causes
    ]
    seen = [" or ".join(f"`{name}`" for name in cause.effects) for cause in document.visible]
    parts = [
        f"found: {'; '.join(named)}" if named else "nothing is named",
        f"seen and not named: {'; '.join(seen)}" if seen else "",
        f"the simulated torque differs from the measured one by"
        f" {number_text(document.simulation.rmse)} {document.torque_unit} (RMS)",
    ]
    return f"{document.verdict}: {'; '.join(part for part in parts if part)}"


def joint_text(
    case: Case, found: Reloaded, rows: pd.DataFrame, figure: str, noun: str = "pair"
) -> str:
    """Return what is said of one joint, with its figure."""
    document = found.document
    unit = document.torque_unit
    lines = [
        f"**Joint {document.joint}: {document.verdict}.** {_measured(rows, noun)} The simulated"
        f" torque differs from the measured one by {number_text(document.simulation.rmse)}"
        f" {unit} (RMS)."
        f" {remainder_text(document)}".rstrip(),
        "",
        *(_bullet(cause, document) for cause in (*document.causes, *document.visible)),
        *([] if document.causes or document.visible else ["- nothing found"]),
        "",
        " ".join(
            text
            for text in (
                gain_sentence(document, unit),
                margin_text(document),
                detectable_text(document),
            )
            if text
        ),
        "",
        f"![misfit of joint {document.joint}, {case.name}]({figure})",
    ]
    return "\n".join(lines)


def _bullet(cause: CauseRecord, document: DiagnosisDocument) -> str:
    size = f"{size_text(cause, document)}, p-value {chance_text(cause)}"
    if not cause.effects:
        return f"- structure without a name: {cause.claim} {size}."
    names = " or ".join(f"`{name}`" for name in cause.effects)
    if cause.standing == "named":
        when = lasting_text(cause, document)
        return f"- **{names}**: {finding_text(cause)} {size}.{' ' if when else ''}{when}"
    note = note_text(cause)
    return f"- not named: {names}, {size}; {standing_text(cause)}.{' ' if note else ''}{note}"


def _measured(rows: pd.DataFrame, noun: str) -> str:
    """Return how much was measured under which conditions; ``noun`` is what a pair is called."""
    pairs = rows.drop_duplicates(["run", "pair"])
    ends = [number_text(float(end)) for end in (pairs["speed"].min(), pairs["speed"].max())]
    motor = pairs["motor_temperature"].dropna()
    warm = f", motor {motor.min():.0f} to {motor.max():.0f} °C" if len(motor) else ""
    return (
        f"{count_text(len(pairs), noun)} in {count_text(pairs['run'].nunique(), 'run')} at"
        f" {range_text(ends)} deg/s{warm}."
    )


def write_section(page: Path, case: Case, text: str) -> None:
    """Write the section on a case; the others stay as they are.

    Parameters
    ----------
    page : Path
        The page.
    case : Case
        The case.
    text : str
        What the program says of it.
    """
    known = f"Known: {case.known}\n\n" if case.known else ""
    judgement = f"\n\nWhat we think of it: {case.judgement}" if case.judgement else ""
    sections = _sections(page)
    sections[case.name] = f"## {case.title}\n{known}{text}{judgement}"
    names = [one.name for one in CASES if one.name in sections]
    parts = [f"<!-- {name} -->\n{sections[name]}" for name in names]
    head = f"# Diagnoses of real logs\n\n{fill(_HEAD, 120)}"
    page.write_text("\n\n".join([head, *parts]) + "\n", encoding="utf-8")


def _sections(page: Path) -> dict[str, str]:
    """Return the sections of the page by case."""
    if not page.exists():
        return {}
    parts = page.read_text(encoding="utf-8").split("<!-- ")[1:]
    split = (part.split(" -->\n", 1) for part in parts)
    return {name: text.rstrip() for name, text in split}
