"""What the residuals show of an effect at face value: of all of it, and at low speeds alone."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.left_by_base import Z95, left_by, span_of
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.effects.base import Basis

_FEW = 4
"""Fewer pairs do not show how much they scatter."""

_SLOWER = 0.95
"""Speeds up to this share of another one are lower: moves at one speed differ less."""


class Shown(NamedTuple):
    """Shares of an effect that the residuals show.

    Attributes
    ----------
    share : float
        Of all of it: about 1, or less where discrepancy is to cancel the rest.
    slower : float
        Of what it has at low speeds, at most (95 %); 1 where these are few.
    """

    share: float = 1.0
    slower: float = 1.0


WHOLE = Shown()
"""The residuals show all of it."""


def shown_of(known: Precomputed, fit: EffectFit, others: Sequence[EffectFit]) -> Shown:
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
    torque = left_by(span, problem.basis(fit.effect, fit.shape)) @ fit.coefficients
    if not torque.any():
        return WHOLE
    by_rows = [torque * left_by(span, misfit)[:, 0], np.square(torque)]
    row_pair = np.tile(problem.layout.row_pair, 2)
    seen, whole = (np.bincount(row_pair, weights=one).astype(float) for one in by_rows)
    share = float(seen.sum() / whole.sum())
    if share <= 0:
        return Shown(share)
    speed = problem.layout.speed
    slow = speed < _SLOWER * float(seen @ speed) / float(seen.sum())
    return Shown(share, _at_most(seen[slow], whole[slow]))


def _at_most(seen: Array, whole: Array) -> float:
    """Return the upper bound of a share whose parts are those of some pairs."""
    if len(seen) < _FEW:
        return 1.0
    share = seen.sum() / whole.sum()
    error = np.sqrt(np.sum(np.square(seen - share * whole))) / whole.sum()
    return float(share + Z95 * error)
