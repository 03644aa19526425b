"""When a change is there: from a moment on, in one stretch only, or in a part of every day."""

import numpy as np

from frictioncli.arrays import Array
from frictioncli.simulator.planted.effect import Range, uniform
from frictioncli.simulator.planted.state import State

LASTING = "lasting"
VANISHING = "vanishing"
RECURRING = "recurring"

HISTORIES = (LASTING, VANISHING, RECURRING)
"""Histories of a change, the default first."""

HISTORY_PARAMETERS = (
    Range("stretch", uniform(0.15, 0.4), "-", "its duration as a share of all, if it vanishes"),
    Range("noon", uniform(0.35, 0.65), "-", "its start as a share of every run, if it recurs"),
)
"""Parameters of the histories, drawn for each of them."""

HISTORY_EQUATION = (
    "h = 1 from t0 on if lasting, from t0 to t0 + dt if vanishing, from t1 to its end in every run"
    " if recurring; else 0"
)
"""When a change is there, as the truth document prints it."""


def change_share(
    state: State, history: str, *, moment: float, stretch: float, noon: float, duration: float = 0.0
) -> Array:
    """Return how much of a change is there.

    Parameters
    ----------
    state : State
        State of the joint.
    history : {"lasting", "vanishing", "recurring"}
        When it is there.
    moment : float
        Its beginning, as a share of the duration of all runs. [-]
    stretch : float
        How long a vanishing change is there, as a share of that duration. [-]
    noon : float
        Beginning of a recurring change, as a share of the duration of each run. [-]
    duration : float
        Width of its beginning and end. [s]

    Returns
    -------
    ndarray
        From 0, none of it, to 1, all of it.
    """
    if history == RECURRING:
        return _begun(state.time - noon * state.operation.times[-1], duration)
    total = state.operation.earlier.total
    begun = _begun((state.progress - moment) * total, duration)
    if history == LASTING:
        return begun
    return begun - _begun((state.progress - moment - stretch) * total, duration)


def _begun(since: Array, duration: float) -> Array:
    if duration == 0.0:
        return np.where(since >= 0.0, 1.0, 0.0)
    return np.asarray(0.5 + 0.5 * np.tanh(since / duration))
