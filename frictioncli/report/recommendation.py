"""Setting of the corrections that is recommended: the fewest that keep every phase on target."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.report.grid_replay import ReplayedPhase


def recommended_setting(phases: Sequence[ReplayedPhase], target: float) -> int | None:
    """Return the index of the setting with the fewest corrections that keeps all phases on target.

    Of settings with equally many corrections it is the one with the smallest error. If no setting
    reaches the target everywhere, it is the one whose worst error is smallest against the target.

    Parameters
    ----------
    phases : sequence of ReplayedPhase
        The phases of all runs under every setting.
    target : float
        Error (21) that is small enough. [torque unit]

    Returns
    -------
    int or None
        Index in the order of :class:`~frictioncli.report.grid_replay.ScheduleGrid`; None if no
        setting is better than no correction: all phases are on target without, or the best setting
        makes the worst phase worse.
    """
    uncorrected = np.array([phase.uncorrected for phase in phases]) / target
    if np.all(uncorrected <= 1.0):
        return None
    # shape (phases, settings)
    relative = np.array([phase.epsilon for phase in phases]) / target
    worst: Array = relative.max(axis=0)
    enough: Flags = worst <= 1.0
    if enough.any():
        counts = np.sum([[len(one.time) for one in phase.events] for phase in phases], axis=0)
        fewest = enough & (counts == counts[enough].min())
        return int(np.argmin(np.where(fewest, worst, np.inf)))
    best = int(np.argmin(worst))
    return best if worst[best] < uncorrected.max() else None
