r"""Torque that was logged later than the position, and what that does to friction.

Behind a delay *d* of the log, of the drive's filter or of both, a move with velocity :math:`\pm v`
shows at the angle *q* the torque of :math:`q \mp v d`. Half the difference of both directions is
then not the friction alone but, to first order,

.. math:: \tau - d\, v\, \frac{dL}{dq} .

Over angles on one side of the balance of gravity this looks like friction that grows or falls with
speed, and a fit without it is wrong by many of its standard errors. Within a pair it changes sign
and size with the slope of gravity, and with the speed at every angle; no friction that belongs to
the angle does both. *d* is therefore the coefficient of :math:`-v\, dL/dq` beside one level per
pair and one per angle (two-way fixed effects [1]_), with an error that allows for whatever pairs or
angles share [2]_.

References
----------
.. [1] B. H. Baltagi, Econometric Analysis of Panel Data, 2021, doi:10.1007/978-3-030-53953-5.
.. [2] K.-Y. Liang and S. L. Zeger, "Longitudinal data analysis using generalized linear models,"
   Biometrika 73(1), 1986, doi:10.1093/biomet/73.1.13.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Indices
from frictioncli.model.zero_load import PAIR_KEY

_GREATEST_ERROR = 0.01
"""Standard error of a delay up to which it counts as determined. [s]"""

_FORM = (0.001, 0.05)
"""Standard error by what else goes with speed along the angle: at least [s], and as a share."""

_POSSIBLE = (-0.02, 0.2)
"""Delays that logs have; what looks like another one is something else. [s]"""

_ANGLES = 400
"""Greatest number of different angles that have a level of their own."""

_TOLERANCE = 1e-9
"""Share of the squared length below which nothing is left of a column."""

FREED = "what this adds is taken off friction"
"""What a note on a delay says of a model that was fitted to friction freed of it."""

_Z95 = 1.959963984540054

UNKNOWN_ERROR = 0.01
"""Standard deviation of a delay that the data do not tell: a sample, or a usual filter. [s]"""


@dataclass(frozen=True, slots=True)
class TorqueDelay:
    """Mean time by which the torque in a log is late.

    Attributes
    ----------
    value, error : float
        Its estimate and standard error. [s]
    """

    value: float
    error: float

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval [s]."""
        return self.value - _Z95 * self.error, self.value + _Z95 * self.error


def late_column(torques: pd.DataFrame) -> Array:
    """Return by how much a delay changes the friction torque, shape (rows,) [N·m/s].

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint. Gravity is fitted to the
        load torque of each run, payload and pose.

    Examples
    --------
    >>> angle = np.arange(0.0, 100.0, 10.0)
    >>> load = 50.0 * np.cos(np.radians(angle))
    >>> rows = pd.DataFrame({"run": "a", "position": angle, "speed": 60.0, "load_torque": load})
    >>> bool(np.allclose(late_column(rows), 60.0 * np.radians(50.0) * np.sin(np.radians(angle))))
    True
    """
    angle = np.radians(torques["position"].to_numpy(float))
    load = torques["load_torque"].to_numpy(float)
    slope = np.zeros(len(torques))
    keys = [torques["run"]]
    keys += [torques[name].astype(float) for name in ("payload", "pose") if name in torques]
    for rows in torques.groupby(keys, sort=False, observed=True, dropna=False).indices.values():
        own = angle[rows]
        columns = np.column_stack([np.cos(own), np.sin(own), np.ones(len(own))])
        cosine, sine, _ = np.linalg.lstsq(columns, load[rows], rcond=1e-6)[0]
        slope[rows] = np.radians(sine * np.cos(own) - cosine * np.sin(own))
    return -torques["speed"].to_numpy(float) * slope


