r"""Columns of the inverse dynamics of a whole arm, from its kinematics in a URDF.

Torque of a rigid arm is linear in masses, centres of mass and inertias [1]_,

.. math:: u = Y(\varphi, \dot\varphi, \ddot\varphi)\, \pi + J_r \ddot\varphi_j + \dots

so that a joint that moves with others has more columns, not another equation. Of these columns only
as many are kept as the motion tells apart: the base parameters [2]_. Masses of the URDF are not
used, only its axes and lengths.

References
----------
.. [1] C. G. Atkeson, C. H. An, and J. M. Hollerbach, "Estimation of inertial parameters of
   manipulator loads and links," Int. J. Robotics Research 5(3), 1986,
   doi:10.1177/027836498600500306.
.. [2] M. Gautier, "Numerical calculation of the base inertial parameters of robots," J. Robotic
   Systems 8(4), 1991, doi:10.1002/rob.4620080405.
"""

from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from scipy.linalg import qr

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.errors import OptionError
from frictioncli.regression.inertial_bodies import pseudo_inertia

_INDEPENDENT = 1e-3
"""A column of which the others leave less than this share is not kept."""

_RANKED = 4000
"""Rows from which the independent columns are chosen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmColumns:
    """Columns of the base parameters in the torque of one joint.

    Attributes
    ----------
    torque : ndarray, shape (rows, columns)
        Torque of a unit of each parameter, in motion.
    gravity : ndarray, shape (rows, columns)
        The same at rest.
    bodies : ndarray, shape (rows, 10 bodies + joints)
        Torque of a unit of each parameter of the links, of the payloads but the lightest, and of
        the rotors, in motion.
    """

    torque: Array
    gravity: Array
    bodies: Array

    def where(self, kept: Flags) -> "ArmColumns":
        """Return the columns at some rows.

        Parameters
        ----------
        kept : ndarray of bool, shape (rows,)
            Whether each is kept.
        """
        return ArmColumns(
            torque=self.torque[kept], gravity=self.gravity[kept], bodies=self.bodies[kept]
        )


class ArmModel:
    """Kinematics of an arm.

    Parameters
    ----------
    path : Path
        The URDF. Its joints that turn are joints 1, 2, ... of the logs, with the same zeros and
        directions; its base stands upright.

    Raises
    ------
    OptionError
        If pinocchio is not installed, the file cannot be read, or a joint slides.
    """

    def __init__(self, path: Path) -> None:
        self._pinocchio = _pinocchio()
        if not path.is_file():
            raise OptionError(f"--urdf {path}: no such file")
        try:
            self._model: Any = self._pinocchio.buildModelFromUrdf(str(path))
        except (ValueError, RuntimeError) as error:
            raise OptionError(f"--urdf {path}: cannot be read as URDF ({error})") from error
        kinds = [joint.shortname() for joint in self._model.joints[1:]]
        if not kinds or self._model.nv != len(kinds) or any("ModelP" in kind for kind in kinds):
            raise OptionError(f"--urdf {path}: expected joints that turn about one axis each")

    @property
    def joints(self) -> int:
        """Number of joints."""
        return int(self._model.nv)

    def start(self, payloads: int) -> Array:
        """Return bodies to start a fit from, shape (bodies, 10): the links, then payloads.

        Parameters
        ----------
        payloads : int
            Payloads besides the lightest; each starts as a ball of 1 kg.
        """
        ball = np.array([1.0, 0, 0, 0, 0.004, 0, 0.004, 0, 0, 0.004])
        links = [np.asarray(one.toDynamicParameters()) for one in list(self._model.inertias)[1:]]
        possible = [np.linalg.eigvalsh(pseudo_inertia(one)).min() > 1e-9 for one in links]
        chosen = [one if good else ball for one, good in zip(links, possible, strict=True)]
        return np.array([*chosen, *([ball] * payloads)])

    def columns(self, joint: int, motion: Array, payload: Numbers | None = None) -> ArmColumns:
        """Return the columns of the torque of one joint.

        Parameters
        ----------
        joint : int
            Its number, from 1.
        motion : ndarray, shape (rows, joints, 3)
            Angle, velocity and acceleration of all joints. [deg], [deg/s], [deg/s²]
        payload : ndarray of int, shape (rows,), optional
            Number of the payload of each row, from 0 for the lightest: a body on the last link.
        """
        model, data = self._model, self._model.createData()
        state = np.radians(motion)
        rest = np.zeros(self.joints)
        torque = np.empty((len(state), 10 * self.joints))
        gravity = np.zeros_like(torque)
        regressor = self._pinocchio.computeJointTorqueRegressor
        neutral = self._pinocchio.neutral(model)
        for row, (angles, velocity, acceleration) in enumerate(state.transpose(0, 2, 1)):
            # joints without limits have cosine and sine in place of the angle
            angle = self._pinocchio.integrate(model, neutral, angles)
            torque[row] = regressor(model, data, angle, velocity, acceleration)[joint - 1]
            gravity[row] = regressor(model, data, angle, rest, rest)[joint - 1]
        numbers = np.zeros(len(state), np.int64) if payload is None else np.asarray(payload)
        heavier = np.arange(1, int(numbers.max(initial=0)) + 1)
        carried = (numbers == heavier[:, np.newaxis]).astype(float)[:, :, np.newaxis]
        # the rotor turns with its own joint
        rotors = np.zeros((len(state), self.joints))
        rotors[:, joint - 1] = state[:, joint - 1, 2]
        own = slice(joint - 1, joint)
        bodies = np.hstack([torque, *(one * torque[:, -10:] for one in carried)])
        still = np.hstack([gravity, *(one * gravity[:, -10:] for one in carried)])
        known = np.hstack([bodies, rotors[:, own]])
        kept = _independent(known)
        return ArmColumns(
            torque=known[:, kept],
            gravity=np.hstack([still, 0 * rotors[:, own]])[:, kept],
            bodies=np.hstack([bodies, rotors]),
        )


def _independent(columns: Array) -> Array:
    """Return the numbers of columns that together span all of them, by pivoted QR."""
    some = columns[:: max(len(columns) // _RANKED, 1)]
    size = np.linalg.norm(some, axis=0)
    moving = np.flatnonzero(size > 1e-9 * size.max())
    triangle, pivot = qr(some[:, moving] / size[moving], mode="r", pivoting=True)
    strength = np.abs(np.diag(triangle))
    return np.sort(moving[pivot[: len(strength)][strength > _INDEPENDENT * strength[0]]])


def _pinocchio() -> ModuleType:
    try:
        import pinocchio  # type: ignore[import-untyped]
    except ImportError as error:
        raise OptionError(
            "--urdf needs pinocchio, which is not installed: pip install 'frictioncli[dynamics]'"
        ) from error
    module: ModuleType = pinocchio
    return module
