"""What the residuals show of an effect: of all of it, at low speeds, and in one direction."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, span_of, torque_left_by
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.effects.base import Basis

_FEW = 4
"""Fewer pairs do not show how much they scatter."""

_SLOWER = 0.95
"""Speeds up to this share of another one are lower: moves at one speed differ less."""

_ONE_DIRECTION = 0.5
"""Change of friction, relative to that of the load, from which it is in one direction only."""

_IN_PROPORTION = 0.9
"""Share of a change of the load, by its mean square, from which it is in proportion to the load."""


class Shown(NamedTuple):
    """Shares of an effect that the residuals show.

    Attributes
    ----------
    share : float
        Of all of it: about 1, or less where discrepancy is to cancel the rest.
    slower : float
        Of what it has at low speeds, at most (95 %); 1 where these are few.
    one_direction : bool
        Whether a change of the load is one of the torque in one direction of motion only.
    """

    share: float = 1.0
    slower: float = 1.0
    one_direction: bool = False


WHOLE = Shown()
"""The residuals show all of it."""


def shown_by_residuals(known: Precomputed, fit: EffectFit, others: Sequence[EffectFit]) -> Shown:
    """Return what the residuals show of an effect at face value.

    The coefficient of its torque by least squares beside base, measurement and other effects. Low
    speeds are those below the mean speed of the pairs that show it. A ripple of the joint is there,
    too. One that is too fine for the samples of a fast move looks like a coarse one at the speed of
    that move alone, since the distance between samples goes with the speed.

    Parameters
    ----------
    known : Precomputed
        The data.
    fit : EffectFit
        The effect.
    others : sequence of EffectFit
        The other effects; those of the measurement, too, if it is one itself.
    """
    problem = known.problem
    beside = [problem.basis(one.effect, one.shape) for one in others]
    if not fit.effect.measurement:
        beside += known.measurement
    misfit = Basis(problem.friction_misfit[:, np.newaxis], problem.load_misfit[:, np.newaxis])
    span = span_of(problem, beside)
    one_direction = _in_one_direction(problem, fit, span)
    torque = torque_left_by(span, problem, fit)
    if not torque.any():
        return WHOLE
    by_rows = [torque * left_by(span, misfit)[:, 0], np.square(torque)]
    row_pair = np.tile(problem.layout.row_pair, 2)
    seen, whole = (np.bincount(row_pair, weights=one).astype(float) for one in by_rows)
    share = float(seen.sum() / whole.sum())
    if share <= 0:
        return Shown(share, one_direction=one_direction)
    speed = problem.layout.speed
    slow = speed < _SLOWER * float(seen @ speed) / float(seen.sum())
    return Shown(share, _at_most(seen[slow], whole[slow]), one_direction)


def _in_one_direction(problem: Problem, fit: EffectFit, span: Array) -> bool:
    """Return whether a change of the load goes with one of friction that is at least half of it.

    Torque in one direction of motion alone, as friction in the first move after a stop, adds half
    of itself to both channels. Another scale of the torque changes both as well, but the load in
    proportion to itself.
    """
    if fit.effect.moments is None or fit.effect.channel != "load" or problem.has_load_channel:
        return False
    friction, load = (one @ fit.coefficients for one in problem.basis(fit.effect, fit.shape))
    scaled = (load != 0) * problem.table.load
    nothing = np.zeros_like(load)
    own, change, proportional, misfit = left_by(
        span,
        Basis(
            np.column_stack([load, nothing, nothing, problem.friction_misfit - friction]),
            np.column_stack([nothing, load, scaled, nothing]),
        ),
    ).T
    if not own.any():
        return False
    in_friction = float(own @ misfit) / float(own @ own)
    together = float(change @ proportional) ** 2
    alike = together > _IN_PROPORTION * float(change @ change) * float(proportional @ proportional)
    return abs(in_friction) > _ONE_DIRECTION and not alike


def _at_most(seen: Array, whole: Array) -> float:
    """Return the upper bound of a share whose parts are those of some pairs."""
    if len(seen) < _FEW or not whole.any():
        return 1.0
    share = seen.sum() / whole.sum()
    error = np.sqrt(np.sum(np.square(seen - share * whole))) / whole.sum()
    return float(share + Z95 * error)