def torque_delay(torques: pd.DataFrame) -> TorqueDelay | None:
    """Return by how much the torque of a log is late.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint, friction and load in the
        same unit.

    Returns
    -------
    TorqueDelay or None
        None where the data do not determine it, or where it would be one that no log has.
    """
    pair = torques.groupby(PAIR_KEY, sort=False, observed=True).ngroup().to_numpy()
    angle = _angles(torques["position"].to_numpy(float))
    friction, load = torques["friction_torque"].to_numpy(float), torques["load_torque"]
    late = late_column(torques)
    known = np.isfinite(friction) & np.isfinite(late)
    pair, angle = _numbered(pair[known]), _numbered(angle[known])
    if len(pair) < 3:
        return None
    levels = _Levels.of(pair, angle)
    columns = np.column_stack([late[known], np.square(load.to_numpy(float)[known])])
    left = levels.taken_off(columns)
    length = np.linalg.norm(left, axis=0)
    before = np.linalg.norm(columns, axis=0)
    if length[0] ** 2 <= _TOLERANCE * max(before[0], 1e-300) ** 2:
        return None
    kept = [0, 1] if length[1] ** 2 > _TOLERANCE * before[1] ** 2 else [0]
    units = left[:, kept] / length[kept]
    inverse = np.linalg.pinv(units.T @ units)
    target = levels.taken_off(friction[known][:, np.newaxis])[:, 0]
    coefficients = inverse @ (units.T @ target)
    residual = target - units @ coefficients
    freedom = max(len(residual) - len(levels.pairs) - levels.rank - len(kept), 1)
    score = units * residual[:, np.newaxis]
    variance = [float(inverse[0, 0] * (residual @ residual) / freedom)]
    for cluster in (pair, angle):
        sums = np.column_stack([np.bincount(cluster, one) for one in score.T])
        variance.append(float((inverse @ (sums.T @ sums) @ inverse)[0, 0]))
    value = float(coefficients[0] / length[0])
    own = float(np.sqrt(max(variance)) / length[0])
    found = TorqueDelay(value, float(np.linalg.norm([own, _FORM[0], _FORM[1] * value])))
    low, high = found.interval
    possible = high >= _POSSIBLE[0] and low <= _POSSIBLE[1]
    return found if found.error <= _GREATEST_ERROR and possible else None


def without_delay(torques: pd.DataFrame, delay: float | None) -> pd.DataFrame:
    """Return torques whose friction is freed of what a delay adds to it.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    delay : float or None
        Mean time by which the torque is late; none where it is not known. [s]
    """
    if not delay or torques.empty:
        return torques
    added = delay * late_column(torques)
    return torques.assign(friction_torque=torques["friction_torque"] - added)


@dataclass(frozen=True, slots=True)
class _Levels:
    """One level per pair and one per angle, which are taken off columns.

    Attributes
    ----------
    pair, angle : ndarray of int, shape (rows,)
        Numbers of both.
    pairs : ndarray, shape (pairs,)
        Rows of each pair.
    inverse : ndarray, shape (angles, angles)
        Pseudo-inverse of the inner products of the angles' columns within the pairs.
    rank : int
        Number of levels of angles that the pairs determine.
    """

    pair: Indices
    angle: Indices
    pairs: Array
    inverse: Array
    rank: int

    @classmethod
    def of(cls, pair: Indices, angle: Indices) -> "_Levels":
        pairs = np.bincount(pair).astype(float)
        count = int(angle.max()) + 1
        both = np.bincount(pair * count + angle, minlength=len(pairs) * count)
        both = both.reshape(len(pairs), count).astype(float)
        products = np.diag(both.sum(axis=0)) - both.T @ (both / pairs[:, np.newaxis])
        values, vectors = np.linalg.eigh(products)
        kept = values > _TOLERANCE * max(float(values[-1]), 1e-300)
        inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
        return cls(pair, angle, pairs, inverse, int(kept.sum()))

    def taken_off(self, columns: Array) -> Array:
        """Return what the levels leave of columns, shape (rows, columns)."""
        return np.column_stack([self._taken_off(column) for column in columns.T])

    def _taken_off(self, column: Array) -> Array:
        within = self._within(column)
        by_angle = np.bincount(self.angle, within, minlength=len(self.inverse))
        return within - self._within((self.inverse @ by_angle)[self.angle])

    def _within(self, column: Array) -> Array:
        return np.asarray(column - (np.bincount(self.pair, column) / self.pairs)[self.pair])


def _angles(position: Array) -> Indices:
    """Return the number of each row's angle; very many different ones are put into groups."""
    values, number = np.unique(np.round(position, 6), return_inverse=True)
    if len(values) > _ANGLES:
        edges = np.linspace(values[0], values[-1], _ANGLES + 1)[1:-1]
        number = np.digitize(position, edges)
    return np.asarray(number)


def _numbered(labels: Indices) -> Indices:
    """Return labels as numbers from 0 without gaps."""
    return np.asarray(np.unique(labels, return_inverse=True)[1])
