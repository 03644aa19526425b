"""What the gain of an extended model says, as terminal and page say it."""

from frictioncli.diagnosis.documents.document import DiagnosisDocument, GainRecord
from frictioncli.diagnosis.documents.sentences import percent_text
from frictioncli.wording import number_text


def gain_text(gain: GainRecord, document: DiagnosisDocument) -> str:
    """Return by how much the extended model misses the torque less.

    Parameters
    ----------
    gain : GainRecord
        The gain.
    document : DiagnosisDocument
        The joint's diagnosis.
    """
    unit = document.torque_unit
    where = (
        f"on run {document.held_out}, not used for fitting"
        if gain.basis == "new_run"
        else "on its own training data (optimistic)"
    )
    low, high = map(percent_text, gain.ci95)
    worse = worse_text(gain, unit)
    return (
        f"extended model: {gain.rmse_before:.3g} -> {gain.rmse_after:.3g} {unit} {where}, a gain of"
        f" {100 * gain.reduction:.0f} % ({low} to {high});"
        f" noise floor {gain.noise_floor:.2g} {unit}{worse and f'. {worse}'}"
    )


def worse_text(gain: GainRecord, unit: str) -> str:
    """Return what follows from an extended model that is surely worse; empty if it is not.

    Friction differs from day to day. Where a model is better apart from that, its causes hold.

    Parameters
    ----------
    gain : GainRecord
        The gain.
    unit : str
        Unit of torque.
    """
    if gain.ci95[1] >= 0:
        return ""
    text = "The extended model is worse than the base model: do not use it."
    before, after = gain.rmse_without_level or (0.0, 0.0)
    if after >= before:
        return text
    return (
        f"{text} Apart from torque that is the same over the whole run it is better:"
        f" {number_text(after, 2)} instead of {number_text(before, 2)} {unit}."
    )
