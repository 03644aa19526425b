"""Whether a torque holds friction at all, and with which sign."""

import numpy as np

from frictioncli.errors import NotEnoughData
from frictioncli.regression.equation import JointEquations, friction_columns
from frictioncli.regression.estimate import RegressionEstimate

_TINY = 0.03
"""Friction below this share of the torque is taken for what an outer control loop left over."""


def friction_sign(
    equations: JointEquations, estimate: RegressionEstimate, joint: int, sign: int | None
) -> int:
    """Return the sign convention; refuse a torque that holds hardly any friction.

    Friction takes power from the motor. A torque measured behind the gear, or freed of friction by
    the controller, has none to show.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    estimate : RegressionEstimate
        Their fit.
    joint : int
        Number of the joint, for messages.
    sign : {+1, -1} or None
        As told by the user.

    Raises
    ------
    NotEnoughData
        If mean friction is below 3 % of the torque, not told from 0, or against the sign told.
    """
    mean, deviation = _mean_friction(equations, estimate)
    torque = equations.rows.torque
    size = float(np.sqrt(np.mean(np.square(torque - torque.mean() * estimate.terms.offset))))
    tiny = abs(mean) < _TINY * size
    if tiny or abs(mean) < estimate.quantile() * deviation or (sign and mean * sign < 0):
        raise NotEnoughData(
            f"joint {joint}: the torque holds no friction to speak of (mean {mean:.2g} ±"
            f" {estimate.quantile() * deviation:.2g} at {size:.3g} RMS of torque): it was measured"
            " behind the gear, or friction was taken out of it; choose the motor's torque or"
            " current with --map"
        )
    return sign or (1 if mean > 0 else -1)


def _mean_friction(equations: JointEquations, estimate: RegressionEstimate) -> tuple[float, float]:
    """Return the mean of the modelled friction over all rows, and its standard deviation."""
    columns = friction_columns(
        equations,
        estimate.terms,
        estimate.squared_load,
        estimate.parameters.get("delta", 0.0),
        estimate.delay,
    )
    gradient = np.zeros(len(estimate.names))
    first = len(estimate.terms.load_names)
    mean = (equations.direction[:, np.newaxis] * columns).mean(axis=0)
    gradient[first : first + len(mean)] = mean
    value = gradient @ np.array([estimate.parameters[name] for name in estimate.names])
    if "delta" in estimate.parameters:
        # the errors of gamma and delta cancel for the most part
        falling = np.abs(columns[:, estimate.terms.friction.index("gamma")])
        slope = -estimate.parameters["gamma"] * np.mean(falling * equations.temperature)
        gradient[estimate.names.index("delta")] = slope
    variance = float(gradient @ estimate.covariance @ gradient)
    return float(value), float(np.sqrt(max(variance, 0.0)))
