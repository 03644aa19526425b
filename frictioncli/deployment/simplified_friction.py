"""Simplified friction of robot simulators: Coulomb friction and viscous damping."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from frictioncli.arrays import Array
from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.operating_conditions import OperatingConditions
from frictioncli.errors import OptionError

_POINTS = 400
"""Number of equally spaced speeds of the fit."""

_GRID = 21
"""Number of loads, and of temperatures, over which the error is averaged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimplifiedFriction:
    """Least-squares fit of ``dry + damping * speed`` to (16), and its error.

    Attributes
    ----------
    dry : float
        Coulomb friction. [N·m]
    damping : float
        Viscous damping. [N·m·s/rad]
    rms, worst : float
        RMS and greatest error at the conditions of the fit. [N·m]
    worst_speed : float
        Speed of the greatest error. [deg/s]
    rms_in_range, worst_in_range : float
        RMS and greatest error over all speeds, loads and temperatures of the data. [N·m]
    """

    dry: float
    damping: float
    rms: float
    worst: float
    worst_speed: float
    rms_in_range: float
    worst_in_range: float

    def torque(self, speed: Array) -> Array:
        """Return the friction torque.

        Parameters
        ----------
        speed : ndarray
            Absolute velocity. [deg/s]

        Returns
        -------
        ndarray
            Friction torque. [N·m]
        """
        return self.dry + self.damping * np.radians(speed)

    def describe(self, conditions: str) -> list[str]:
        """Return the fit and its errors as lines of text.

        Parameters
        ----------
        conditions : str
            Text of the conditions of the fit.
        """
        return [
            f"dry friction {self.dry:.6g} N·m, damping {self.damping:.6g} N·m·s/rad: least squares"
            f" to the measured friction law, {conditions}",
            f"lost there: {self.rms:.3g} N·m RMS, at most {self.worst:.3g} N·m at"
            f" {self.worst_speed:.3g} deg/s",
            f"lost over all loads and temperatures of the data: {self.rms_in_range:.3g} N·m RMS,"
            f" up to {self.worst_in_range:.3g} N·m, since this form has neither",
        ]


def simplified_friction(
    joint: DeployedModel, conditions: OperatingConditions, torque_constant: float | None
) -> SimplifiedFriction:
    """Return the least-squares fit of simplified friction with non-negative parts.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    conditions : OperatingConditions
        Conditions of the fit.
    torque_constant : float or None
        Torque at the joint per unit of the log's torque. [N·m/A]

    Returns
    -------
    SimplifiedFriction
        The fit with its errors.

    Raises
    ------
    OptionError
        If the log's torque is not in N·m at the joint and no constant is given.
    """
    factor = to_newton_metres(joint, torque_constant)
    speed = np.linspace(*conditions.speeds, _POINTS)

    def model_torque(load: float, temperature: float) -> Array:
        return factor * joint.friction(load=load, speed=speed, temperature=temperature)

    columns = np.column_stack([np.ones_like(speed), np.radians(speed)])
    (dry, damping), _ = nnls(columns, model_torque(conditions.load, conditions.temperature))
    fitted = columns @ [dry, damping]
    error = np.abs(fitted - model_torque(conditions.load, conditions.temperature))
    # (16) is monotonic in temperature and in the absolute load: the extremes are at the ends
    loads = (
        0.0 if conditions.loads[0] < 0 < conditions.loads[1] else min(map(abs, conditions.loads)),
    )
    corners = [
        (load, temperature)
        for load in (*loads, max(map(abs, conditions.loads)))
        for temperature in conditions.temperatures
    ]
    everywhere = [
        fitted - model_torque(load, temperature)
        for load in np.linspace(*conditions.loads, 2 * _GRID + 1)[1::2]
        for temperature in np.linspace(*conditions.temperatures, 2 * _GRID + 1)[1::2]
    ]
    return SimplifiedFriction(
        dry=float(dry),
        damping=float(damping),
        rms=float(np.sqrt(np.mean(np.square(error)))),
        worst=float(np.max(error)),
        worst_speed=float(speed[np.argmax(error)]),
        rms_in_range=float(np.sqrt(np.mean(np.square(everywhere)))),
        worst_in_range=max(
            float(np.max(error)),
            *(float(np.max(np.abs(fitted - model_torque(*corner)))) for corner in corners),
        ),
    )


def to_newton_metres(joint: DeployedModel, torque_constant: float | None) -> float:
    """Return the torque at the joint [N·m] per unit of the log's torque.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    torque_constant : float or None
        The value that was given. [N·m/A]

    Raises
    ------
    OptionError
        If it is given without need, or needed and not given.
    """
    model = joint.model
    found = f"{model.torque_unit} at the {model.torque_side}"
    if found == "N·m at the joint":
        if torque_constant is not None:
            raise OptionError(
                f"--torque-constant {torque_constant:g}: joint {model.joint}'s torque is in {found}"
                " already; leave it out"
            )
        return 1.0
    if torque_constant is None:
        raise OptionError(
            f"joint {model.joint}: the log's torque is in {found}, and a simulator needs N·m at the"
            f" joint; give --torque-constant, the N·m at the joint per {model.torque_unit} of the"
            " log (motor's torque constant times gear ratio)"
        )
    return torque_constant
