r"""Gravity torque of a rotating arm, with one payload or with several that are known.

.. math:: L_g(q, m) = P \cos q + Q \sin q + c + m (p \cos q + r \sin q)

with the joint angle *q* and the mass *m* of the payload. A payload always sits at the same place,
so that *p* and *r* do not depend on its mass: five coefficients for any number of payloads. Free
coefficients for each payload would absorb a wrong mass in the manifest, or a tool mounted
elsewhere; with five coefficients these show as misfit and can be diagnosed.

In poses of the other joints in which gravity is another (:mod:`frictioncli.diagnosis.data.
pose_gravity`), further coefficients of cosine and sine are added to those of the pose of most rows.

Where no two payloads are known, *p* and *r* cannot be distinguished from *P* and *Q* and are left
out. Where only some rows have a payload, the others count as moved without one, 0 kg. If that is
wrong, it shows as misfit too.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array

NAMES = ("cosine", "sine", "offset")
PER_MASS = ("cosine_per_kg", "sine_per_kg")
"""Names of the coefficients in documents; the latter only where two payloads are known."""

_APART = 0.001
"""Masses that differ by less are one payload. [kg]"""


def known_payload(torques: pd.DataFrame) -> Array:
    """Return the payload of each row, NaN where unknown, shape (rows,) [kg].

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.
    """
    if "payload" not in torques:
        return np.full(len(torques), np.nan)
    return torques["payload"].to_numpy(float)


def known_pose(torques: pd.DataFrame) -> Array:
    """Return the pose of each row, NaN where unknown, shape (rows,).

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.
    """
    if "pose" not in torques:
        return np.full(len(torques), np.nan)
    return torques["pose"].to_numpy(float, na_value=np.nan)


def differs(payload: Array) -> bool:
    """Return whether at least two payloads are known.

    Parameters
    ----------
    payload : ndarray, shape (rows,)
        Payloads, NaN where unknown. [kg]
    """
    known = payload[np.isfinite(payload)]
    return known.size > 0 and bool(np.ptp(known) > _APART)


def gravity_columns(position: Array, payload: Array | None = None) -> Array:
    """Return the columns of the gravity torque, shape (rows, 3), or (rows, 5) with payloads.

    Parameters
    ----------
    position : ndarray, shape (rows,)
        Joint angle. [deg]
    payload : ndarray, shape (rows,), optional
        Payload, NaN where unknown: then 0. Without it gravity has one payload. [kg]

    Examples
    --------
    >>> import numpy as np
    >>> print(gravity_columns(np.array([0.0, 90.0]), np.array([2.0, 2.0])).round(12))
    [[1. 0. 1. 2. 0.]
     [0. 1. 1. 0. 2.]]
    """
    angle = np.radians(position)
    columns = [np.cos(angle), np.sin(angle), np.ones_like(angle)]
    if payload is not None:
        mass = np.nan_to_num(payload, nan=0.0)
        columns += [mass * np.cos(angle), mass * np.sin(angle)]
    return np.column_stack(columns)


@dataclass(frozen=True, slots=True)
class GravityForm:
    """What gravity depends on beside the joint's angle.

    Attributes
    ----------
    payloads : bool
        Whether it goes with the payload: five columns instead of three.
    poses : tuple of tuple of int
        Poses of the other joints in which it is another one, those with the same gravity together:
        two columns each. In all other poses it is that of the first columns.
    """

    payloads: bool = False
    poses: tuple[tuple[int, ...], ...] = ()

    @property
    def in_one_pose(self) -> "GravityForm":
        """The same for one pose."""
        return GravityForm(self.payloads)

    @property
    def coefficients(self) -> int:
        """Number of the coefficients."""
        return self.first_coefficients + 2 * len(self.poses)

    @property
    def first_coefficients(self) -> int:
        """Number of the coefficients in the pose of most rows."""
        return len(NAMES) + len(PER_MASS) * self.payloads

    def columns(self, torques: pd.DataFrame) -> Array:
        """Return the columns of the gravity torque, shape (rows, coefficients).

        Parameters
        ----------
        torques : DataFrame
            Rows of :data:`frictioncli.schemas.TORQUES`, or of ramps or starts.
        """
        position = torques["position"].to_numpy(float)
        return self.columns_at(position, known_payload(torques), known_pose(torques))

    def columns_at(self, position: Array, payload: Array, pose: Array) -> Array:
        """Return the same at angles, shape (rows, coefficients).

        Parameters
        ----------
        position, payload, pose : ndarray, shape (rows,)
            Joint angle [deg], payload [kg], number of the pose; NaN where not known.

        Examples
        --------
        >>> import numpy as np
        >>> form = GravityForm(poses=((1, 4),))
        >>> print(form.columns_at(np.zeros(2), np.full(2, np.nan), np.array([0.0, 4.0])))
        [[1. 0. 1. 0. 0.]
         [1. 0. 1. 1. 0.]]
        """
        first = gravity_columns(position, payload if self.payloads else None)
        more = [first[:, :2] * np.isin(pose, one)[:, np.newaxis] for one in self.poses]
        return np.hstack([first, *more])


def by_angle(columns: Array) -> Array:
    """Return the derivatives of the columns of gravity by the joint angle [1/deg].

    Parameters
    ----------
    columns : ndarray, shape (rows, coefficients)
        As of :class:`GravityForm`, or their derivatives.

    Returns
    -------
    ndarray, shape (rows, coefficients)
        The derivatives.

    Examples
    --------
    >>> import numpy as np
    >>> print(by_angle(gravity_columns(np.array([0.0, 90.0]))).round(4))
    [[-0.      0.0175  0.    ]
     [-0.0175  0.      0.    ]]
    """
    derivative = np.zeros_like(columns)
    for cosine in (0, *range(len(NAMES), columns.shape[1], 2)):
        derivative[:, cosine] = -columns[:, cosine + 1]
        derivative[:, cosine + 1] = columns[:, cosine]
    return derivative * (np.pi / 180)


def without_offset(columns: Array) -> Array:
    """Return the columns of gravity with zeros in place of the offset's, of the same shape."""
    without = columns.copy()
    without[:, NAMES.index("offset")] = 0.0
    return without


