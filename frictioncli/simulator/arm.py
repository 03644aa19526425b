"""Arm that the joint moves: bodies, gravity torque and inertia about the joint axis."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array

GRAVITY = 9.81
"""Acceleration of free fall [m/s²]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A rigid body on the link.

    Attributes
    ----------
    name : str
        Name of the body.
    mass : float
        Mass. [kg]
    along : float
        Distance of its centre of mass from the axis, along the link. [m]
    across : float
        Offset of its centre of mass perpendicular to the link. [m]
    own_inertia : float
        Inertia about its centre of mass, parallel to the joint axis. [kg·m²]
    """

    name: str
    mass: float
    along: float
    across: float
    own_inertia: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """Bodies that turn with the joint; at 0 deg the link is horizontal.

    Attributes
    ----------
    bodies : tuple of Body
        Links and wrist.
    payload : Body
        Body at the flange.
    rotor_inertia : float
        Inertia of rotor and gear input, times the square of the gear ratio. [kg·m²]
    """

    bodies: tuple[Body, ...]
    payload: Body
    rotor_inertia: float

    def gravity_coefficients(self) -> tuple[float, float]:
        """Return P and Q of the gravity torque ``P cos q + Q sin q`` [N·m]."""
        bodies = (*self.bodies, self.payload)
        cosine = sum(GRAVITY * body.mass * body.along for body in bodies)
        sine = -sum(GRAVITY * body.mass * body.across for body in bodies)
        return cosine, sine

    def gravity_torque(self, position: ArrayLike) -> Array:
        """Return the torque that holds the arm at an angle.

        Parameters
        ----------
        position : array_like
            Joint angle. [deg]

        Returns
        -------
        ndarray
            Gravity torque. [N·m]

        Examples
        --------
        >>> payload = Body(name="payload", mass=2.0, along=1.0, across=0.0)
        >>> Arm(bodies=(), payload=payload, rotor_inertia=0.0).gravity_torque([0.0, 90.0]).round(6)
        array([19.62,  0.  ])
        """
        cosine, sine = self.gravity_coefficients()
        angle = np.radians(np.asarray(position, dtype=float))
        return np.asarray(cosine * np.cos(angle) + sine * np.sin(angle))

    def inertia(self) -> float:
        """Return the inertia about the joint axis [kg·m²]."""
        bodies = (*self.bodies, self.payload)
        arm = sum(b.own_inertia + b.mass * (b.along**2 + b.across**2) for b in bodies)
        return arm + self.rotor_inertia
