"""What the extended model still misses, in words: how much, and along which axis."""

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.remainder_record import RemainderRecord
from frictioncli.diagnosis.search.largest_structure import LEAST_PART, WHOLE_RUN
from frictioncli.wording import number_text

_MOST = 0.5
"""Share of the mean square of a remainder from which on an axis has most of it."""

_AXES = {
    "position": "the joint angle",
    "speed": "the speed",
    "temperature": "the temperature",
    "time": "time",
    "load": "the load",
}
"""Axis -> its name in a sentence."""


def extent(left: RemainderRecord) -> str:
    """Return how much of a remainder varies along its axis: ``mostly``, ``partly``, or empty.

    Parameters
    ----------
    left : RemainderRecord
        The remainder.
    """
    along, whole = left.axis_size**2, left.size**2
    if along < LEAST_PART * whole:
        return ""
    return "mostly" if along >= _MOST * whole else "partly"


def variation(left: RemainderRecord) -> str:
    """Return how a remainder varies that does along its axis, as a participle.

    Parameters
    ----------
    left : RemainderRecord
        The remainder.
    """
    if left.axis == WHOLE_RUN:
        return f"{extent(left)} the same over the whole run"
    return f"varying {extent(left)} with {_AXES.get(left.axis, left.axis)}"


def remainder_text(document: DiagnosisDocument) -> str:
    """Return what the extended model leaves, where and along which axis; empty if only noise is.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    left, unit = document.remainder, document.torque_unit
    if left is None:
        return ""
    on = f"on run {document.held_out}" if left.basis == "new_run" else "on the fitted data"
    model = "extended" if document.modelled_causes else "base"
    part = {"mostly": "most of it", "partly": "a part of it"}.get(extent(left))
    varies = "it does not clearly vary with any measured quantity"
    if part:
        does = f"varies with {_AXES.get(left.axis, left.axis)}"
        if left.axis == WHOLE_RUN:
            does = "is the same over the whole run"
        varies = f"{part}, {number_text(left.axis_size, 2)} {unit} in the {left.channel}, {does}"
    return (
        f"Unexplained structure remains: {on} the torque error of the {model} model is"
        f" {number_text(left.rmse, 2)} {unit} (RMS), where noise alone is"
        f" {number_text(left.noise_floor, 2)} {unit}. Without the noise (difference of the"
        f" squares) the error is {number_text(left.size, 2)} {unit}; {varies}."
    )
