"""Rows of one joint in a window: which are contiguous, and in which the joint moves."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.inspection.monitors.windows import Window
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.samples.differentiation import max_gap
from frictioncli.pairs.settings import SteadySettings

_REACH = 4
"""Rows to either side from which the mean speed is taken."""

_SLOWEST = SteadySettings().min_speed


@dataclass(frozen=True, slots=True)
class JointRows:
    """The rows of a window for one joint, context included.

    Attributes
    ----------
    window : Window
        The rows of all joints.
    joint : int
        The joint.
    contiguous : ndarray of bool, shape (rows,)
        Whether a row follows the row before within five periods.
    moving : ndarray of bool, shape (rows,)
        Whether the joint moves.
    """

    window: Window
    joint: int
    contiguous: Flags
    moving: Flags

    def channel(self, name: str) -> Array | None:
        """Return the values of a channel; None where the log has none."""
        return self.window.rows.columns.get((self.joint, name))

    def required(self, name: str) -> Array:
        """Return the values of a channel that every log has."""
        return self.window.rows.columns[self.joint, name]

    @property
    def new(self) -> slice:
        """The rows without the context, each in exactly one window."""
        return self.window.new


def joint_rows(window: Window, joint: int, period: float) -> JointRows:
    """Return the rows of a joint in a window.

    Parameters
    ----------
    window : Window
        The rows.
    joint : int
        The joint.
    period : float
        Approximate time between samples. [s]
    """
    time, position = window.rows.time, window.rows.columns[joint, names.POSITION]
    step = np.diff(time, prepend=-np.inf)
    contiguous = (step > 0) & (step <= max_gap(period))
    low = np.maximum(np.arange(len(time)) - _REACH, 0)
    high = np.minimum(np.arange(len(time)) + _REACH, len(time) - 1)
    elapsed = np.abs(time[high] - time[low])
    moving = np.abs(position[high] - position[low]) > _SLOWEST * np.maximum(elapsed, period)
    return JointRows(window, joint, contiguous, moving)
