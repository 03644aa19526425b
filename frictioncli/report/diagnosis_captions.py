"""Titles and captions of the figures of a diagnosis."""

from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.report.results import JointResults
from frictioncli.wording import count_text, in_words


def evidence_caption(results: JointResults, *, cause: CauseRecord, fitted: str) -> str:
    """Return the caption of the figure of one cause."""
    return (
        f"{cause.claim} Points: mean misfit of the {cause.channel} in bins, with twice its"
        f" standard error over {results.row_noun}s; a point without a bar is a single"
        f" {results.row_noun}. First panel: the base model."
        f" Second: the extended model without this cause, and the term fitted for it, {fitted};"
        " it may exceed the misfit above, where the base model's parameters compensate for it."
        " Third: the extended model. The data support the cause if the second points lie on the"
        " lines and the third on zero. Bars: probability of each possible effect, the credible set"
        " in blue."
    )


def simulation_caption(results: JointResults, *, held_out: str | None) -> str:
    """Return the caption of the figure of measured and simulated torque."""
    new = f" Run {held_out} was not used for fitting." if held_out else ""
    return (
        "Points: measured torque, forward filled, reverse hollow; lines: simulated along the same"
        f" motion by the base model. Below each: their difference.{new} Above: mean of each"
        f" {results.row_noun} over its angles. Below: means over the {results.row_noun}s of the"
        " fastest speed shown, separately for heating and cooling, whose misfits may cancel."
    )


def map_caption(results: JointResults, *, extended: bool) -> str:
    """Return the caption of the residual maps."""
    beside = " Left: the base model. Right: the extended model." if extended else ""
    return (
        "Mean of measured minus simulated torque per cell, red where more was measured than"
        f" simulated, blue where less; grey: no data.{beside} Friction reverses with direction;"
        " load does not. Each has its own scale. A trend or a patch is structure; a random pattern"
        " is noise."
    )


def gain_caption(results: JointResults, *, document: DiagnosisDocument) -> str:
    """Return the caption of the distributions of residuals before and after the extension."""
    run = f"run {document.held_out}" if document.held_out else "the data fitted"
    return (
        f"Misfit of the simulated torque on {run}, in both directions, for the base and the"
        " extended model. Above: its distribution. Below: the share of points with a larger misfit."
        f" Grey: noise of points and {results.row_noun}s, which no model can predict."
    )


def cause_title(cause: CauseRecord, number: int) -> str:
    """Return the heading of a cause's figure."""
    kind = "Measurement" if cause.is_measurement else "Cause"
    return f"{kind} {number}. {' or '.join(in_words(name) for name in cause.effects[:3])}" + (
        f" or {count_text(len(cause.effects) - 3, 'other')}" if len(cause.effects) > 3 else ""
    )
