"""What is right and what is wrong of a diagnosis of a log with a planted effect."""

from collections.abc import Sequence
from dataclasses import dataclass

from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.simulator.planted.catalogue import EFFECTS


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What a diagnosis is worth.

    Attributes
    ----------
    names : tuple of str
        The causes named, each the names of its set joined by ``or``.
    structure : str
        Axes and channel of structure without a name; empty without any.
    already : bool
        Whether the log as it is has the name, or such structure.
    in_set, alone : bool
        Whether what was planted is named, and whether alone. An effect that no catalogue lists is
        right where structure without a name is found along its axes.
    wrong : tuple of str
        Causes that are neither what was planted nor among those of the log as it is.
    """

    names: tuple[str, ...]
    structure: str
    already: bool
    in_set: bool
    alone: bool
    wrong: tuple[str, ...]

    @property
    def found(self) -> bool:
        """Whether it was found, and not there before."""
        return self.in_set and not self.already


def judged(planted: str, before: DiagnosisDocument, after: DiagnosisDocument) -> Judgement:
    """Judge the diagnosis of a log with a planted effect.

    Parameters
    ----------
    planted : str
        Name of the effect.
    before, after : DiagnosisDocument
        Diagnoses of the log as it is and with the effect.
    """
    known = {name for cause in before.named_causes for name in cause.effects}
    listed = planted in EFFECTS and EFFECTS[planted].listed
    right = [cause for cause in after.named_causes if planted in cause.effects]
    located, located_before = _located(planted, after), _located(planted, before)
    wrong = [
        cause
        for cause in after.named_causes
        if planted not in cause.effects and not known & set(cause.effects)
    ]
    return Judgement(
        names=names_of(after.named_causes),
        structure=structure_of(after),
        already=planted in known if listed else located_before,
        in_set=bool(right) if listed else located,
        alone=any(len(cause.effects) == 1 for cause in right) if listed else located,
        wrong=names_of(wrong),
    )


def names_of(causes: Sequence[CauseRecord]) -> tuple[str, ...]:
    """Return the names of causes; those of a set are joined by ``or``."""
    return tuple(" or ".join(cause.effects) for cause in causes)


def structure_of(diagnosis: DiagnosisDocument) -> str:
    """Return axes and channel of structure without a name; empty without any."""
    found = diagnosis.structure
    return "" if found is None else f"{' and '.join(found.axis)}, {found.channel}"


def _located(planted: str, diagnosis: DiagnosisDocument) -> bool:
    axes = set(EFFECTS[planted].axes) if planted in EFFECTS else set()
    found = diagnosis.structure
    return bool(axes) and found is not None and set(found.axis) == axes
