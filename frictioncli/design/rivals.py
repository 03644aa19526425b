"""Rival explanations that a diagnosis leaves open, fitted to all observed rows."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.diagnosis.fit.hypotheses import EffectFit, hypothesis_of
from frictioncli.diagnosis.noise.significance import posterior_probabilities
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import missing_columns
from frictioncli.model.noise import Noise

_MOST_RIVALS = 5
"""Greatest number of rivals of one question; the least likely are left out."""

_MOST_CONFOUNDERS = 8
"""Greatest number of confounders of one question."""

_LEAST_PROBABILITY = 0.01
"""An effect outside the credible set is a rival from this probability on."""

_DRIFT_SHARE = 0.007
_DRIFT_TIME = 1200.0
"""Least drift of friction as a share of it, and its time constant [s].

A short experiment may show less; but what a rival explains there may be drift."""


@dataclass(frozen=True, slots=True)
class Rival:
    """An effect that may be the cause, fitted to the observed rows.

    Attributes
    ----------
    fit : EffectFit
        The effect with its shape and coefficients.
    evidence : float
        Log Bayes factor against the base model.
    """

    fit: EffectFit
    evidence: float

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.fit.effect.name


@dataclass(frozen=True, slots=True)
class Question:
    """Which of several rivals is the cause.

    Attributes
    ----------
    rivals : tuple of Rival
        Effects that may be the cause.
    confounders : tuple of Rival
        Effects easily confused with the rivals. The observed rows speak against them, but more rows
        might not.
    """

    rivals: tuple[Rival, ...]
    confounders: tuple[Rival, ...] = ()

    @property
    def probabilities(self) -> dict[str, float]:
        """Posterior probability of each rival by name."""
        return posterior_probabilities({rival.name: rival.evidence for rival in self.rivals})

    @property
    def leading(self) -> Rival:
        """The most likely rival."""
        return max(self.rivals, key=lambda rival: rival.evidence)


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenQuestions:
    """What is settled and what is open after a diagnosis.

    Attributes
    ----------
    settled : tuple of EffectFit
        Causes with a single name.
    questions : tuple of Question
        Causes with several possible names.
    noise : (Noise, Noise)
        Noise of friction and of load beside the likeliest causes. [N·m]
    """

    settled: tuple[EffectFit, ...]
    questions: tuple[Question, ...]
    noise: tuple[Noise, Noise]

    @property
    def causes(self) -> tuple[EffectFit, ...]:
        """Settled causes and the likeliest rival of each question."""
        return (*self.settled, *(question.leading.fit for question in self.questions))


def open_questions_of(
    problem: Problem, document: DiagnosisDocument, extended: ExtendedModel
) -> OpenQuestions:
    """Return what is open after a diagnosis.

    The rivals are fitted to all runs, also to the hold-out run of the diagnosis.

    Parameters
    ----------
    problem : Problem
        All observed rows.
    document : DiagnosisDocument
        The joint's part of ``diagnosis.json``.
    extended : ExtendedModel
        Its extended model.

    Returns
    -------
    OpenQuestions
        Settled causes, questions and noise.
    """
    precomputed = Precomputed.of(problem)
    named = document.modelled_causes
    fits = [
        EffectFit(one.effect, dict(one.shape), one.coefficients, np.zeros((0, 0)), 0.0)
        for one in extended.effects
    ]
    settled = [fit for cause, fit in zip(named, fits, strict=False) if len(cause.effects) == 1]
    # effects of the measurement that are corrected without a name follow the causes
    settled += fits[len(named) :]
    questions = []
    for number, cause in enumerate(named):
        if len(cause.effects) == 1:
            continue
        others = [fit for place, fit in enumerate(fits) if place != number]
        likely = [n for n, share in cause.probabilities.items() if share >= _LEAST_PROBABILITY]
        names = list(dict.fromkeys([*cause.effects, *likely]))
        question = _fit_rivals(Step.of(precomputed, others), names[:_MOST_RIVALS])
        if len(question.rivals) > 1:
            questions.append(question)
        else:
            settled += [rival.fit for rival in question.rivals]
    causes = [*settled, *(question.leading.fit for question in questions)]
    friction, load = Step.of(precomputed, causes).noise()
    return OpenQuestions(
        settled=tuple(settled),
        questions=tuple(questions),
        noise=(_with_least_drift(friction, float(np.mean(np.abs(problem.friction)))), load),
    )


def _with_least_drift(noise: Noise, friction: float) -> Noise:
    """Return noise with at least the usual drift of a mean friction torque [N·m]."""
    least = _DRIFT_SHARE * friction
    if noise.drift >= least:
        return noise
    return replace(noise, drift=least, drift_time=max(noise.drift_time, _DRIFT_TIME))


def _fit_rivals(step: Step, names: Sequence[str]) -> Question:
    """Return the rivals of these names and their confounders, fitted."""
    problem = step.problem
    confused = [other for name in names for other in BY_NAME[name].confounders]
    known = {*names, *(one.effect.name for one in step.accepted)}
    confounders = [name for name, _ in Counter(confused).most_common() if name not in known]
    effects = [BY_NAME[name] for name in [*names, *confounders[:_MOST_CONFOUNDERS]]]
    available = [effect for effect in effects if not missing_columns(effect, problem.table)]
    hypotheses = [hypothesis_of(effect, problem) for effect in available]
    tests = step.tested(Catalogue.of(step.precomputed, hypotheses))
    rivals = []
    for effect in available:
        test = tests[effect.name]
        fit = step.refined(test.effect_fit(effect))
        rivals.append(Rival(fit, test.refined_log_bayes_factor(fit)))
    return Question(
        tuple(rival for rival in rivals if rival.name in names),
        tuple(rival for rival in rivals if rival.name not in names),
    )
