"""The friction function of the source paper, forward and inverted, on plain arrays.

Speeds are in deg/s and temperatures in °C: only these units agree with the published parameters.

References
----------
.. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of industrial
   robot joint with temperature correction by example of KUKA KR10," J. Robotics, 2019,
   doi:10.1155/2019/6931563.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array

FORM = "tau = tau_c + alpha*L^2 + (beta + gamma*exp(-delta*T))*sqrt(v)"
"""Equation (16), as ``model.json`` states it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionParameters:
    """The five parameters of equation (16).

    Attributes
    ----------
    tau_c : float
        Coulomb friction torque. [N·m]
    alpha : float
        Load coefficient. [1/(N·m)]
    beta : float
        Viscous coefficient that stays when hot. [N·m/(deg/s)^0.5]
    gamma : float
        Viscous coefficient that falls with temperature, at 0 °C. [N·m/(deg/s)^0.5]
    delta : float
        Rate of its fall with temperature. [1/°C]
    """

    tau_c: float
    alpha: float
    beta: float
    gamma: float
    delta: float


PUBLISHED = FrictionParameters(tau_c=10.57, alpha=0.0014, beta=3.48, gamma=15.66, delta=0.056)
"""Values published for joint 2 of the KUKA KR10 R900 sixx [1]_, section 3.4."""


def friction_torque(
    parameters: FrictionParameters,
    *,
    load: ArrayLike,
    speed: ArrayLike,
    temperature: ArrayLike,
) -> Array:
    r"""Return the friction torque of equation (16).

    Parameters
    ----------
    parameters : FrictionParameters
        The joint's parameters.
    load : array_like
        Load torque. [N·m]
    speed : array_like
        Absolute joint velocity. [deg/s]
    temperature : array_like
        Temperature parameter, broadcast with the others. [°C]

    Returns
    -------
    ndarray
        Friction torque, positive where it opposes the motion. [N·m]

    Notes
    -----
    Equation (16) of [1]_:

    .. math:: \tau = \tau_c + \alpha L^2 + (\beta + \gamma e^{-\delta T}) \sqrt{\dot\varphi}

    Examples
    --------
    The published joint at 101.2 deg/s, without load, at 25 °C:

    >>> round(float(friction_torque(PUBLISHED, load=0.0, speed=101.2, temperature=25.0)), 1)
    84.4
    """
    p = parameters
    viscous = p.beta + p.gamma * np.exp(-p.delta * np.asarray(temperature, dtype=float))
    return np.asarray(
        p.tau_c
        + p.alpha * np.square(np.asarray(load, dtype=float))
        + viscous * np.sqrt(np.asarray(speed, dtype=float))
    )


def temperature_from_friction(
    parameters: FrictionParameters,
    *,
    friction: ArrayLike,
    load: ArrayLike,
    speed: ArrayLike,
) -> Array:
    r"""Return the temperature at which equation (16) gives the measured friction torque.

    Parameters
    ----------
    parameters : FrictionParameters
        The joint's parameters.
    friction : array_like
        Measured friction torque. [N·m]
    load : array_like
        Load torque. [N·m]
    speed : array_like
        Absolute joint velocity, > 0. [deg/s]

    Returns
    -------
    ndarray
        Temperature parameter; NaN where no temperature gives that friction. [°C]

    Notes
    -----
    Equation (18) of [1]_:

    .. math::

        \hat T = -\frac{1}{\delta} \ln\left(
            \frac{\tau - \tau_c - \alpha L^2}{\gamma \sqrt{\dot\varphi}} - \frac{\beta}{\gamma}
        \right)

    Noise and extrapolation can make the logarithm's argument zero or negative.
    """
    p = parameters
    viscous = np.asarray(friction, dtype=float) - p.tau_c - p.alpha * np.square(load)
    with np.errstate(divide="ignore", invalid="ignore"):
        argument = viscous / (p.gamma * np.sqrt(speed)) - p.beta / p.gamma
        found = -np.log(argument) / p.delta
    return np.where(np.isfinite(found), found, np.nan)


def carried_to_temperature(
    parameters: FrictionParameters,
    *,
    friction: ArrayLike,
    speed: ArrayLike,
    temperature: ArrayLike,
    target: float,
) -> Array:
    r"""Return friction torque carried from its own temperature to another one.

    Parameters
    ----------
    parameters : FrictionParameters
        The joint's parameters.
    friction : array_like
        Friction torque at ``temperature``. [N·m]
    speed : array_like
        Absolute joint velocity. [deg/s]
    temperature : array_like
        Temperature at which ``friction`` was measured. [°C]
    target : float
        Temperature to carry it to. [°C]

    Returns
    -------
    ndarray
        Friction torque at ``target``. [N·m]

    Notes
    -----
    Equations (14) and (15) of [1]_.
    """
    at_target = friction_torque(parameters, load=0.0, speed=speed, temperature=target)
    at_measured = friction_torque(parameters, load=0.0, speed=speed, temperature=temperature)
    return np.asarray(friction, dtype=float) + at_target - at_measured
