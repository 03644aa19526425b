"""Setting of the corrections that is recommended: the fewest that keep every phase on target."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.report.grid_replay import ReplayedPhase

TARGET_ERROR = 2.0
"""Error that the source paper reaches. [N·m]"""

TARGET_SHARE = 0.25
"""Target as a share of the error without correction, if torque is not in N·m."""


def target_error(unit: str, uncorrected: float) -> float:
    """Return the error (21) that corrections should reach in a phase [torque unit].

    Parameters
    ----------
    unit : str
        Unit of torque.
    uncorrected : float
        Error without correction. [torque unit]

    Examples
    --------
    >>> target_error("N·m", 6.0), target_error("A", 0.8)
    (2.0, 0.2)
    """
    return TARGET_ERROR if unit == "N·m" else TARGET_SHARE * uncorrected


def recommended_setting(phases: Sequence[ReplayedPhase], unit: str) -> int | None:
    """Return the index of the setting with the fewest corrections that keeps all phases on target.

    Of settings with equally many corrections it is the one with the smallest error. If no setting
    reaches the target everywhere, it is the one whose worst error is smallest against the target.

    Parameters
    ----------
    phases : sequence of ReplayedPhase
        The phases of all runs under every setting.
    unit : str
        Unit of torque.

    Returns
    -------
    int or None
        Index in the order of :class:`~frictioncli.report.grid_replay.ScheduleGrid`; None if no
        setting is better than no correction: all phases are on target without, or the best setting
        makes the worst phase worse.
    """
    target = np.array([target_error(unit, phase.uncorrected) for phase in phases])
    uncorrected = np.array([phase.uncorrected for phase in phases]) / target
    if np.all(uncorrected <= 1.0):
        return None
    # shape (phases, settings)
    relative = np.array([phase.epsilon for phase in phases]) / target[:, np.newaxis]
    worst: Array = relative.max(axis=0)
    enough: Flags = worst <= 1.0
    if enough.any():
        counts = np.sum([[len(one.time) for one in phase.events] for phase in phases], axis=0)
        fewest = enough & (counts == counts[enough].min())
        return int(np.argmin(np.where(fewest, worst, np.inf)))
    best = int(np.argmin(worst))
    return best if worst[best] < uncorrected.max() else None
