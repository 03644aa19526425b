"""Motion of other joints as ``diagnosis.json`` states it: a property of the log.

It is no effect that is fitted: the rows are left out before (:mod:`frictioncli.pairs.other_joints`)
and what the motion adds to the torque is measured there
(:mod:`frictioncli.pairs.added_torque`).
"""

from collections.abc import Mapping
from typing import Any

from msgspec import structs

from frictioncli.diagnosis.documents.document import (
    OTHER_JOINT,
    CauseRecord,
    DiagnosisDocument,
)
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.wording import count_text, list_text, number_text, thousands_text

_CLAIM = (
    "While another joint moves, its inertia and the weight that it carries load this joint, too:"
    " that is neither friction nor a load that depends on the angle."
)
_EXPERIMENT = (
    "Keep the other joints still while this one moves: start the log when they have arrived, or"
    " move one joint at a time."
)


def with_other_joint(
    document: DiagnosisDocument, motion: Mapping[str, Any] | None
) -> DiagnosisDocument:
    """Return a diagnosis that says what the motion of other joints does.

    It is a cause where the torque that it adds is beyond doubt above the margin, else among what is
    visible. Where the log does not have the positions of other joints, nothing is said.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's diagnosis.
    motion : mapping or None
        What ``pair`` knows of the motion of other joints; None where none moves.
    """
    if motion is None or document.margin is None:
        return document
    record = _record(document, motion, document.margin)
    if record.standing != "named":
        return structs.replace(document, visible=(*document.visible, record))
    place = len(document.named_causes)
    causes = (*document.causes[:place], record, *document.causes[place:])
    verdict = "named" if document.verdict == "no_evidence" else document.verdict
    return structs.replace(document, causes=causes, verdict=verdict)


def _record(document: DiagnosisDocument, motion: Mapping[str, Any], margin: float) -> CauseRecord:
    size, interval = motion.get("torque"), motion.get("ci95")
    p_value = motion.get("p_value", 1.0)
    standing, reason = _standing(interval, p_value, margin, document.settings.alpha)
    parameters = {
        "samples": ParameterRecord(estimate=motion["samples"], ci95=None, unit="1"),
        "time": ParameterRecord(estimate=motion["seconds"], ci95=None, unit="s"),
        "moves": ParameterRecord(estimate=motion["moves"], ci95=None, unit="1"),
        "share": ParameterRecord(estimate=motion["share"], ci95=None, unit="1"),
    }
    if size is not None and interval is not None:
        ends = (float(interval[0]), float(interval[1]))
        stated = ParameterRecord(estimate=size, ci95=ends, unit=document.torque_unit)
        parameters = {"torque": stated} | parameters
    return CauseRecord(
        kind="measurement",
        standing=standing,
        reason=reason,
        effects=(OTHER_JOINT,),
        probabilities={OTHER_JOINT: 1.0},
        # a load channel of its own does not hold it: there it is in what is taken as friction
        channel="load" if document.load_unit is None else "friction",
        statement=_statement(motion),
        claim=_CLAIM,
        equation="du = torque that the motion of other joints needs",
        parameters=parameters,
        size=size,
        size_ci95=None if interval is None else (float(interval[0]), float(interval[1])),
        p_value=p_value,
        seen_in="time",
        figure=None,
        experiment=_EXPERIMENT,
    )


def _standing(
    interval: tuple[float, float] | None, p_value: float, margin: float, alpha: float
) -> tuple[str, str]:
    """Return what may be said of the torque that is added, and why it is not named."""
    if interval is None:
        return "undetermined", (
            "too few moves with another joint moving lie between equal moves without"
        )
    low, high = interval
    if low > margin and p_value < alpha:
        return "named", ""
    if high < margin:
        return "negligible", f"they add less than the margin of {margin:.2g}"
    return "undetermined", f"they may add less than the margin of {margin:.2g}"


def _statement(motion: Mapping[str, Any]) -> str:
    joints = list_text([str(joint) for joint in motion["joints"]])
    if not joints:
        subject, verb = "Other joints", "move"
    elif len(motion["joints"]) == 1:
        subject, verb = f"Joint {joints}", "moves"
    else:
        subject, verb = f"Joints {joints}", "move"
    amount = (
        f"{thousands_text(motion['samples'])} samples, {number_text(motion['seconds'], 3)} s in"
        f" {count_text(motion['moves'], 'move')}"
    )
    what = (
        f"{subject} {verb} during {number_text(100 * motion['share'], 2)} % of the motion of this"
        f" joint at constant speed ({amount})"
    )
    return f"{what}: left out." if motion["left_out"] else f"{what}: used nonetheless."
