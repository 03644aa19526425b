"""Causes in the load that torque which is not read in proportion would imitate."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import RANK, base_rows
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.effects.direction_asymmetry import EFFECT as DIRECTION_ASYMMETRY
from frictioncli.effects.dress_pack import EFFECT as DRESS_PACK
from frictioncli.linear_algebra import least_squares_residual

_IMITATED = frozenset({DIRECTION_ASYMMETRY.name, DRESS_PACK.name})
"""Effects that show as load where there is none, by speed or by angle."""

_POWERS = (1, 2)
"""Powers of the torque's magnitude with which the reading may fall behind."""

_MISREAD = (
    "a motor whose torque per current falls at high torque would look the same: the load is misread"
    " most where friction and load are both large"
)


def misread_torque_in(fit: EffectFit, problem: Problem) -> str:
    r"""Return why a torque in the load may be one that is misread; empty if it is not.

    A motor that saturates needs more current at high torque, and a torque computed with one
    constant is read as :math:`t\,(1 + s\,|t|^n)`. Half the sum over both directions then differs
    from the load by

    .. math:: \tfrac{s}{2}\left[(L + F)|L + F|^n + (L - F)|L - F|^n\right]

    which follows friction *F* where there is load *L*. That is one coefficient; where it explains
    no less of the load than the effect does, with all its own, the effect is not known.

    Parameters
    ----------
    fit : EffectFit
        The effect, with its shape.
    problem : Problem
        The joint's rows.
    """
    if fit.effect.name not in _IMITATED or problem.has_load_channel:
        return ""
    table = problem.table
    _, base = base_rows(problem)

    def left_by(columns: Array) -> float:
        design = np.column_stack([base, columns])
        residual = least_squares_residual(design, problem.load_misfit, tolerance=RANK)
        return float(np.sum(np.square(residual)))

    torques = table.load + table.friction, table.load - table.friction
    least = min(left_by(sum(one * np.abs(one) ** n for one in torques)) for n in _POWERS)
    return _MISREAD if least <= left_by(problem.basis(fit.effect, fit.shape).load) else ""
