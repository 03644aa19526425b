"""Friction as a polynomial of speed, which MuJoCo takes from version 4 on.

MuJoCo 4 damps a joint with ``a*v + b*v*|v| + c*v**3``. Its DC-motor actuator has LuGre friction and
the temperature of the winding, but neither friction depends on that temperature nor on the load.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.operating_conditions import OperatingConditions

_POINTS = 400
"""Number of equally spaced speeds of the fit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PolynomialFriction:
    """Least-squares fit of a polynomial of speed to (16), and its error.

    Attributes
    ----------
    dry : float
        Coulomb friction. [N·m]
    damping : tuple of float
        Coefficients of speed, its square and its cube. [N·m·s/rad], [N·m·s²/rad²], [N·m·s³/rad³]
    rms : float
        RMS error at the conditions of the fit. [N·m]
    fastest : float
        Highest speed of the fit; beyond it the cube takes over. [deg/s]
    """

    dry: float
    damping: tuple[float, float, float]
    rms: float
    fastest: float

    def describe(self) -> str:
        """Return the fit as a line of text."""
        damping = " ".join(f"{one:.6g}" for one in self.damping)
        return (
            f'MuJoCo 4 takes a polynomial: damping="{damping}" frictionloss="{self.dry:.6g}" loses'
            f" {self.rms:.3g} N·m RMS there, up to {self.fastest:.4g} deg/s; its DC-motor actuator"
            " has no friction that depends on temperature or load either"
        )


def polynomial_friction(
    joint: DeployedModel, conditions: OperatingConditions, factor: float
) -> PolynomialFriction | None:
    """Return the polynomial, or None if it would fall with speed somewhere.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    conditions : OperatingConditions
        Conditions of the fit.
    factor : float
        Torque at the joint per unit of the log's torque. [N·m/A]
    """
    degrees = np.linspace(*conditions.speeds, _POINTS)
    speed = np.radians(degrees)
    wanted = factor * joint.friction(
        load=conditions.load, speed=degrees, temperature=conditions.temperature
    )
    columns = np.column_stack([np.ones_like(speed), speed, speed**2, speed**3])
    found = lsq_linear(columns, wanted, bounds=([0.0, 0.0, -np.inf, 0.0], np.inf)).x
    slope = found[1] + 2 * found[2] * speed + 3 * found[3] * speed**2
    if np.min(slope) < 0.0:
        return None
    return PolynomialFriction(
        dry=float(found[0]),
        damping=(float(found[1]), float(found[2]), float(found[3])),
        rms=float(np.sqrt(np.mean(np.square(columns @ found - wanted)))),
        fastest=float(degrees[-1]),
    )