def carried_load(columns: Array, gravity: Array) -> Array:
    """Return the load torque that the gear carries, shape (rows,) [N·m].

    All of the fitted gravity, as the model of :func:`frictioncli.model.fitting` takes it. A
    constant that is an offset of the sensor, and does not load the gear, is estimated as an effect
    of its own (:mod:`frictioncli.effects.load_offset`).

    Parameters
    ----------
    columns : ndarray, shape (rows, coefficients)
        As of :class:`GravityForm`.
    gravity : ndarray, shape (coefficients,)
        Coefficients. [N·m], [N·m/kg]

    Examples
    --------
    >>> import numpy as np
    >>> float(carried_load(gravity_columns(np.array([0.0])), np.array([95.0, 0.0, 4.0]))[0])
    99.0
    """
    return np.asarray(columns @ gravity)


def form_of(gravity: Array) -> GravityForm:
    """Return the form of three or five coefficients in one pose."""
    return GravityForm(payloads=len(gravity) > len(NAMES))


def sign_convention(rows: pd.DataFrame) -> float:
    """Return the sign convention of separated torques: +1 where forward is load plus friction."""
    if not {"torque_forward", "torque_reverse"} <= set(rows):
        return 1.0
    difference = rows["torque_forward"].to_numpy(float) - rows["torque_reverse"].to_numpy(float)
    return -1.0 if np.nansum(difference * rows["friction_torque"].to_numpy(float)) < 0 else 1.0


def gravity_in_torque(rows: pd.DataFrame, columns: Array) -> Array:
    """Return gravity as it stands in the logged torque, which may have another unit than load."""
    if not {"torque_forward", "torque_reverse"} <= set(rows):
        return np.full(columns.shape[1], np.nan)
    mean = (rows["torque_forward"] + rows["torque_reverse"]).to_numpy(float) / 2
    known = np.isfinite(mean)
    return np.asarray(np.linalg.lstsq(columns[known], mean[known], rcond=None)[0])
