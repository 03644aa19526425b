"""Changes that may be something else: by when they come, and at which temperature."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.motion_history import pauses_of
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.confounded import (
    NO_TEMPERATURE,
    are_warmer_or_colder,
    has_temperature,
)
from frictioncli.effects.history import present
from frictioncli.effects.pair_series import measured_share
from frictioncli.effects.payload_change import EFFECT as PAYLOAD_CHANGE
from frictioncli.effects.step_change import EFFECT as STEP_CHANGE
from frictioncli.linear_algebra import least_squares_residual

_START_OF_RUN = 0.15
"""Share of the pairs of a run that are at its start."""

_AT_TEMPERATURE = (
    "it comes in each run at the same temperature, where friction that depends on temperature would"
    " look the same"
)

_SEVERAL = 2
"""Runs in which a change comes or goes, or series of pairs, from which it recurs."""

_PAUSE = 120.0
"""Time from pair to pair in which the temperature of a joint may become another one. [s]"""

_REST = 10.0
"""Pause between two pairs that is a rest. [s]"""

_FIRST_AFTER_RESTS = 0.9
"""Share of the pairs with a change that follow a rest and whose next pair, at once, is without,
from which the change goes with the first pair after a rest."""

_IN_FIRST_PAIRS = (
    "it is there only in the first pairs after rests, where friction that falls within the first"
    " move would look the same"
)

_FALLS_AT_START = (
    "it comes or goes at the start of each run, where friction is another one, too: friction that"
    " changes from move to move would look the same"
)

_HALF_OF_FALL = 0.5
"""Greatest share of a change of friction between the moves of a pair that is in the load."""

_IS_GRADUAL = (
    "within runs the load changes gradually rather than at a moment, as where another joint moves"
    " slowly"
)

_CERTAIN = 30.0
"""Twice the log likelihood by which a load is found to change gradually."""

_AT_START = "it is there only at the start of runs, where friction after a rest would look the same"


def doubtful_change(fit: EffectFit, problem: Problem) -> str:
    """Return why a step of friction or a payload may be something else; empty if not.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its history.
    problem : Problem
        The joint's rows.
    """
    if fit.effect is PAYLOAD_CHANGE:
        there = _there(fit, problem)
        at_start = _in_first_pairs(there, problem) or _falls_at_start(fit, problem)
        return at_start or _is_gradual(fit, there, problem)
    if fit.effect is not STEP_CHANGE:
        return ""
    there = _there(fit, problem)
    if has_temperature(problem):
        return _at_start_of_runs(there, problem) or _at_temperature(fit, (problem,))
    return _after_pauses(there, problem) or _at_start_of_runs(there, problem)


def doubtful_with_new_run(fit: EffectFit, problem: Problem, new: Problem) -> str:
    """Return why a step that is on a held-out run, too, may be one of the temperature.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its history in all runs.
    problem, new : Problem
        The runs seen, and the held-out run.
    """
    if fit.effect is not STEP_CHANGE or not has_temperature(problem):
        return ""
    return _at_temperature(fit, (problem, new))


def _there(fit: EffectFit, problem: Problem) -> Flags:
    """Return in which pairs of some rows a step is there, shape (pairs,)."""
    share = measured_share(problem.all_runs)[problem.rows]
    _, heads = np.unique(problem.layout.row_pair, return_index=True)
    return present(share[heads], fit.shape)


def _after_pauses(there: Flags, problem: Problem) -> str:
    """Return why a step may be one of a temperature that nobody logged; empty if it is not."""
    clock = problem.layout.means(problem.table.clock[:, np.newaxis])[:, 0]
    order = np.argsort(clock, kind="stable")
    changes = np.diff(there[order].astype(int)) != 0
    return NO_TEMPERATURE if np.any(np.diff(clock[order])[changes] > _PAUSE) else ""


def _in_first_pairs(there: Flags, problem: Problem) -> str:
    """Return why a payload may be friction in the first moves after rests; empty if it is not.

    Friction that falls within a pair differs between its moves, and half of that is in the load. A
    payload that comes in a rest does not go without one.
    """
    layout = problem.layout
    _, heads = np.unique(layout.row_pair, return_index=True)
    low, high = (one.reduceat(problem.table.position, heads) for one in (np.minimum, np.maximum))
    pause = pauses_of(layout, 2 * (high - low))
    rested = np.append(True, (np.diff(layout.run) != 0) | (pause > _REST))
    for one in (there, ~there):
        goes = one & ~np.append(one[1:] | rested[1:], True)
        first = int(np.sum(goes & rested))
        if first >= max(_SEVERAL, _FIRST_AFTER_RESTS * int(one.sum())):
            return _IN_FIRST_PAIRS
    return ""


def _falls_at_start(fit: EffectFit, problem: Problem) -> str:
    """Return why a payload may be friction that falls as runs begin; empty if it is not.

    Friction that is so different there that half of what it changes by may be the whole change of
    the load, where this comes or goes after the first pairs of several runs.
    """
    there = _there(fit, problem)
    runs = [problem.layout.run == one for one in np.unique(problem.layout.run)]
    several = sum(bool(there[own].any() and not there[own].all()) for own in runs) >= _SEVERAL
    if not several or not _at_start_of_runs(there, problem):
        return ""
    load = problem.basis(fit.effect, fit.shape).load @ fit.coefficients
    change = float(np.sqrt(np.mean(np.square(load[there[problem.layout.row_pair]]))))
    friction = problem.layout.means(problem.friction_misfit[:, np.newaxis])[:, 0]
    fall = abs(float(np.mean(friction[~there])) - float(np.mean(friction[there])))
    return _FALLS_AT_START if change < _HALF_OF_FALL * fall else ""


def _is_gradual(fit: EffectFit, there: Flags, problem: Problem) -> str:
    """Return why a payload may be a load that changes slowly; empty if it is not.

    Within the runs in which it comes or goes, a parabola in time leaves less of the load's
    amplitude than two levels do, which have a moment beside them. Of two levels any parabola leaves
    a fifth or more.
    """
    layout, table = problem.layout, problem.table
    angle = np.radians(table.angle)
    gravity = np.column_stack([np.cos(angle), np.sin(angle)]) @ fit.coefficients
    products = np.column_stack([gravity * problem.load_misfit, np.square(gravity)])
    along, square = layout.means(products).T
    amplitude = along / np.maximum(square, 1e-300)
    pairs, whole, by_levels, by_parabolas = 0, 0.0, 0.0, 0.0
    for run in np.unique(layout.run):
        own = layout.run == run
        if there[own].all() or not there[own].any():
            continue
        time = layout.time[own] - np.mean(layout.time[own])
        pairs += int(own.sum())
        whole += _left_of(amplitude[own])
        by_levels += _left_of(amplitude[own], there[own])
        by_parabolas += _left_of(amplitude[own], time, np.square(time))
    is_there = whole > by_parabolas * np.exp(_CERTAIN / max(pairs, 1))
    return _IS_GRADUAL if is_there and by_parabolas < by_levels else ""


def _left_of(values: Array, *columns: Array | Flags) -> float:
    """Return the sum of squares that a constant and columns leave of some values."""
    design: Array = np.column_stack([np.ones(len(values)), *columns])
    return float(np.sum(np.square(least_squares_residual(design, values, tolerance=RANK))))


def _at_start_of_runs(there: Flags, problem: Problem) -> str:
    """Return why a step may be friction after a rest; empty if it is not."""
    # absence with the opposite sign is the same
    return _AT_START if any(_is_start(one, problem) for one in (there, ~there)) else ""


def _at_temperature(fit: EffectFit, problems: Sequence[Problem]) -> str:
    """Return why a step may be one of the temperature; empty if it is not.

    It comes or goes in several runs, and all pairs with it are warmer than those without, or all
    are colder.
    """
    parts = [(_there(fit, one), one.layout.run) for one in problems]
    own = [there[run == one] for there, run in parts for one in np.unique(run)]
    if sum(bool(one.any() and not one.all()) for one in own) < _SEVERAL:
        return ""
    there = np.concatenate([part for part, _ in parts])
    temperature = np.concatenate([_temperature(one) for one in problems])
    return _AT_TEMPERATURE if are_warmer_or_colder(there, temperature) else ""


def _temperature(problem: Problem) -> Array:
    """Return the measured temperature of each pair, shape (pairs,). [°C]."""
    return problem.layout.means(problem.table.measured_temperature[:, np.newaxis])[:, 0]


def _is_start(there: Flags, problem: Problem) -> bool:
    """Return whether some pairs are the first of their runs, few of each."""
    for run in np.unique(problem.layout.run):
        own = there[problem.layout.run == run]
        if own.sum() > _START_OF_RUN * len(own) or not own[: own.sum()].all():
            return False
    return bool(there.any())
