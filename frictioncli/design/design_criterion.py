"""Design criterion: the expected gain of a programme in decisions and in precision."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.design.decision_probability import (
    decision_probability,
    log_odds_margins,
    rule_out_probabilities,
)
from frictioncli.design.discrimination import Discrimination, discrimination_of
from frictioncli.design.information import Information
from frictioncli.design.located_forms import form_basis
from frictioncli.design.planned_joint import PlannedJoint
from frictioncli.design.precision import (
    Precision,
    information_on,
    precision,
    response_surface_log_determinants,
)
from frictioncli.design.predicted_rows import append_run, predict_rows
from frictioncli.design.prior import prior_precision, usual_sizes
from frictioncli.design.rivals import OpenQuestions
from frictioncli.design.steps import Step
from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.data.within_noise import WithinNoise
from frictioncli.diagnosis.empirical.term import EmpiricalTerm, FormFunction
from frictioncli.diagnosis.fit.columns import main_channel, residual_of_base
from frictioncli.diagnosis.noise.cosine_series import Range
from frictioncli.model.document import PARAMETERS

PLANNED = "~"
"""Suffix to the name of the last run: the planned run sorts after it."""

_THERMAL = ("gamma", "delta")
"""Parameters that cannot be determined without a motor temperature."""

WIDE = 0.2
"""An interval is wide if its half-width is more than this share of the estimate."""

_MARGIN_BOUND = 15.0
"""Margins of the log odds count up to this value."""

_MARGIN_WEIGHT = 0.3
"""Weight of the mean margin of the log odds, relative to a decided question."""

_PRECISION_WEIGHT = 0.01
"""Weight of precision beside open questions. [1/nat]"""

_COVERAGE_WEIGHT = 0.004
"""Weight of input coverage beside open questions: the cause may be none of the rivals. [1/nat]"""

_COVERAGE_WEIGHT_ALONE = 0.02
"""Weight of input coverage beside precision, without open questions. [nat/nat]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignCriterion:
    """One joint's open questions and wide intervals, and the value of programmes for them.

    Attributes
    ----------
    joint : PlannedJoint
        The joint.
    open_questions : OpenQuestions
        Settled causes, open questions and noise.
    unnamed : bool
        Whether there is structure that no effect explains.
    forms : tuple of FormFunction
        Forms that describe it.
    ranges : mapping of str to (float, float)
        Ranges of the quantities in which they were found.
    observed : Information
        The observed rows.
    observed_discriminations : tuple of Discrimination
        Noncentralities in them, per question.
    precision : Precision
        Covariance of all parameters in them.
    of_interest : tuple of str
        Parameters with wide intervals; all base parameters if none is wide.
    """

    joint: PlannedJoint
    open_questions: OpenQuestions
    unnamed: bool
    forms: tuple[FormFunction, ...]
    ranges: Mapping[str, Range]
    observed: Information
    observed_discriminations: tuple[Discrimination, ...]
    precision: Precision
    of_interest: tuple[str, ...]

    @classmethod
    def of(
        cls,
        joint: PlannedJoint,
        open_questions: OpenQuestions,
        *,
        unnamed: bool,
        empirical: EmpiricalTerm | None = None,
    ) -> "DesignCriterion":
        """Return the criterion for one joint, given its observed rows."""
        problem = _problem(joint, joint.torques)
        observed = Information(problem, open_questions.noise, problem.all_runs)
        covariance = _precision(joint, open_questions, observed)
        values = _estimates(joint, open_questions)
        wide = tuple(
            name
            for name, half in covariance.half_widths.items()
            if half > WIDE * abs(values[name]) and (joint.thermal_model or name not in _THERMAL)
        )
        return cls(
            joint=joint,
            open_questions=open_questions,
            unnamed=unnamed,
            forms=() if empirical is None else empirical.forms,
            ranges={} if empirical is None else empirical.ranges,
            observed=observed,
            observed_discriminations=_discriminations(observed, open_questions),
            precision=covariance,
            of_interest=wide or PARAMETERS,
        )

    @property
    def estimates(self) -> Mapping[str, float]:
        """Estimates by name: parameters of the base model, and of causes as ``effect.name``."""
        return _estimates(self.joint, self.open_questions)

    @property
    def usual_sizes(self) -> Mapping[str, float]:
        """Usual sizes of the base model's parameters by name."""
        return usual_sizes(self.joint, self.observed.problem)

    def information_after(self, *days: Sequence[Step]) -> Information:
        """Return the observed rows together with those that steps, day after day, would add."""
        last = str(self.joint.torques["run"].max())
        runs = [
            predict_rows(self.joint, steps, f"{last}{PLANNED * number}")[0]
            for number, steps in enumerate(days, 1)
        ]
        new = pd.concat([run for run in runs if len(run)] or runs[:1], ignore_index=True)
        # planned rows hold no noise that could be estimated from them
        noise = self.observed.problem.layout.noise
        problem = _problem(self.joint, append_run(self.joint.torques, new), noise)
        travel = problem.all_runs.travel.copy()
        if len(new):
            travel[-len(new) :] = new["travel"]
        observed_share = len(self.observed.problem.layout.bins) / len(problem.layout.bins)
        true_inputs = replace(problem.all_runs, travel=travel)
        return Information(problem, self.open_questions.noise, true_inputs, observed_share)

    def rule_out_probabilities(self, information: Information) -> tuple[Array, ...]:
        """Return, per question, the probability that rival j is ruled out if i is the cause."""
        return tuple(
            rule_out_probabilities(question, before, after)
            for question, before, after in zip(
                self.open_questions.questions,
                self.observed_discriminations,
                _discriminations(information, self.open_questions),
                strict=True,
            )
        )

    def precision_with(self, information: Information) -> Precision:
        """Return the covariance of all parameters in some rows."""
        return _precision(self.joint, self.open_questions, information)

    def value(self, *days: Sequence[Step]) -> float:
        """Return the value of steps, day after day.

        With open questions it is mainly the expected number of decided questions; without, the gain
        in precision; with unexplained structure, what is learned of the forms that describe it, or
        else the gain in input coverage.
        """
        if not any(days):
            return 0.0
        information = self.information_after(*days)
        precision_gain = self.precision.subset(self.of_interest).log_volume
        precision_gain -= self.precision_with(information).subset(self.of_interest).log_volume
        before_coverage, after_coverage = response_surface_log_determinants(
            [self.observed.problem.table, information.problem.table]
        )
        coverage_gain = after_coverage - before_coverage
        small = _PRECISION_WEIGHT * precision_gain + _COVERAGE_WEIGHT * coverage_gain
        if self.forms and (self.unnamed or not self.open_questions.questions):
            return self._of_forms(information) - self._of_forms(self.observed) + small
        if self.unnamed:
            return coverage_gain + _PRECISION_WEIGHT * precision_gain
        if not self.open_questions.questions:
            return precision_gain + _COVERAGE_WEIGHT_ALONE * coverage_gain
        total = small
        discriminations = _discriminations(information, self.open_questions)
        for question, before, after in zip(
            self.open_questions.questions,
            self.observed_discriminations,
            discriminations,
            strict=True,
        ):
            total += decision_probability(question, rule_out_probabilities(question, before, after))
            share = np.array([question.probabilities[rival.name] for rival in question.rivals])
            margin = log_odds_margins(question, before, after, _MARGIN_BOUND)
            total += _MARGIN_WEIGHT * float(share @ margin) / _MARGIN_BOUND
        return total

    def _of_forms(self, information: Information) -> float:
        """Return what some rows tell of the forms [nat]."""
        problem = information.problem
        prior = prior_precision(self.joint, self.open_questions, problem)
        further = form_basis(self.forms, problem.table, self.ranges)
        return information_on(information, self.open_questions, prior, further)

    def lack_of_fit(self, steps: Sequence[Step]) -> float:
        """Return the expected lack of fit of the base model in steps, by the likely causes.

        Parameters
        ----------
        steps : sequence of Step
            The steps.

        Returns
        -------
        float
            RMS of the torque that the base model cannot fit, summed over causes and forms [N·m].
            Without any it is the number of pairs: then the base model itself is checked.
        """
        problem = self.information_after(steps).problem
        new = slice(len(self.observed.problem.friction), None)
        weighted = [(1.0, fit) for fit in self.open_questions.settled]
        for question in self.open_questions.questions:
            share = question.probabilities
            weighted += [(share[rival.name], rival.fit) for rival in question.rivals]
        if not weighted and not self.forms:
            return float(len(problem.layout.bins))
        total = 0.0
        for form in self.forms:
            torque = getattr(form.at(problem.table), form.channel)
            residual = residual_of_base(problem, torque, form.channel)[new]
            total += float(np.sqrt(np.mean(np.square(residual))))
        for weight, fit in weighted:
            basis = problem.basis(fit.effect, fit.shape)
            torque = main_channel(basis, fit.effect) @ fit.coefficients
            residual = residual_of_base(problem, torque, fit.effect.channel)[new]
            total += weight * float(np.sqrt(np.mean(np.square(residual))))
        return total


