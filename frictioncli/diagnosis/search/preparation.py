"""What searches of the same problem share: what stands beside the base, and the hypotheses."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit, Hypothesis, hypothesis_of
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.search.measurement import BesideBase, beside_base
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import Effect

_AT_ONCE = 2
"""Number of problems that are remembered."""


@dataclass(slots=True, eq=False)
class _Prepared:
    """A problem with what is known of it."""

    problem: Problem
    discrepancy: float
    measurement: tuple[Effect, ...]
    beside: BesideBase


_Hypotheses = tuple[Problem, dict[int, tuple[Effect, Hypothesis]]]
"""A problem with the hypotheses that were worked out there, by the effect."""


class Preparation:
    """What was computed for problems that are searched more than once.

    Nothing depends on whether a problem was seen before, but the time it takes.

    Parameters
    ----------
    found : sequence of EffectFit, optional
        Properties of the joint beside which effects of the measurement are judged.
    before : Preparation, optional
        Another one, whose hypotheses are the same: they do not depend on what stands beside them.
    """

    def __init__(
        self, found: Sequence[EffectFit] = (), before: "Preparation | None" = None
    ) -> None:
        self._found = tuple(found)
        self._known: list[_Prepared] = []
        self._hypotheses: list[_Hypotheses] = [] if before is None else before._hypotheses

    def beside(
        self,
        problem: Problem,
        discrepancy: float = SHARE,
        measurement: tuple[Effect, ...] = MEASUREMENT_EFFECTS,
    ) -> BesideBase:
        """Return what stands beside the base, as :func:`beside_base` does.

        Parameters
        ----------
        problem : Problem
            One joint's measurements and base model.
        discrepancy : float, optional
            RMS of the discrepancy that is expected, relative to the mean friction.
        measurement : tuple of Effect, optional
            Effects of the measurement that may stand there.
        """
        return self._of(problem, discrepancy, measurement).beside

    def hypotheses(self, problem: Problem, effects: tuple[Effect, ...]) -> list[Hypothesis]:
        """Return effects as hypotheses over their shapes.

        Parameters
        ----------
        problem : Problem
            One joint's measurements and base model.
        effects : tuple of Effect
            Effects that can be tested there.
        """
        known = next((own for one, own in self._hypotheses if one is problem), {})
        others = [one for one in self._hypotheses if one[0] is not problem]
        self._hypotheses[:] = [*others[1 - _AT_ONCE :], (problem, known)]
        for effect in effects:
            if id(effect) not in known:
                known[id(effect)] = effect, hypothesis_of(effect, problem)
        return [known[id(effect)][1] for effect in effects]

    def _of(
        self, problem: Problem, discrepancy: float, measurement: tuple[Effect, ...]
    ) -> _Prepared:
        alike = [
            one
            for one in self._known
            if (one.discrepancy, one.measurement) == (discrepancy, measurement)
            and _same_but_for_delay(one.problem, problem)
        ]
        for one in alike:
            if one.problem is problem:
                return one
        # effects of the measurement do not depend on what is known of the delay
        if alike:
            before = alike[0].beside
            own = replace(before.precomputed, problem=problem)
            beside = replace(before, precomputed=own)
        else:
            spectra = [
                spectra
                for one in self._known
                if one.problem.layout is problem.layout
                for spectra in one.beside.precomputed.noises.spectra
            ]
            beside = beside_base(problem, discrepancy, measurement, self._found, spectra)
        found = _Prepared(problem, discrepancy, measurement, beside)
        others = [one for one in self._known if one not in alike]
        self._known = [*others[1 - _AT_ONCE :], found]
        return found


def _same_but_for_delay(first: Problem, second: Problem) -> bool:
    """Return whether two problems are the same rows and base, perhaps with another delay."""
    return all(
        getattr(first, one.name) is getattr(second, one.name)
        for one in fields(Problem)
        if one.init and one.name != "late"
    )
