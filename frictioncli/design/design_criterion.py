"""What a programme is expected to do: questions decided, intervals narrowed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.design.d_optimality import log_determinant
from frictioncli.design.decision_probability import chances, decided, margins
from frictioncli.design.discrimination import Discrimination, discriminations
from frictioncli.design.information import Information
from frictioncli.design.precision import Precision, precision
from frictioncli.design.predicted_rows import PlannedJoint, foreseen, together
from frictioncli.design.rivals import OpenQuestions
from frictioncli.design.steps import Step
from frictioncli.diagnosis.data.problem import Problem, simulated
from frictioncli.diagnosis.fit.columns import left_of_base, main_channel
from frictioncli.model.document import PARAMETERS

PLANNED = "~"
"""Added to the name of the last run: the planned one comes after it."""

_THERMAL = ("gamma", "delta")
"""Parameters that no experiment tells where the motor temperature is not known."""

WIDE = 0.2
"""An interval whose half is more than this share of the estimate is wide."""

_ENOUGH = 15.0
"""Margin of the odds' logarithm beyond which more is worth nothing."""

_PULL = 0.3
_NARROW = 0.01
_SPREAD = 0.004
_SPREAD_ALONE = 0.02
"""Weights of evidence beyond what decides, where it is enough; per nat, of precision, and of rows
that spread over all inputs, beside open questions and beside precision: a plan should meet what no
one thought of."""

_LOOSE = 10.0
"""How many times its usual size a parameter may have before any data."""

_USUAL_DELTA = 0.05
"""A usual rate of the fall with temperature. [1/°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignCriterion:
    """One joint's open questions and wide intervals, and what programmes do about them.

    Attributes
    ----------
    joint : PlannedJoint
        The joint.
    opening : OpenQuestions
        What is open.
    unnamed : bool
        Whether there is structure that no effect explains.
    before : Information
        The rows at hand.
    apart : tuple of Discrimination
        How far apart the rivals of each question are in them.
    precision : Precision
        Covariance of all parameters by them.
    matter : tuple of str
        Parameters whose intervals are wide.
    """

    joint: PlannedJoint
    opening: OpenQuestions
    unnamed: bool
    before: Information
    apart: tuple[Discrimination, ...]
    precision: Precision
    matter: tuple[str, ...]

    @classmethod
    def of(cls, joint: PlannedJoint, opening: OpenQuestions, *, unnamed: bool) -> "DesignCriterion":
        """Return the outlook on one joint's data at hand."""
        problem = _problem(joint, joint.torques)
        before = Information(problem, opening.noise, problem.whole)
        names, prior = _names(opening, before.problem), _prior(joint, opening, before.problem)
        whole = precision(before, opening, prior, names, _told(names))
        values = _estimates(joint, opening)
        wide = tuple(
            name
            for name, half in whole.half_widths.items()
            if half > WIDE * abs(values[name]) and (joint.warmth or name not in _THERMAL)
        )
        return cls(
            joint=joint,
            opening=opening,
            unnamed=unnamed,
            before=before,
            apart=_apart(before, opening),
            precision=whole,
            matter=wide or PARAMETERS,
        )

    @property
    def estimates(self) -> Mapping[str, float]:
        """Estimates of the parameters by name: the base's, and causes' as ``effect.name``."""
        return _estimates(self.joint, self.opening)

    def after(self, *days: Sequence[Step]) -> Information:
        """Return the rows at hand together with those that steps, day after day, would add."""
        last = str(self.joint.torques["run"].max())
        runs = [
            foreseen(self.joint, steps, f"{last}{PLANNED * number}")[0]
            for number, steps in enumerate(days, 1)
        ]
        new = pd.concat([run for run in runs if len(run)] or runs[:1], ignore_index=True)
        problem = _problem(self.joint, together(self.joint.torques, new))
        travel = problem.whole.travel.copy()
        if len(new):
            travel[-len(new) :] = new["way"]
        at_hand = len(self.before.problem.layout.bins) / len(problem.layout.bins)
        whole = replace(problem.whole, travel=travel)
        return Information(problem, self.opening.noise, whole, at_hand)

    def chances(self, sight: Information) -> tuple[Array, ...]:
        """Return, per question, the probability that i, if at work, leaves j behind."""
        return tuple(
            chances(question, before, after)
            for question, before, after in zip(
                self.opening.questions, self.apart, _apart(sight, self.opening), strict=True
            )
        )

    def narrowed(self, sight: Information) -> Precision:
        """Return the covariance of all parameters by some rows."""
        problem = sight.problem
        names = _names(self.opening, problem)
        prior = _prior(self.joint, self.opening, problem)
        return precision(sight, self.opening, prior, names, _told(names))

    def worth(self, *days: Sequence[Step]) -> float:
        """Return what steps, day after day, are worth: names decided, intervals narrowed."""
        if not any(days):
            return 0.0
        sight = self.after(*days)
        narrow = self.precision.of(self.matter).volume
        narrow -= self.narrowed(sight).of(self.matter).volume
        low, high = log_determinant([self.before.problem.table, sight.problem.table])
        if self.unnamed:
            return high - low + _NARROW * narrow
        if not self.opening.questions:
            return narrow + _SPREAD_ALONE * (high - low)
        total = _NARROW * narrow + _SPREAD * (high - low)
        now_apart = _apart(sight, self.opening)
        for question, before, after in zip(
            self.opening.questions, self.apart, now_apart, strict=True
        ):
            total += decided(question, chances(question, before, after))
            share = np.array([question.probabilities[rival.name] for rival in question.rivals])
            margin = margins(question, before, after, _ENOUGH)
            total += _PULL * float(share @ margin) / _ENOUGH
        return total

    def shown(self, steps: Sequence[Step]) -> float:
        """Return how much steps show of the likely causes, RMS of what the base leaves. [N·m].

        Without any likely cause it is the number of pairs: the base itself is checked.
        """
        sight = self.after(steps)
        problem = sight.problem
        new = slice(len(self.before.problem.friction), None)
        weighted = [(1.0, score) for score in self.opening.settled]
        for question in self.opening.questions:
            share = question.probabilities
            weighted += [(share[rival.name], rival.score) for rival in question.rivals]
        if not weighted:
            return float(len(problem.layout.bins))
        total = 0.0
        for weight, score in weighted:
            basis = problem.basis(score.effect, score.shape)
            torque = main_channel(basis, score.effect) @ score.coefficients
            left = left_of_base(problem, torque, score.effect.channel)[new]
            total += weight * float(np.sqrt(np.mean(np.square(left))))
        return total