def _discriminations(
    information: Information, open_questions: OpenQuestions
) -> tuple[Discrimination, ...]:
    """Return the noncentralities of the rivals of each question."""
    found = []
    for question in open_questions.questions:
        other_causes = [
            *open_questions.settled,
            *(other.leading.fit for other in open_questions.questions if other is not question),
        ]
        found.append(discrimination_of(information, question, other_causes))
    return tuple(found)


def _problem(
    joint: PlannedJoint, torques: pd.DataFrame, noise: WithinNoise | None = None
) -> Problem:
    return simulated(torques, joint.temperature, joint.parameters, joint.gravity, noise=noise)[1]


def _precision(
    joint: PlannedJoint, open_questions: OpenQuestions, information: Information
) -> Precision:
    """Return the covariance of all parameters; those of gravity are nuisance parameters."""
    problem = information.problem
    gravity = [f"gravity {number}" for number in range(len(problem.gravity))]
    causes = [
        f"{one.effect.name}.{parameter.name}"
        for one in open_questions.causes
        for parameter in one.effect.coefficients
    ]
    prior = prior_precision(joint, open_questions, problem)
    names = (*PARAMETERS, *gravity, *causes)
    return precision(information, open_questions, prior, names, (*PARAMETERS, *causes))


def _estimates(joint: PlannedJoint, open_questions: OpenQuestions) -> dict[str, float]:
    found = {name: float(getattr(joint.parameters, name)) for name in PARAMETERS}
    for one in open_questions.causes:
        for parameter, value in zip(one.effect.coefficients, one.coefficients, strict=True):
            found[f"{one.effect.name}.{parameter.name}"] = float(value)
    return found
