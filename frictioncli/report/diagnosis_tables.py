"""Tables on a diagnosis: smallest detectable sizes, largest errors of the simulated torque."""

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.effects import BY_NAME
from frictioncli.report.page_tables import TextTable
from frictioncli.wording import in_words, number_text, speed_text

UNDETECTABLE = "cannot be shown by these data"
FOUND = "found"
NONE = "–"

_PHASES = {"heat-up": "rising", "cool-down": "falling"}
_AXIS_UNITS = {"temperature": "°C", "angle": "deg"}


def detectable_table(document: DiagnosisDocument, unit: str) -> TextTable:
    """Return the smallest size at which each effect would be named in these data.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    unit : str
        Unit of torque.
    """
    sizes = document.detectable
    names = [name for name in BY_NAME if name in sizes]
    names += sorted(set(sizes) - set(names))
    # where a log has a load channel, effects on the load are in its unit
    one_unit = document.unit_of("load") == unit
    return TextTable(
        title="Smallest size of each effect that would be named in 80 % of cases",
        header=("effect", f"RMS [{unit}]" if one_unit else "RMS", "what it is"),
        rows=tuple(
            (
                in_words(name),
                _size_cell(document, name, stated=not one_unit),
                _described(document, name),
            )
            for name in names
        ),
        remarks=True,
    )


def _described(document: DiagnosisDocument, name: str) -> str:
    """Return what an effect is, and why it has no size if it has none."""
    summary = BY_NAME[name].summary if name in BY_NAME else ""
    if document.detectable[name] is not None or name in document.found:
        return summary
    why = document.undetectable.get(name, UNDETECTABLE).removesuffix(" with these data")
    return f"{summary} {why[:1].upper()}{why[1:]}.".lstrip()


def _size_cell(document: DiagnosisDocument, name: str, *, stated: bool) -> str:
    size = document.detectable[name]
    if size is None:
        return FOUND if name in document.found else NONE
    channel = BY_NAME[name].channel if name in BY_NAME else "friction"
    return f"{number_text(size, 2)} {document.unit_of(channel)}" if stated else number_text(size, 2)


def worst_table(document: DiagnosisDocument) -> TextTable:
    """Return the conditions under which the simulated torque is furthest from the measured one."""
    return TextTable(
        title="Largest mean errors of the simulated torque",
        header=("where", "temperature", "speed", "channel", "measured −\u00a0simulated"),
        rows=tuple(
            (
                f"{place.axis} {number_text(place.low)} to {number_text(place.high)}"
                f" {_AXIS_UNITS.get(place.axis, '')}".rstrip(),
                _PHASES.get(place.phase, "steady or unknown"),
                speed_text(place.speed),
                place.channel,
                f"{number_text(place.misfit)} {document.unit_of(place.channel)}",
            )
            for place in document.simulation.worst
        ),
        texts=4,
    )