def _apart(sight: Information, opening: OpenQuestions) -> tuple[Discrimination, ...]:
    """Return how far apart the rivals of each question are."""
    found = []
    for question in opening.questions:
        others = [
            *opening.settled,
            *(other.leading.score for other in opening.questions if other is not question),
        ]
        found.append(discriminations(sight, question, others))
    return tuple(found)


def _problem(joint: PlannedJoint, torques: pd.DataFrame) -> Problem:
    return simulated(torques, joint.temperature, joint.parameters, joint.gravity)[1]


def _names(opening: OpenQuestions, problem: Problem) -> tuple[str, ...]:
    """Return names of all columns: friction, gravity, causes."""
    gravity = [f"gravity {number}" for number in range(len(problem.gravity))]
    causes = [
        f"{one.effect.name}.{parameter.name}"
        for one in opening.causes
        for parameter in one.effect.coefficients
    ]
    return (*PARAMETERS, *gravity, *causes)


def _told(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names of what is told: gravity is not asked for."""
    return tuple(name for name in names if not name.startswith("gravity "))


def _estimates(joint: PlannedJoint, opening: OpenQuestions) -> dict[str, float]:
    found = {name: float(getattr(joint.parameters, name)) for name in PARAMETERS}
    for one in opening.causes:
        for parameter, value in zip(one.effect.coefficients, one.coefficients, strict=True):
            found[f"{one.effect.name}.{parameter.name}"] = float(value)
    return found


def _prior(joint: PlannedJoint, opening: OpenQuestions, problem: Problem) -> Array:
    """Return weak weights of what is believed beforehand, so that no interval is endless."""
    friction = max(float(np.mean(np.abs(problem.table.friction))), 1e-6)
    load = max(float(np.max(np.abs(problem.load_base @ problem.gravity))), 1e-6)
    size = {
        "tau_c": friction,
        "alpha": friction / load**2,
        "beta": friction / np.sqrt(float(np.mean(problem.table.speed))),
        "delta": _USUAL_DELTA,
    }
    size["gamma"] = size["beta"] * float(np.exp(_USUAL_DELTA * _mean_temperature(joint)))
    usual = [*(size[name] for name in PARAMETERS), *(load for _ in problem.gravity)]
    bounds = [
        parameter.upper - parameter.lower
        for one in opening.causes
        for parameter in one.effect.coefficients
    ]
    return np.asarray(1 / np.square(np.array([*(_LOOSE * one for one in usual), *bounds])))


def _mean_temperature(joint: PlannedJoint) -> float:
    """Return the mean motor temperature at hand, 20 °C where it is not known [°C]."""
    warm = float(joint.torques["motor_temperature"].mean())
    return warm if np.isfinite(warm) else 20.0
