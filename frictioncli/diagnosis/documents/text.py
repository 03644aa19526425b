"""The result of a diagnosis in plain words, for the terminal."""

from collections.abc import Iterator

from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.diagnosis.documents.gain_text import gain_text
from frictioncli.diagnosis.documents.remainder_words import remainder_text
from frictioncli.diagnosis.documents.sentences import (
    chance_text,
    detectable_text,
    empirical_text,
    finding_text,
    lasting_text,
    left_out_text,
    margin_text,
    note_text,
    size_text,
    standing_text,
)
from frictioncli.wording import list_text, probability_text

_PLAN = "next: 'frictioncli plan' proposes what to measure in the time available (--minutes)"


def verdict_text(document: DiagnosisDocument) -> str:
    """Return what is wrong, where, why we think so, what it is worth, what would settle it.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    unit = document.torque_unit
    first = (
        f"joint {document.joint}: {document.verdict}; the simulated torque differs from the"
        f" measured one by {document.simulation.rmse:.3g} {unit} (RMS,"
        f" {list_text(document.runs)})"
    )
    lines = [line for cause in document.named_causes for line in _cause_lines(cause, document)]
    lines += [
        line for cause in document.causes if not cause.effects for line in _left(cause, document)
    ]
    if not document.causes:
        lines.append("no cause is named" if document.visible else "no cause found")
    lines += [line for cause in document.visible for line in _visible_lines(cause, document)]
    if document.gain is not None:
        lines.append(gain_text(document.gain, document))
    lines += [
        remainder_text(document),
        empirical_text(document),
        left_out_text(document),
        margin_text(document),
        detectable_text(document),
        _PLAN if document.causes else "",
    ]
    return "\n  ".join([first, *(line for line in lines if line)])


def _cause_lines(cause: CauseRecord, document: DiagnosisDocument) -> Iterator[str]:
    shares = [
        f"{name} ({probability_text(cause.probabilities.get(name, 0.0))})" for name in cause.effects
    ]
    kind = "measurement: " if cause.is_measurement else ""
    yield f"{kind}{' or '.join(shares)}: {finding_text(cause)}"
    yield f"  size: {size_text(cause, document)}; p-value {chance_text(cause)}"
    if lasting := lasting_text(cause, document):
        yield f"  when: {lasting}"
    yield f"  seen: {cause.claim}"
    yield f"  settled by: {cause.experiment}"


def _left(cause: CauseRecord, document: DiagnosisDocument) -> Iterator[str]:
    """Return the lines on structure without a name."""
    yield (
        f"structure that no known effect explains: {cause.claim}"
        f" {size_text(cause, document)}; p-value {chance_text(cause)}"
    )
    yield f"  settled by: {cause.experiment}"


def _visible_lines(cause: CauseRecord, document: DiagnosisDocument) -> Iterator[str]:
    yield (
        f"not named: {' or '.join(cause.effects)}, {size_text(cause, document)}, p-value"
        f" {chance_text(cause)}; {standing_text(cause)}"
    )
    if note := note_text(cause):
        yield f"  found: {note}"
