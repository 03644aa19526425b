"""Section of the page on the diagnosis: text, tables, and the list of its figures."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

from matplotlib.figure import Figure

from frictioncli.diagnosis.documents.reload import Reloaded
from frictioncli.diagnosis.documents.remainder_words import remainder_text
from frictioncli.diagnosis.documents.sentences import (
    empirical_text,
    left_out_text,
    margin_text,
)
from frictioncli.report.challenge_section import PlantedText, planted_text
from frictioncli.report.diagnosis_captions import (
    cause_title,
    evidence_caption,
    gain_caption,
    map_caption,
    simulation_caption,
)
from frictioncli.report.diagnosis_tables import detectable_table, worst_table
from frictioncli.report.diagnosis_text import (
    CauseText,
    cause_texts,
    gain_sentence,
    unnamed_texts,
    verdict_sentence,
    visible_texts,
)
from frictioncli.report.evidence_figure import evidence_figure
from frictioncli.report.experiment import experiment_sentence
from frictioncli.report.figures import FigureSpec
from frictioncli.report.missing_data import nothing_missing
from frictioncli.report.page_tables import TextTable
from frictioncli.report.residual_maps import residual_map_figure
from frictioncli.report.results import JointResults
from frictioncli.report.simulation_figures import gain_figure, simulation_figure
from frictioncli.wording import in_words


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosisSection:
    """Text and tables on one joint's diagnosis.

    Attributes
    ----------
    missing : str
        Why there is no diagnosis; empty if there is one.
    verdict, gain : str
        The verdict and the gain by the extended model, in words.
    remainder : str
        What the extended model leaves on a new run, in words; empty where that is noise.
    empirical : str
        What its empirical term gains and where it is valid, in words; empty without one.
    causes, unnamed, visible : tuple of CauseText
        Causes that are named, structure that no effect of the catalogue explains, and what was
        found and is not named.
    margin : str
        The smallest size worth a name, in words.
    left_out : str
        What the diagnosis has not used; may be empty.
    worst, detectable : TextTable or None
        Largest misfits of the simulation; smallest size at which each effect would be found.
    planted : PlantedText
        What the diagnosis said of effects that were planted in these logs.
    """

    missing: str = ""
    verdict: str = ""
    causes: tuple[CauseText, ...] = ()
    unnamed: tuple[CauseText, ...] = ()
    visible: tuple[CauseText, ...] = ()
    remainder: str = ""
    empirical: str = ""
    margin: str = ""
    left_out: str = ""
    gain: str = ""
    worst: TextTable | None = None
    detectable: TextTable | None = None
    planted: PlantedText = field(default_factory=PlantedText)


def diagnosis_section(results: JointResults) -> DiagnosisSection:
    """Return the text and tables on one joint's diagnosis.

    Parameters
    ----------
    results : JointResults
        The joint's results.
    """
    if results.diagnosis is None:
        return DiagnosisSection(missing=results.diagnosis_missing)
    document, unit = results.diagnosis.document, results.unit
    worst = worst_table(document)
    planned = experiment_sentence(results)
    return DiagnosisSection(
        verdict=verdict_sentence(document, unit),
        causes=tuple(
            replace(cause, experiment=planned or cause.experiment)
            for cause in cause_texts(document)
        ),
        unnamed=tuple(unnamed_texts(document)),
        visible=tuple(visible_texts(document)),
        remainder=remainder_text(document),
        empirical=empirical_text(document),
        margin=margin_text(document),
        left_out=left_out_text(document),
        gain=gain_sentence(document, unit),
        worst=worst if worst.rows else None,
        detectable=detectable_table(document, unit),
        planted=planted_text(results.challenge),
    )


def diagnosis_figures(diagnosis: Reloaded | None) -> list[FigureSpec]:
    """Return the figures of a diagnosis: simulation, maps, one per cause, gain.

    Parameters
    ----------
    diagnosis : Reloaded or None
        The diagnosis, if there is one.
    """
    if diagnosis is None:
        return []
    document = diagnosis.document
    figures = [
        _figure(
            "diagnosis-simulation",
            "Measured and simulated torque",
            partial(simulation_caption, held_out=document.held_out),
            partial(simulation_figure, diagnosis=diagnosis),
        ),
        _figure(
            "diagnosis-maps",
            "Where the simulated torque is wrong",
            partial(map_caption, extended=bool(diagnosis.seen.terms)),
            partial(residual_map_figure, diagnosis=diagnosis),
            printed=True,
        ),
    ]
    for index, cause in enumerate(diagnosis.causes):
        fitted = in_words(diagnosis.seen.terms[index].effect.name)
        figures.append(
            _figure(
                f"diagnosis-{index + 1}",
                cause_title(cause, index + 1),
                partial(evidence_caption, cause=cause, fitted=fitted),
                partial(evidence_figure, diagnosis=diagnosis, index=index),
                printed=True,
            )
        )
    if document.gain is not None:
        figures.append(
            _figure(
                "diagnosis-gain",
                "Benefit of the extended model",
                partial(gain_caption, document=document),
                partial(gain_figure, diagnosis=diagnosis, floor=document.gain.noise_floor),
            )
        )
    return figures


def _figure(
    name: str,
    title: str,
    caption: Callable[[JointResults], str],
    draw: Callable[[JointResults], Figure],
    *,
    printed: bool = False,
) -> FigureSpec:
    return FigureSpec(
        name=name,
        title=title,
        caption=caption,
        missing=nothing_missing,
        draw=draw,
        printed=printed,
    )
