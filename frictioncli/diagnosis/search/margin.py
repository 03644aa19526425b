"""The smallest size worth a name, in the unit of each channel."""

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.settings import DiagnosisSettings

MARGIN_SHARE = 0.005
"""Smallest size worth a name, as a share of the mean friction, or of a load in its own unit."""

LEAST_MARGIN = 0.1
"""Smallest size worth a name, where torque is in N·m. [N·m]"""


def margin_of(problem: Problem, torque_unit: str, settings: DiagnosisSettings) -> float:
    """Return the smallest size worth a name, in the torque unit.

    Parameters
    ----------
    problem : Problem
        The rows, whose mean friction counts.
    torque_unit : str
        Unit of everything torque-like; the least margin of 0.1 N·m holds for N·m only.
    settings : DiagnosisSettings
        Its margin is taken where it is given.
    """
    if settings.margin is not None:
        return settings.margin
    share = MARGIN_SHARE * float(np.mean(np.abs(problem.friction)))
    return max(share, LEAST_MARGIN) if torque_unit == "N·m" else share


def channel_margin(problem: Problem, channel: str, margin: float) -> float:
    """Return the smallest size worth a name in a channel, in its unit.

    A margin of friction says nothing of a load that the log has in a channel of its own: friction
    may be a current. There a share of the load counts.

    Parameters
    ----------
    problem : Problem
        The rows.
    channel : {"friction", "load"}
        The channel.
    margin : float
        Smallest size worth a name in the friction. [N·m]
    """
    if channel == "friction" or not problem.has_load_channel:
        return margin
    return max(MARGIN_SHARE * float(np.mean(np.abs(problem.load))), LEAST_MARGIN)


def whole_torque(problem: Problem, channel: str) -> float:
    """Return the torque that an effect cannot be larger than, in the unit of the channel.

    The mean friction; of an effect in the load the mean load. Where an axis carries less load than
    it has friction, and both have one unit, the mean friction counts there too.

    Parameters
    ----------
    problem : Problem
        The rows.
    channel : {"friction", "load"}
        The channel.
    """
    friction, load = (float(np.mean(np.abs(one))) for one in (problem.friction, problem.load))
    if channel == "friction":
        return friction
    return load if problem.has_load_channel else max(friction, load)


def strength(problem: Problem, channel: str, size: float) -> float:
    """Return a size relative to the mean torque of its channel, by which causes are ordered [-].

    Parameters
    ----------
    problem : Problem
        The rows.
    channel : {"friction", "load"}
        The channel.
    size : float
        RMS in that channel. [N·m]
    """
    own = channel == "load" and problem.has_load_channel
    mean = float(np.mean(np.abs(problem.load if own else problem.friction)))
    return size / max(mean, 1e-300)
