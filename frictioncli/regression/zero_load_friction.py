"""Friction without load that a regression found, at speeds of its log."""

import numpy as np

from frictioncli.regression.equation import JointEquations
from frictioncli.regression.estimate import RegressionEstimate

_SAME_SPEED = 0.05
"""Speeds that differ by a smaller share count as one."""


def friction_at(
    equations: JointEquations, estimate: RegressionEstimate, sign: int
) -> dict[float, tuple[float, float, float]]:
    """Return friction without load at up to three speeds of the log, with its interval.

    They are the median and, where they are told from it, the 10 % and the 90 % quantile.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    estimate : RegressionEstimate
        The parameters.
    sign : {+1, -1}
        Sign convention of the log.

    Returns
    -------
    dict of float to (float, float, float)
        Friction and the ends of its interval by speed [deg/s]. [torque unit]
    """
    found = {}
    delta = estimate.parameters.get("delta", 0.0)
    cold = float(np.exp(-delta * np.median(equations.temperature)))
    temperature = float(np.median(equations.temperature))
    low, middle, high = np.quantile(np.abs(equations.velocity), [0.1, 0.5, 0.9]).tolist()
    slower = [low] if low < (1 - _SAME_SPEED) * middle else []
    faster = [high] if high > (1 + _SAME_SPEED) * middle else []
    for speed in (*slower, middle, *faster):
        root = float(np.sqrt(speed))
        gamma = estimate.parameters.get("gamma", 0.0)
        slopes = {
            "tau_c": 1.0,
            "beta": root,
            "gamma": root * cold,
            "delta": -temperature * gamma * root * cold,
        }
        law = estimate.terms.speed_law
        slopes |= dict(zip(law.names, law.columns(np.array([speed]))[0].tolist(), strict=True))
        gradient = np.array([slopes.get(name, 0.0) for name in estimate.names])
        value = sign * sum(
            estimate.parameters[name] * slopes[name]
            for name in ("tau_c", "beta", "gamma", *law.names)
            if name in estimate.parameters
        )
        variance = float(gradient @ estimate.covariance @ gradient)
        half = estimate.quantile() * float(np.sqrt(max(variance, 0.0)))
        found[speed] = (value, value - half, value + half)
    return found
