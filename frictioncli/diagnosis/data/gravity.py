r"""Gravity torque of a rotating arm, with one payload or with several that are known.

.. math:: L_g(q, m) = P \cos q + Q \sin q + c + m (p \cos q + r \sin q)

with the joint angle *q* and the mass *m* of the payload. A payload always sits at the same place,
so that *p* and *r* do not depend on its mass: five coefficients for any number of payloads. Free
coefficients for each payload would absorb a wrong mass in the manifest, or a tool mounted
elsewhere; with five coefficients these show as misfit and can be diagnosed.

Where no two payloads are known, *p* and *r* cannot be distinguished from *P* and *Q* and are left
out. Where only some rows have a payload, the others count as moved without one, 0 kg. If that is
wrong, it shows as misfit too.
"""

import msgspec
import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.errors import TableError

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


def columns_of(torques: pd.DataFrame, *, payloads: bool) -> Array:
    """Return the columns of the gravity torque of rows of a table of torques.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.
    payloads : bool
        Whether gravity depends on the payload: five columns instead of three.
    """
    position = torques["position"].to_numpy(float)
    return gravity_columns(position, known_payload(torques) if payloads else None)


def by_angle(columns: Array) -> Array:
    """Return the derivatives of the columns of gravity by the joint angle [1/deg].

    Parameters
    ----------
    columns : ndarray, shape (rows, 3) or (rows, 5)
        As of :func:`gravity_columns`, or their derivatives.

    Returns
    -------
    ndarray, shape (rows, 3) or (rows, 5)
        The derivatives.

    Examples
    --------
    >>> import numpy as np
    >>> print(by_angle(gravity_columns(np.array([0.0, 90.0]))).round(4))
    [[-0.      0.0175  0.    ]
     [-0.0175  0.      0.    ]]
    """
    derivative = np.zeros_like(columns)
    for cosine in range(0, columns.shape[1], len(NAMES)):
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
    columns : ndarray, shape (rows, 3) or (rows, 5)
        As of :func:`gravity_columns`.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients. [N·m], [N·m/kg]

    Examples
    --------
    >>> import numpy as np
    >>> float(carried_load(gravity_columns(np.array([0.0])), np.array([95.0, 0.0, 4.0]))[0])
    99.0
    """
    return np.asarray(columns @ gravity)


class GravityCoefficients(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Coefficients of the gravity torque, as ``extended-model.json`` states them.

    Attributes
    ----------
    cosine, sine : float
        Coefficients of the cosine and the sine of the joint angle. [N·m]
    offset : float
        Constant. [N·m]
    cosine_per_kg, sine_per_kg : float or None
        Coefficients of the cosine and the sine times the payload; none where no two payloads are
        known. [N·m/kg]
    """

    cosine: float
    sine: float
    offset: float
    cosine_per_kg: float | None = None
    sine_per_kg: float | None = None

    def __post_init__(self) -> None:
        if (self.cosine_per_kg is None) != (self.sine_per_kg is None):
            raise ValueError("expected both cosine_per_kg and sine_per_kg, or none")


def gravity_document(gravity: Array) -> GravityCoefficients:
    """Return three or five coefficients of gravity by name, as documents state them."""
    names = (*NAMES, *PER_MASS)[: len(gravity)]
    return GravityCoefficients(**dict(zip(names, map(float, gravity), strict=True)))


def stated_gravity(stated: GravityCoefficients, count: int | None = None) -> Array:
    """Return the coefficients that a document states, shape (3,) or (5,).

    Parameters
    ----------
    stated : GravityCoefficients
        The coefficients.
    count : int, optional
        Number of coefficients to return; those per mass are zero if the document has none. By
        default as many as the document states.

    Raises
    ------
    TableError
        If the document states coefficients per mass and only three are wanted.
    """
    coefficients = [stated.cosine, stated.sine, stated.offset]
    if stated.cosine_per_kg is not None and stated.sine_per_kg is not None:
        coefficients += [stated.cosine_per_kg, stated.sine_per_kg]
    found = np.array(coefficients)
    if count is None or count == len(found):
        return found
    if count < len(found):
        raise TableError(
            "the extended model's gravity goes with the payload, and these torques have no two"
            " payloads; run 'frictioncli diagnose' again"
        )
    return np.append(found, np.zeros(count - len(found)))
