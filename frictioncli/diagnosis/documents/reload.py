"""What a diagnosis has seen, rebuilt from the files of a work folder: misfits and fitted terms."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.documents.document import (
    CauseRecord,
    DiagnosisDocument,
    read_diagnoses,
)
from frictioncli.diagnosis.documents.extended_document import read_extended
from frictioncli.diagnosis.documents.extended_model import ExtendedModel, Term
from frictioncli.errors import TableError
from frictioncli.workfiles import DIAGNOSIS, EXTENDED


@dataclass(frozen=True, slots=True, kw_only=True)
class Misfits:
    """What the simulated torque misses in some runs, without and with the extension.

    Attributes
    ----------
    problem : Problem
        The rows, with the base model.
    before, after : dict of str to ndarray
        Measured minus simulated torque per channel, ``friction`` and ``load``, by the base and by
        the extended model without its empirical term. [N·m]
    terms : tuple of Term
        Effects of the extended model, in the order of the causes.
    """

    problem: Problem
    before: dict[str, Array]
    after: dict[str, Array]
    terms: tuple[Term, ...]

    def without(self, number: int, channel: str) -> Array:
        """Return what the extended model misses when one of its terms is taken out [N·m].

        Parameters
        ----------
        number : int
            Place of the term, from 0.
        channel : {"friction", "load"}
            Which channel.
        """
        return self.after[channel] + self.terms[number].of(channel)

    def torque(self, channels: Mapping[str, Array]) -> Array:
        """Return the misfit of the torque, all rows forward, then all in reverse [N·m].

        If the log has a load channel, whose unit may be another, it is that of friction alone.
        """
        friction, load = channels["friction"], channels["load"]
        if self.problem.has_load_channel:
            load = np.zeros_like(load)
        return np.concatenate([load + friction, load - friction])


@dataclass(frozen=True, slots=True, kw_only=True)
class Reloaded:
    """One joint's diagnosis with its data.

    Attributes
    ----------
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    seen : Misfits
        The runs that the diagnosis has learned from.
    new : Misfits or None
        The run that was kept out of it.
    """

    document: DiagnosisDocument
    seen: Misfits
    new: Misfits | None

    @property
    def judged(self) -> Misfits:
        """What the gain was measured on."""
        return self.new or self.seen

    @property
    def causes(self) -> tuple[CauseRecord, ...]:
        """Causes that effects of the catalogue stand for, in the order of the first terms."""
        return self.document.modelled_causes


def read_documents(work: Path) -> dict[int, tuple[DiagnosisDocument, ExtendedModel]]:
    """Return each joint's part of ``diagnosis.json``, and its extended model.

    Without the first there are none.

    Raises
    ------
    TableError
        If a file is damaged, the second is missing, or they do not belong together.
    """
    if not (work / DIAGNOSIS).exists():
        return {}
    diagnoses = read_diagnoses(work / DIAGNOSIS)
    models = read_extended(work / EXTENDED)
    for joint, document in diagnoses.items():
        named = len(document.modelled_causes)
        effects = models[joint].effects if joint in models else ()
        belong = len(effects) >= named and all(one.effect.measurement for one in effects[named:])
        if joint not in models or not belong:
            raise TableError(
                f"{work / EXTENDED}: has {len(effects)} effects of joint {joint}, {DIAGNOSIS} has"
                f" {named} named causes; run 'frictioncli diagnose' again"
            )
    return {joint: (document, models[joint]) for joint, document in diagnoses.items()}


def is_current(document: DiagnosisDocument, torques: pd.DataFrame) -> bool:
    """Return whether a joint's diagnosis is of the runs that its torques have now."""
    known = {*document.runs, *filter(None, [document.held_out])}
    return known == {str(run) for run in torques["run"].unique()}


def reload(torques: pd.DataFrame, document: DiagnosisDocument, extended: ExtendedModel) -> Reloaded:
    """Rebuild what a diagnosis has seen.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    extended : ExtendedModel
        Its extended model.
    """
    seen, new = build_problems(torques, extended.temperature, document.held_out)
    return Reloaded(
        document=document,
        seen=misfits(seen, extended),
        new=None if new is None else _predicted(misfits(new, extended), document),
    )


def _predicted(new: Misfits, document: DiagnosisDocument) -> Misfits:
    """Return the misfits of a new run, on which properties that did not last are not predicted.

    The history of a change already says that it is not there.
    """
    after = dict(new.after)
    for term, cause in zip(new.terms, document.modelled_causes, strict=False):
        if cause.holds_on_new_run is False and term.effect.moments is None:
            after = {channel: values + term.of(channel) for channel, values in after.items()}
    return replace(new, after=after)


def misfits(problem: Problem, extended: ExtendedModel) -> Misfits:
    """Return what the base and the extended model without its empirical term miss of rows.

    Parameters
    ----------
    problem : Problem
        Rows with the base model that the extension started from.
    extended : ExtendedModel
        The joint's extended model.
    """
    before = {"friction": problem.friction_misfit, "load": problem.load_misfit}
    if not extended.effects:
        return Misfits(problem=problem, before=before, after=before, terms=())
    beyond = extended.beyond(problem)
    friction, load = (beyond.friction, beyond.load)
    if beyond.empirical is not None:
        friction, load = friction - beyond.empirical.friction, load - beyond.empirical.load
    after = {"friction": before["friction"] - friction, "load": before["load"] - load}
    return Misfits(problem=problem, before=before, after=after, terms=beyond.terms)
