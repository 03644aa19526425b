"""First screen of the page: how much friction, how sure, what is wrong, what to do next."""

from dataclasses import dataclass

import numpy as np
from msgspec import UNSET

from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.remainder_words import extent, variation
from frictioncli.diagnosis.documents.sentences import alternatives_text
from frictioncli.model.document import PARAMETERS
from frictioncli.report.labels import PARAMETER_SYMBOLS
from frictioncli.report.operating_point import operating_point
from frictioncli.report.results import JointResults
from frictioncli.wording import duration_text, list_text, number_text, range_text

_MOST_BLOCKS = 2
"""Blocks of the next experiment that are named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """An answer of the first screen.

    Attributes
    ----------
    question : str
        The question.
    value : str
        The answer in a few words, which are emphasised.
    text : str
        What is needed to read it.
    """

    question: str
    value: str
    text: str


def answers(results: JointResults) -> list[Answer]:
    """Return the four answers of the first screen, together under sixty words for most joints.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    document = results.diagnosis.document if results.diagnosis else None
    return [
        _how_much(results),
        _how_sure(results, document),
        _what_is_wrong(document),
        _what_next(results, document),
    ]


def _how_much(results: JointResults) -> Answer:
    point = operating_point(results)
    measured = results.pairs["friction_torque"].to_numpy(float)
    span = range_text([number_text(float(f(measured))) for f in (np.nanmin, np.nanmax)])
    return Answer(
        question="How much",
        value=f"{number_text(point.friction)} {results.unit}",
        text=f"unloaded, at {point.motion}; all pairs {span} {results.unit}",
    )


def _how_sure(results: JointResults, document: DiagnosisDocument | None) -> Answer:
    unit = results.unit
    gain = document.gain if document else None
    if gain is None:
        return Answer(
            question="How sure",
            value=f"±{number_text(results.model.rmse)} {unit}",
            text="RMS misfit, equation (16)",
        )
    where = "on its own training data"
    if document and gain.basis == "new_run":
        where = f"tested on {document.held_out}"
    if gain.ci95[0] <= 0:
        return Answer(
            question="How sure",
            value=f"±{number_text(gain.rmse_before)} {unit}",
            text=f"RMS misfit, equation (16), {where}",
        )
    return Answer(
        question="How sure",
        value=f"±{number_text(gain.rmse_before)} {unit}",
        text=f"RMS misfit, equation (16); extended model ±{number_text(gain.rmse_after)} {unit},"
        f" {where}",
    )


def _what_is_wrong(document: DiagnosisDocument | None) -> Answer:
    question = "What the simulation gets wrong"
    if document is None:
        return Answer(
            question=question, value="not diagnosed yet", text="run 'frictioncli diagnose'"
        )
    named = [alternatives_text(cause) for cause in document.modelled_causes]
    left = document.remainder
    rest = ""
    if left:
        along = f", {variation(left)}" if extent(left) else ""
        if document.structure is not None:
            axes = ["angle" if axis == "position" else axis for axis in document.structure.axis]
            along = f", structure over {list_text(axes)}"
        rest = f"{number_text(left.size, 2)} {document.torque_unit} unexplained{along}"
    if named:
        if document.verdict == "unnamed":
            named.append("structure without a name")
        return Answer(question=question, value=list_text(named), text=rest)
    if document.verdict == "unnamed":
        return Answer(question=question, value="structure without a name", text=rest)
    return Answer(question=question, value="no cause named", text=rest)


def _what_next(results: JointResults, document: DiagnosisDocument | None) -> Answer:
    question = "What to do next"
    plan = results.plan
    if plan is not None and plan.verdict is not None:
        names = list(dict.fromkeys(block.name for block in plan.programme.blocks))
        more = " …" if len(names) > _MOST_BLOCKS else ""
        check = "" if plan.check is UNSET or not plan.check.blocks else ", then a check next day"
        return Answer(
            question=question,
            value=f"measure {duration_text(plan.programme.duration_s)}",
            text=f"{', '.join(names[:_MOST_BLOCKS])}{more}{check}",
        )
    if document is None:
        return Answer(question=question, value="diagnose", text="")
    gain = document.gain
    if gain is not None and gain.ci95[0] > 0:
        if gain.basis == "new_run":
            return Answer(
                question=question,
                value="use the extended model",
                text="then 'frictioncli plan'",
            )
        return Answer(
            question=question,
            value="test on a new run",
            text="",
        )
    unknown = [
        PARAMETER_SYMBOLS[name]
        for name in PARAMETERS
        if not results.model.parameters[name].determined
    ]
    if document.verdict == "no_evidence" and not unknown:
        return Answer(question=question, value="use equation (16)", text="")
    lacking = f"{list_text(unknown)} not determined; " if unknown else ""
    return Answer(
        question=question,
        value="measure more",
        text=f"{lacking}'frictioncli plan' proposes what",
    )


def word_count(found: list[Answer]) -> int:
    """Return the number of words of the questions and answers.

    Parameters
    ----------
    found : list of Answer
        The answers.

    Examples
    --------
    >>> word_count([Answer(question="How much", value="69 N·m", text="at 40 °C")])
    7
    """
    return sum(len(f"{one.question} {one.value} {one.text}".split()) for one in found)
