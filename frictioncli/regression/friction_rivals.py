r"""What else friction may do along a motion, beside the law of the equation.

Friction that builds up after a reversal, depends on the load otherwise than as its square, differs
between directions or between speeding up and slowing down, or changes within the log, goes along a
motion as inertia, the slope of gravity or the rate of change of the torque do. An equation without
it takes it for a delay of the torque. A delay is believed that is found beside all of it, too.
"""

import numpy as np

from frictioncli.arrays import Array

_WAYS = (0.5, 2.0, 8.0)
"""Ways after a reversal over which friction builds up. [deg]"""

RIVALS = (
    *(f"after_reversal_{way:g}" for way in _WAYS),
    "load",
    "load_root",
    "speeding_up",
    "direction",
    *(f"time_{power}{of}" for power in (1, 2) for of in ("", "_root")),
)
"""Names of the columns."""


def rival_columns(
    *, root: Array, acceleration: Array, direction: Array, travel: Array, load: Array
) -> Array:
    """Return columns of the torque, shape (rows, columns).

    Parameters
    ----------
    root : ndarray, shape (rows,)
        Root of the speed. [(deg/s)^0.5]
    acceleration : ndarray, shape (rows,)
        Acceleration of the joint. [deg/s²]
    direction : ndarray, shape (rows,)
        +1 where the angle grows, -1 where it falls.
    travel : ndarray, shape (rows,)
        Way since the move began. [deg]
    load : ndarray, shape (rows,)
        Size of the load torque. [N·m]

    Returns
    -------
    ndarray, shape (rows, columns)
        In the order of :data:`RIVALS`.
    """
    order = np.linspace(-1.0, 1.0, len(root))
    friction = [
        *(np.exp(-travel / way) for way in _WAYS),
        load,
        load * root,
        direction * acceleration / np.maximum(root, 1e-3),
        # the same with either sign of the motion
        direction * root,
        *(order**power * part for power in (1, 2) for part in (np.ones_like(root), root)),
    ]
    return np.asarray(direction[:, np.newaxis] * np.column_stack(friction))
