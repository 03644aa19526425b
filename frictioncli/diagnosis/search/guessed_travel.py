"""Running-in as a rival of other causes where the distance travelled is partly a guess.

What a joint does between recordings is inferred from its motor's temperature alone. A cause that
running-in explains as well, with these moves or without them, must not be named without it.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.fit.hypotheses import HypothesisTest, hypothesis_of
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects.base import Effect, EffectTable
from frictioncli.effects.run_in import EFFECT as RUN_IN
from frictioncli.effects.run_in import OF_LOGGED, logged_travel

_CHOICE = float(np.log(2.0))
"""What the choice between two distances costs, as the logarithm of a Bayes factor."""


def is_guessed(table: EffectTable) -> bool:
    """Return whether distances include moves that are not recorded.

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins of all runs.
    """
    return not np.allclose(table.travel, table.once(logged_travel))


def variants(effect: Effect, table: EffectTable) -> tuple[Effect, ...]:
    """Return what an effect may be: running-in with and without moves that are not recorded.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    table : EffectTable
        Pairs and angle bins of all runs.
    """
    return (effect, OF_LOGGED) if effect is RUN_IN and is_guessed(table) else (effect,)


def likelier_travel(
    step: Step, tests: Mapping[str, HypothesisTest], most: float
) -> tuple[dict[str, HypothesisTest], dict[str, Effect]]:
    """Return tests in which running-in has the distance with which it explains more.

    Parameters
    ----------
    step : Step
        Base and accepted effects.
    tests : mapping of str to HypothesisTest
        Tests there, by the name of the effect.
    most : float
        Log Bayes factor of the cause of which they are rivals: a distance that is chosen to suit
        may be as likely, and refutes nothing.

    Returns
    -------
    tests : dict of str to HypothesisTest
        All tests.
    effects : dict of str to Effect
        The effect where it is not that of the catalogue.
    """
    known = tests.get(RUN_IN.name)
    if known is None or not is_guessed(step.problem.all_runs):
        return dict(tests), {}
    alone = Catalogue.of(step.precomputed, [hypothesis_of(OF_LOGGED, step.problem)])
    other = step.tested(alone)[RUN_IN.name]
    factor = min(other.log_bayes_factor - _CHOICE, most)
    if factor <= known.log_bayes_factor:
        return dict(tests), {}
    return (
        {**tests, RUN_IN.name: replace(other, log_bayes_factor=factor)},
        {RUN_IN.name: OF_LOGGED},
    )
