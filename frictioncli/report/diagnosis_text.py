"""Text on a diagnosis: verdict, causes, gain."""

from dataclasses import dataclass, replace

from frictioncli.diagnosis.documents.document import CauseRecord, DiagnosisDocument
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.documents.gain_text import worse_text
from frictioncli.diagnosis.documents.remainder_words import extent, variation
from frictioncli.diagnosis.documents.sentences import (
    alternatives_text,
    chance_text,
    finding_text,
    lasting_text,
    note_text,
    size_text,
    standing_text,
)
from frictioncli.report.effect_explanations import explained
from frictioncli.report.model_section import poorly_determined
from frictioncli.wording import (
    in_words,
    list_text,
    number_text,
    probability_text,
    quantity_text,
)

_NOTABLE_SHARE = 0.01
"""Least probability of another effect that is mentioned. [1]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CauseText:
    """One cause as the page states it.

    Attributes
    ----------
    effects : str
        Effects that may be the cause, with their probabilities.
    kind : str
        What it is a property of: friction, load, or the measurement.
    size : str
        RMS of the fitted term with its interval, where it shows and what the base model leaves.
    p_value : str
        Probability that noise alone would give as much.
    standing : str
        Why it is not named, if it is not.
    doubt : str
        Which of its parameters are poorly determined; empty if none is.
    against : tuple of str
        What speaks against it.
    figure : str
        Name of the figure of its evidence; empty without one.
    explained : tuple of (str, str)
        Name and words of those of its effects that the page explains.
    finding, lasting, note : str
        The cause in a sentence with values; whether it lasts, empty where that cannot be tested;
        what is said of it though it is not named, empty for most.
    claim, equation, parameters, experiment : str
        What was seen, the term and its fitted parameters, and what to measure next. The equation
        is empty if no effect explains the structure.
    """

    effects: str
    kind: str
    size: str
    p_value: str
    standing: str
    doubt: str
    against: tuple[str, ...]
    figure: str
    explained: tuple[tuple[str, str], ...]
    finding: str
    lasting: str
    note: str
    claim: str
    equation: str
    parameters: str
    experiment: str


def verdict_sentence(document: DiagnosisDocument, unit: str) -> str:
    """Return the verdict in sentences.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    unit : str
        Unit of torque.
    """
    misfit = (
        f"The simulated torque differs from the measured one by"
        f" {number_text(document.simulation.rmse)} {unit} (RMS,"
        f" {list_text(document.runs)})."
    )
    if document.verdict == "no_evidence":
        found = (
            "No cause is named; the list below has what was detected, and why it is not named."
            if document.visible
            else "No cause was found: no known effect and no other structure. The table below has"
            " the smallest size of each effect that would have been named."
        )
        return _joined(misfit, found)
    named, lost, measured = (
        [cause for cause in document.named_causes if wanted(cause)]
        for wanted in (
            lambda cause: not cause.is_measurement and cause.holds_on_new_run is not False,
            lambda cause: not cause.is_measurement and cause.holds_on_new_run is False,
            lambda cause: cause.is_measurement,
        )
    )
    sentences = []
    certain = [in_words(cause.effects[0]) for cause in named if len(cause.effects) == 1]
    if certain:
        sentences.append(f"The model lacks {list_text(certain)}.")
    sentences += [
        f"The model lacks one of {list_text([in_words(name) for name in cause.effects])}: these"
        " data cannot distinguish them."
        for cause in named
        if len(cause.effects) > 1
    ]
    sentences += [
        f"{alternatives_text(cause).capitalize()}: {_lower(lasting_text(cause, document))}"
        for cause in lost
    ]
    sentences += [f"Measurement: {_lower(finding_text(cause))}" for cause in measured]
    if document.verdict == "unnamed":
        also = " also" if sentences else ""
        sentences.append(f"There is{also} structure that no known effect explains.")
    return _joined(misfit, *sentences)


def _joined(*sentences: str) -> str:
    return " ".join(sentence for sentence in sentences if sentence)


def _lower(sentence: str) -> str:
    return sentence[:1].lower() + sentence[1:]


def cause_texts(document: DiagnosisDocument) -> list[CauseText]:
    """Return the causes that effects of the catalogue explain, strongest first."""
    return [_cause(cause, document) for cause in document.named_causes]


def unnamed_texts(document: DiagnosisDocument) -> list[CauseText]:
    """Return the structure that no effect of the catalogue explains."""
    return [_cause(cause, document) for cause in document.causes if not cause.effects]


def visible_texts(document: DiagnosisDocument) -> list[CauseText]:
    """Return what was found and is not named, with the reason."""
    return [
        replace(_cause(cause, document), effects=alternatives_text(cause))
        for cause in document.visible
    ]


def _cause(cause: CauseRecord, document: DiagnosisDocument) -> CauseText:
    probabilities = cause.probabilities
    return CauseText(
        effects=" or ".join(
            f"{in_words(name)} {probability_text(probabilities[name])}"
            if name in probabilities
            else in_words(name)
            for name in cause.effects
        ),
        kind=cause.kind or cause.channel,
        size=size_text(cause, document),
        p_value=chance_text(cause),
        # reasons of the search name effects as files do
        standing=in_words(standing_text(cause)),
        doubt=poorly_determined(dict(cause.parameters)),
        against=tuple(_against(cause, document)),
        figure=(cause.figure or "").removesuffix(".svg"),
        explained=tuple((name, in_words(name)) for name in explained(cause.effects)),
        finding=finding_text(cause),
        lasting=lasting_text(cause, document),
        note=note_text(cause),
        claim=cause.claim,
        equation=cause.equation,
        parameters="; ".join(_parameter(name, stated) for name, stated in cause.parameters.items()),
        experiment=cause.experiment,
    )


def _against(cause: CauseRecord, document: DiagnosisDocument) -> list[str]:
    """Return what speaks against a cause, or leaves it open."""
    found = []
    others = [
        f"{in_words(name)} {probability_text(share)}"
        for name, share in cause.probabilities.items()
        if name not in cause.effects and share >= _NOTABLE_SHARE
    ]
    if others:
        found.append(f"Other effects are possible: {', '.join(others)}.")
    if len(cause.effects) > 1:
        found.append("These data cannot distinguish the effects of the set.")
    if cause.holds_on_new_run is None:
        found.append("It could not be tested on a run that was not used for fitting.")
    elif not cause.holds_on_new_run:
        found.append(f"It does not appear on the held-out run ({document.held_out}).")
    if doubt := poorly_determined(dict(cause.parameters)):
        found.append(f"Its parameters are not all well determined: {doubt}.")
    gain = document.gain
    if gain is not None and gain.ci95[0] <= 0:
        found.append("The extended model is not clearly better than the base model.")
    left = document.remainder
    if left is not None and left.channel == cause.channel:
        how = f", {variation(left)}" if extent(left) else ""
        found.append(
            f"Even with it, {number_text(left.size, 2)} {document.unit_of(left.channel)} remain"
            f" unexplained{how}: its true form may differ."
        )
    return found


def _parameter(name: str, stated: ParameterRecord) -> str:
    if stated.has_only_a_sign:
        return f"{in_words(name)} not determined"
    return f"{in_words(name)} {quantity_text(stated.estimate, stated.ci95, stated.unit)}"


def gain_sentence(document: DiagnosisDocument, unit: str) -> str:
    """Return the gain by the extended model in sentences; empty if no cause was found.

    Parameters
    ----------
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    unit : str
        Unit of torque.
    """
    gain = document.gain
    if gain is None:
        return ""
    low, high = gain.ci95
    if gain.basis == "new_run":
        where = f"On run {document.held_out}, which was not used for fitting,"
    elif document.held_out is not None:
        where = f"On run {document.held_out}, where a change was found and fitted,"
    else:
        where = "On its own training data,"
    text = (
        f"{where} the torque error of the extended model is {number_text(gain.rmse_after)}"
        f" {unit} (RMS) instead of {number_text(gain.rmse_before)} {unit}:"
        f" {_reduction_text(gain.reduction)} (95 % interval: {_reduction_text(low)} to"
        f" {_reduction_text(high)}). Noise, which no model can predict, is"
        f" {number_text(gain.noise_floor)} {unit}."
    )
    if gain.basis != "new_run":
        further = "a second" if document.held_out is None else "another"
        text += f" A gain on its own training data is optimistic; log {further} run to test it."
    if worse := worse_text(gain, unit):
        text += f" {worse}"
    elif low <= 0:
        text += " The interval includes zero: the extended model may be no better."
    return text


def _reduction_text(reduction: float) -> str:
    return f"{100 * reduction:.0f} % less" if reduction >= 0 else f"{-100 * reduction:.0f} % more"
