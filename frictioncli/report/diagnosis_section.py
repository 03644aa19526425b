"""The section of the page on what the simulation gets wrong."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from frictioncli.diagnosis.documents.reload import Reloaded, is_current, read_documents, reload
from frictioncli.report.diagnosis_text import (
    CauseText,
    cause_texts,
    detectable_table,
    evidence_caption,
    gain_caption,
    gain_sentence,
    map_caption,
    section_title,
    simulation_caption,
    unnamed_texts,
    verdict_sentence,
    visible_sentences,
    worst_table,
)
from frictioncli.report.evidence_figure import evidence_figure
from frictioncli.report.figures import FigureSpec
from frictioncli.report.labels import in_words
from frictioncli.report.missing_data import nothing_missing
from frictioncli.report.page_tables import TextTable
from frictioncli.report.residual_maps import residual_map_figure
from frictioncli.report.results import JointResults
from frictioncli.report.simulation_figures import gain_figure, simulation_figure


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisSection:
    """What the page says of one joint's diagnosis.

    Attributes
    ----------
    missing : str
        Why there is nothing to say; empty where there is.
    document : dict or None
        The joint's part of ``diagnosis.json``.
    verdict, gain : str
        The verdict and the worth of the extended model, in words.
    causes, unnamed : tuple of CauseText
        Causes found, and structure that no effect explains.
    visible : tuple of str
        What stands out of the noise but is not worth modelling.
    worst, detectable : TextTable or None
        Where the simulation misses most; how large an effect must be to be found.
    entries : tuple of FigureSpec
        The pictures.
    """

    missing: str = ""
    document: Mapping[str, Any] | None = None
    verdict: str = ""
    causes: tuple[CauseText, ...] = ()
    unnamed: tuple[CauseText, ...] = ()
    visible: tuple[str, ...] = ()
    gain: str = ""
    worst: TextTable | None = None
    detectable: TextTable | None = None
    entries: tuple[FigureSpec, ...] = ()


def diagnosis_sections(work: Path, results: list[JointResults]) -> dict[int, DiagnosisSection]:
    """Return the section of each joint.

    Parameters
    ----------
    work : Path
        The work folder.
    results : list of JointResults
        What the report draws from.

    Raises
    ------
    TableError
        If ``diagnosis.json`` or ``extended-model.json`` is damaged.
    """
    documents = read_documents(work)
    sections = {}
    for joint in results:
        if not documents:
            missing = "The simulation has not been judged yet; 'frictioncli diagnose' does it."
        elif joint.joint not in documents:
            missing = "This joint has no diagnosis; 'frictioncli diagnose' says why."
        elif not is_current(documents[joint.joint][0], joint.torques):
            missing = (
                "The diagnosis is of other runs than those measured; run 'frictioncli diagnose'"
                " again."
            )
        else:
            sections[joint.joint] = section(joint, reload(joint.torques, *documents[joint.joint]))
            continue
        sections[joint.joint] = DiagnosisSection(missing=missing)
    return sections


def section(results: JointResults, recalled: Reloaded) -> DiagnosisSection:
    """Return one joint's section.

    Parameters
    ----------
    results : JointResults
        The joint's results.
    recalled : Reloaded
        Its diagnosis.
    """
    document, unit = recalled.document, results.unit
    worst = worst_table(document, unit)
    return DiagnosisSection(
        document=document,
        verdict=verdict_sentence(document, unit),
        causes=tuple(cause_texts(document, unit)),
        unnamed=tuple(unnamed_texts(document, unit)),
        visible=visible_sentences(document, unit),
        gain=gain_sentence(document, unit),
        worst=worst if worst.rows else None,
        detectable=detectable_table(document, unit),
        entries=tuple(diagnosis_figures(recalled)),
    )


def diagnosis_figures(recalled: Reloaded) -> list[FigureSpec]:
    """Return the pictures of a diagnosis: simulation, maps, one per cause, gain.

    Parameters
    ----------
    recalled : Reloaded
        The diagnosis.
    """
    document = recalled.document
    pictures = [
        _entry(
            "diagnosis-simulation",
            "Measured and simulated torque",
            partial(simulation_caption, held_out=document["held_out"]),
            partial(simulation_figure, recalled=recalled),
        ),
        _entry(
            "diagnosis-maps",
            "Where the simulated torque is wrong",
            partial(map_caption, extended=bool(recalled.seen.terms)),
            partial(residual_map_figure, recalled=recalled),
        ),
    ]
    for number, cause in enumerate(recalled.causes):
        fitted = in_words(recalled.seen.terms[number].effect.name)
        pictures.append(
            _entry(
                f"diagnosis-{number + 1}",
                section_title(cause, number + 1),
                partial(evidence_caption, cause=cause, fitted=fitted),
                partial(evidence_figure, recalled=recalled, number=number),
            )
        )
    if document["gain"] is not None:
        pictures.append(
            _entry(
                "diagnosis-gain",
                "What the extended model is worth",
                partial(gain_caption, document=document),
                partial(gain_figure, recalled=recalled),
            )
        )
    return pictures


def _entry(
    name: str,
    title: str,
    caption: Callable[[JointResults], str],
    draw: Callable[[JointResults], Figure],
) -> FigureSpec:
    return FigureSpec(name=name, title=title, caption=caption, missing=nothing_missing, draw=draw)
