"""What is open after a diagnosis: rivals for the same misfit, each fitted to all data at hand."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.diagnosis.fit.columns import hypothesis_of
from frictioncli.diagnosis.fit.judgement import Score
from frictioncli.diagnosis.noise.significance import probabilities
from frictioncli.diagnosis.search.precomputed import Catalogue, Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from frictioncli.effects.availability import missing_columns
from frictioncli.model.noise import Noise

_MOST = 5
"""Rivals of one question, at most; the least likely of longer sets are left out."""

_MOST_OTHERS = 8
"""Effects at most that the rivals are easily taken for, though not by the data at hand."""

_THINKABLE = 0.01
"""An effect outside a set that is as likely as this is a rival, too."""

_WANDERING = 0.007
_WANDERING_TIME = 1200.0
"""Friction of a joint is taken to wander by this share of it in this time [s], even where a thin
experiment shows less: what a rival explains in it may be wandering, too."""


@dataclass(frozen=True, slots=True)
class Rival:
    """An effect that may be the cause, fitted to the data at hand.

    Attributes
    ----------
    score : Score
        The effect with its shape and coefficients.
    evidence : float
        Logarithm of its Bayes factor.
    """

    score: Score
    evidence: float

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.score.effect.name


@dataclass(frozen=True, slots=True)
class Question:
    """Which of some effects is the cause.

    Attributes
    ----------
    rivals : tuple of Rival
        Effects that may be the cause.
    others : tuple of Rival
        Effects that the data at hand speak against, but which more data might be taken for.
    """

    rivals: tuple[Rival, ...]
    others: tuple[Rival, ...] = ()

    @property
    def probabilities(self) -> dict[str, float]:
        """Probability of each rival by all data at hand."""
        return probabilities({rival.name: rival.evidence for rival in self.rivals})

    @property
    def leading(self) -> Rival:
        """The most likely rival."""
        return max(self.rivals, key=lambda rival: rival.evidence)


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenQuestions:
    """Where a plan starts from.

    Attributes
    ----------
    settled : tuple of Score
        Causes with a single name.
    questions : tuple of Question
        Causes whose name is open.
    noise : (Noise, Noise)
        Noise of friction and load with the likeliest causes in place. [N·m]
    """

    settled: tuple[Score, ...]
    questions: tuple[Question, ...]
    noise: tuple[Noise, Noise]

    @property
    def causes(self) -> tuple[Score, ...]:
        """Settled causes, and the likeliest of each question."""
        return (*self.settled, *(question.leading.score for question in self.questions))


def open_questions(
    problem: Problem, document: Mapping[str, Any], extended: ExtendedModel
) -> OpenQuestions:
    """Return what is open after a diagnosis.

    The rivals are refitted: to the run that the diagnosis kept out, too.

    Parameters
    ----------
    problem : Problem
        All data at hand.
    document : mapping
        The joint's part of ``diagnosis.json``.
    extended : ExtendedModel
        Its extended model.
    """
    bench = Precomputed.of(problem)
    named = [cause for cause in document["causes"] if cause["effects"]]
    scores = [
        Score(one.effect, dict(one.shape), one.coefficients, np.zeros((0, 0)), 0.0)
        for one in extended.effects
    ]
    settled = [
        score for cause, score in zip(named, scores, strict=True) if len(cause["effects"]) == 1
    ]
    questions = []
    for number, cause in enumerate(named):
        if len(cause["effects"]) == 1:
            continue
        others = [score for place, score in enumerate(scores) if place != number]
        thinkable = [n for n, share in cause["probabilities"].items() if share >= _THINKABLE]
        names = list(dict.fromkeys([*cause["effects"], *thinkable]))
        asked = _question(Step.of(bench, others), names[:_MOST])
        if len(asked.rivals) > 1:
            questions.append(asked)
        else:
            settled += [rival.score for rival in asked.rivals]
    likeliest = [*settled, *(question.leading.score for question in questions)]
    friction, load = Step.of(bench, likeliest).noise()
    return OpenQuestions(
        settled=tuple(settled),
        questions=tuple(questions),
        noise=(_wandering(friction, float(np.mean(np.abs(problem.friction)))), load),
    )


def _wandering(noise: Noise, friction: float) -> Noise:
    """Return noise that drifts at least as friction of a mean [N·m] is taken to wander."""
    least = _WANDERING * friction
    if noise.drift >= least:
        return noise
    return replace(noise, drift=least, drift_time=max(noise.drift_time, _WANDERING_TIME))


def _question(step: Step, names: Sequence[str]) -> Question:
    """Return the rivals of these names and what they are easily taken for, fitted."""
    problem = step.problem
    taken_for = [other for name in names for other in BY_NAME[name].confounders]
    known = {*names, *(one.effect.name for one in step.accepted)}
    others = [name for name, _ in Counter(taken_for).most_common() if name not in known]
    effects = [BY_NAME[name] for name in [*names, *others[:_MOST_OTHERS]]]
    able = [effect for effect in effects if not missing_columns(effect, problem.table)]
    hypotheses = [hypothesis_of(effect, problem) for effect in able]
    judged = step.judged(Catalogue.of(step.bench, hypotheses), seed=0, draws=0)
    rivals = []
    for effect in able:
        one = judged[effect.name]
        score = step.refined(one.score(effect))
        bonus = max(score.statistic - one.statistic, 0.0) / 2
        rivals.append(Rival(score, one.evidence + bonus))
    return Question(
        tuple(rival for rival in rivals if rival.name in names),
        tuple(rival for rival in rivals if rival.name not in names),
    )
