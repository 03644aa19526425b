r"""Torque that was logged later than the position, and what that does to friction.

Behind a delay *d* of the log, of the drive's filter or of both, a move with velocity :math:`\pm v`
shows at the angle *q* the torque of :math:`q \mp v d`. Half the difference of both directions is
then not the friction alone but, to first order,

.. math:: \tau - d\, v\, \frac{dL}{dq} .

Over angles on one side of the balance of gravity this looks like friction that grows or falls with
speed, and a fit without it is wrong by many of its standard errors. Within a pair it changes sign
and size with the slope of gravity, and with the speed at every angle; no friction that belongs to
the angle does both. *d* is therefore the coefficient of :math:`-v\, dL/dq` beside one level per
pair and one per angle (two-way fixed effects [1]_).

Friction by load that grows with speed, as :math:`L^2 \sqrt{v}` does, does both, too. Products of
powers of load and speed are therefore estimated beside *d*, with coefficients that are likely small
(:mod:`frictioncli.model.shrunk_regression`); the load itself is among them, for an offset of the
torque that nothing carries. Without them, 1 N·m of such friction counted as a delay of -20 ms.

References
----------
.. [1] B. H. Baltagi, Econometric Analysis of Panel Data, 2021, doi:10.1007/978-3-030-53953-5.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.model.shrunk_regression import ShrunkRegression
from frictioncli.model.two_way_levels import TOLERANCE, Levels
from frictioncli.model.zero_load import PAIR_KEY

_GREATEST_ERROR = 0.01
"""Standard error of a delay up to which it counts as determined. [s]"""

_FORM = (0.001, 0.05)
"""Standard error by what else goes with speed along the angle: at least [s], and as a share."""

_POSSIBLE = (-0.02, 0.2)
"""Delays that logs have; what looks like another one is something else. [s]"""

_LEAST_FREEDOM = 10
"""Degrees of freedom from which residuals tell the noise."""

_ANGLES = 400
"""Greatest number of different angles that have a level of their own."""

_FORM_OF_LOAD = 0.1
"""Standard error by the form of friction over load and speed, as a share of what it changed."""

_LOAD_POWERS = (1.0, 1.5, 2.0)
_SPEED_POWERS = (0.5, 0.75, 1.0)
"""Powers of load and of speed whose products friction may contain."""

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
    return -torques["speed"].to_numpy(float) * _gravity(torques)[1]


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
    friction = torques["friction_torque"].to_numpy(float)
    columns, shrunk = _columns(torques)
    # where a move begins and ends it may not be constant, and few speeds reach the outermost angles
    ends = torques.groupby(PAIR_KEY, sort=False, observed=True)["position"]
    inner = torques["position"].between(
        ends.transform("min"), ends.transform("max"), inclusive="neither"
    )
    known = np.isfinite(friction) & np.isfinite(columns[:, 0]) & inner.to_numpy()
    pair, angle = _numbered(pair[known]), _numbered(angle[known])
    if len(pair) < 3:
        return None
    levels = Levels.of(pair, angle)
    size = np.sqrt(np.mean(np.square(columns[known]), axis=0))
    columns = columns[known] / np.where(size > 0.0, size, 1.0)
    left = levels.taken_off(columns)
    is_left = np.mean(np.square(left), axis=0) > TOLERANCE
    freedom = len(pair) - len(levels.pairs) - levels.rank - int(np.sum(is_left & ~shrunk))
    if not is_left[0] or freedom < _LEAST_FREEDOM:
        return None
    usual = float(np.mean(np.abs(friction[known]))) or 1.0
    found = ShrunkRegression(
        columns=left[:, is_left],
        target=levels.taken_off(friction[known][:, np.newaxis])[:, 0],
        unit=np.where(shrunk, usual, np.inf)[is_left],
        pair=pair,
        angle=angle,
        freedom=freedom,
    ).first()
    value, own, change = (one / size[0] for one in (found.value, found.error, found.change))
    errors = [own, _FORM[0], _FORM[1] * value, _FORM_OF_LOAD * change]
    delay = TorqueDelay(float(value), float(np.linalg.norm(errors)))
    possible = _POSSIBLE[0] <= delay.value <= _POSSIBLE[1]
    return delay if delay.error <= _GREATEST_ERROR and possible else None


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


def _columns(torques: pd.DataFrame) -> tuple[Array, Flags]:
    """Return the columns of a delay, of the load term and of what it adds with speed, if anything.

    The second result tells the last ones. Gravity stands for the load in them: the noise of a load
    that is measured would weaken columns that look like one another.
    """
    speed = torques["speed"].to_numpy(float)
    gravity, slope = _gravity(torques)
    carried = np.abs(gravity)
    loads = [gravity, *(carried**power for power in _LOAD_POWERS)]
    beside = [load * speed**power for load in loads for power in _SPEED_POWERS]
    square = np.square(gravity)
    columns = np.column_stack([-speed * slope, square, *beside])
    return columns, np.arange(columns.shape[1]) > 1


def _gravity(torques: pd.DataFrame) -> tuple[Array, Array]:
    """Return gravity [N·m] and its slope [N·m/deg] by the load of each run, payload and pose."""
    angle = np.radians(torques["position"].to_numpy(float))
    load = torques["load_torque"].to_numpy(float)
    gravity, slope = np.zeros(len(torques)), np.zeros(len(torques))
    keys = [torques["run"]]
    keys += [torques[name].astype(float) for name in ("payload", "pose") if name in torques]
    for rows in torques.groupby(keys, sort=False, observed=True, dropna=False).indices.values():
        own = angle[rows]
        columns = np.column_stack([np.cos(own), np.sin(own), np.ones(len(own))])
        cosine, sine, constant = np.linalg.lstsq(columns, load[rows], rcond=1e-6)[0]
        gravity[rows] = columns @ np.array([cosine, sine, constant])
        slope[rows] = np.radians(sine * np.cos(own) - cosine * np.sin(own))
    return gravity, slope


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
