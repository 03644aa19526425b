"""Titles and captions of the figures of a diagnosis."""

from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.report.results import JointResults
from frictioncli.wording import count_text, in_words


def evidence_caption(results: JointResults, *, cause: CauseRecord, fitted: str) -> str:
    """Return the caption of the figure of one cause."""
    return (
        f"{cause.claim} Points: mean misfit of the {cause.channel} in bins, with twice its"
        " standard error over pairs; a point without a bar is a single pair. Left: the base model."
        f" Middle: the extended model without this cause, and the term fitted for it, {fitted};"
        " it may exceed the misfit on the left, where the base model's parameters make up for it."
        " Right: the extended model. The cause stands if the middle points lie on the lines and the"
        " right ones on zero. Bars: which effects could be at work, the credible set in blue."
    )


def simulation_caption(results: JointResults, *, held_out: str | None) -> str:
    """Return the caption of the figure of measured and simulated torque."""
    new = f" Run {held_out} was kept out of the fit." if held_out else ""
    return (
        "Points: measured torque, forward filled, reverse hollow; lines: simulated along the same"
        f" motion by the base model. Below: their difference.{new} Left: mean of each pair over its"
        " angles. Right: means over all pairs of the slowest and the fastest speed shown."
    )


def map_caption(results: JointResults, *, extended: bool) -> str:
    """Return the caption of the residual maps."""
    below = " The lower row of each channel shows the extended model." if extended else ""
    return (
        "Mean of measured minus simulated torque per cell, red where more was measured than"
        " simulated, blue where less; grey: no data. Friction is what opposes the motion, load what"
        f" does not turn with it; each has its own scale, centred at zero.{below} A trend or a"
        " patch is structure; a pattern without order is noise."
    )


def gain_caption(results: JointResults, *, document: DiagnosisDocument) -> str:
    """Return the caption of the distributions of residuals before and after the extension."""
    run = f"run {document.held_out}" if document.held_out else "the data fitted"
    return (
        f"What the simulated torque misses on {run}, both directions, by the base and by the"
        " extended model. Left: how the misfit is distributed. Right: how many points miss by more"
        " than a size. Grey: noise of points and pairs, which no model can predict."
    )


def cause_title(cause: CauseRecord, number: int) -> str:
    """Return the heading of a cause's figure."""
    kind = "Measurement" if cause.is_measurement else "Cause"
    return f"{kind} {number}. {' or '.join(in_words(name) for name in cause.effects[:3])}" + (
        f" or {count_text(len(cause.effects) - 3, 'other')}" if len(cause.effects) > 3 else ""
    )
