"""What of a joint's samples moves: the ground on which the other watches judge."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.inspection.monitors.windows import Window
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.samples.differentiation import max_gap
from frictioncli.pairs.settings import SteadySettings

_REACH = 4
"""Rows to either side over which a joint must move to count as moving."""

_SLOWEST = SteadySettings().min_speed


@dataclass(frozen=True, slots=True)
class JointRows:
    """The rows of a window that belong to one joint, context included.

    ``joined`` tells of each row whether it follows the row before within five periods; ``moving``
    whether the joint moves there. All of shape (n,).
    """

    window: Window
    joint: int
    joined: Flags
    moving: Flags

    def channel(self, name: str) -> Array | None:
        """Return the values of a channel; None where the log has none."""
        return self.window.rows.columns.get((self.joint, name))

    def required(self, name: str) -> Array:
        """Return the values of a channel that every log has."""
        return self.window.rows.columns[self.joint, name]

    @property
    def new(self) -> slice:
        """The rows that no other window counts."""
        return self.window.new


def joint_rows(window: Window, joint: int, period: float) -> JointRows:
    """Return a joint's rows with what moves.

    Parameters
    ----------
    window : Window
        The rows.
    joint : int
        Whose channels.
    period : float
        Time between samples, roughly. [s]
    """
    time, position = window.rows.time, window.rows.columns[joint, names.POSITION]
    step = np.diff(time, prepend=-np.inf)
    joined = (step > 0) & (step <= max_gap(period))
    low = np.maximum(np.arange(len(time)) - _REACH, 0)
    high = np.minimum(np.arange(len(time)) + _REACH, len(time) - 1)
    elapsed = np.abs(time[high] - time[low])
    moving = np.abs(position[high] - position[low]) > _SLOWEST * np.maximum(elapsed, period)
    return JointRows(window, joint, joined, moving)
