"""Causes that a law of another kind explains about as well, with a single coefficient.

By plain least squares beside the base: smooth discrepancy, which the search allows for, may imitate
such a law, and then what is left of it looks like another cause.
"""

from collections.abc import Iterable

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK, base_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.effects.base import Channel
from frictioncli.effects.direction_asymmetry import EFFECT as DIRECTION_ASYMMETRY
from frictioncli.effects.dress_pack import EFFECT as DRESS_PACK
from frictioncli.effects.position_ripple import EFFECT as POSITION_RIPPLE
from frictioncli.effects.position_ripple import periods_seen
from frictioncli.linear_algebra import least_squares_residual

_OF_LOAD = frozenset({DIRECTION_ASYMMETRY.name, DRESS_PACK.name})
"""Effects that show as load where there is none, by speed or by angle."""

_POWERS = (1, 2)
"""Powers of the torque's magnitude with which the reading may fall behind."""

_FEW_PERIODS = 3.0
"""Periods of a ripple in the stroke up to which it may be a function of the load."""

_NEARLY = 0.9
"""Share of what the ripple explains, with two coefficients and an order, that the load explains."""

_MISREAD = (
    "a motor whose torque per current falls at high torque would look the same: the load is misread"
    " most where friction and load are both large"
)

_KINK = "friction that grows with the amount of load, with a kink at zero load, would look the same"


def simpler_law(fit: EffectFit, problem: Problem) -> str:
    """Return why a cause may be a law with a single coefficient; empty if it is not.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its shape.
    problem : Problem
        The joint's rows.
    """
    if problem.has_load_channel:
        return ""
    if fit.effect.name in _OF_LOAD and _explain(_misread(problem), fit, problem, "load"):
        return _MISREAD
    if fit.effect is POSITION_RIPPLE and periods_seen(problem.table, **fit.shape) < _FEW_PERIODS:
        kink = np.abs(problem.table.load)
        return _KINK if _explain([kink], fit, problem, "friction", _NEARLY) else ""
    return ""


def _misread(problem: Problem) -> Iterable[Array]:
    r"""Yield what load is misread where torque is not read in proportion.

    A motor that saturates needs more current at high torque, and a torque computed with one
    constant is read as :math:`t\,(1 + s\,|t|^n)`. Half the sum over both directions then differs
    from the load by

    .. math:: \tfrac{s}{2}\left[(L + F)|L + F|^n + (L - F)|L - F|^n\right]

    which follows friction *F* where there is load *L*.
    """
    table = problem.table
    torques = table.load + table.friction, table.load - table.friction
    for power in _POWERS:
        yield np.sum([one * np.abs(one) ** power for one in torques], axis=0)


def _explain(
    laws: Iterable[Array],
    fit: EffectFit,
    problem: Problem,
    channel: Channel,
    share: float = 1.0,
) -> bool:
    """Return whether one of some laws explains a share of what all columns of the effect do."""
    number = ("friction", "load").index(channel)
    misfit = (problem.friction_misfit, problem.load_misfit)[number]
    base = base_rows(problem)[number]

    def explained_by(columns: Array) -> float:
        design = np.column_stack([base, columns])
        return left - _square(least_squares_residual(design, misfit, tolerance=RANK))

    left = _square(least_squares_residual(base, misfit, tolerance=RANK))
    own = explained_by(problem.basis(fit.effect, fit.shape)[number])
    return max(explained_by(one) for one in laws) >= share * own


def _square(values: Array) -> float:
    return float(np.sum(np.square(values)))
