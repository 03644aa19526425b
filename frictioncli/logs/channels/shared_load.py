"""What a motor current and a torque share: rows in motion, columns of the load and of the rest."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array, Numbers

GRAVITY, INERTIA = "gravity", "inertia"

LEAST_ROWS = 60
"""Least rows in motion."""
_SLOWEST = 0.05
"""Rows slower than this share of the highest speed are left out: friction at rest is any."""
_JUMP = 4.0
"""Rows faster than so many times the 98 % quantile of speed are jumps of the position."""
_DELAYS = np.linspace(-0.1, 0.1, 41)
"""Delays of the torque against the current that are tried. [s]"""
_TOLERANCE = 1e-10


@dataclass(frozen=True, slots=True)
class ChannelPair:
    """Samples of a motor current and a torque of one joint in one recording, in order of time.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Time. [s]
    position : ndarray, shape (n,)
        Angle. [deg]
    current : ndarray, shape (n,)
        Motor current. [A]
    torque : ndarray, shape (n,)
        Torque, of which any share of the friction is a part. [N·m]
    """

    time: Array
    position: Array
    current: Array
    torque: Array


def delay_of_torque(recordings: Sequence[ChannelPair]) -> float:
    """Return by how much the torque lags behind the current, to the nearest 5 ms [s].

    It is the delay at which current and motion together leave least of the torque; 0 where samples
    are too rare to tell.

    Parameters
    ----------
    recordings : sequence of ChannelPair
        The recordings of a joint; the longest is looked at.
    """
    longest = max(recordings, key=lambda one: len(one.time), default=None)
    if longest is None or len(longest.time) < LEAST_ROWS:
        return 0.0
    if float(np.nanmedian(np.diff(longest.time))) > _DELAYS[-1] / 2:
        return 0.0
    left = []
    for delay in _DELAYS.tolist():
        rows = rows_in_motion(longest, delay)
        if rows is None:
            return 0.0
        instruments, own, _ = _columns(rows, GRAVITY)
        columns = np.column_stack([instruments, own, rows[:, 4]])
        misfit = rows[:, 5] - columns @ np.linalg.lstsq(columns, rows[:, 5], rcond=None)[0]
        left.append(float(np.mean(np.square(misfit))))
    best = int(np.argmin(left))
    return float(_DELAYS[best]) if 0 < best < len(left) - 1 else 0.0


def rows_in_motion(one: ChannelPair, delay: float) -> Array | None:
    """Return the rows of a recording in which the joint moves, None where there are none.

    Parameters
    ----------
    one : ChannelPair
        The recording.
    delay : float
        By how much the torque lags behind the current, which is undone. [s]

    Returns
    -------
    ndarray, shape (rows, 6), or None
        Angle, velocity, acceleration, jerk, current and torque. [rad], [deg/s], [deg/s²],
        [deg/s³], [A], [N·m]
    """
    rows = np.stack([one.time, one.position, one.current, one.torque])
    rows = rows[:, np.isfinite(rows).all(axis=0)]
    rows = rows[:, np.concatenate(([True], np.diff(rows[0]) > 0))]
    if delay and rows.shape[1]:
        rows[3] = np.interp(rows[0] + delay, rows[0], rows[3])
    # over several samples where there are many, which divides the noise of position
    width = max(rows.shape[1] // 4000, 1)
    if rows.shape[1] < 4 * width + 8:
        return None
    time, angle = rows[0], np.unwrap(rows[1], period=360.0)
    velocity = _slope(angle, time, width)
    acceleration = _slope(velocity, time, width)
    jerk = _slope(acceleration, time, width)
    speed = np.abs(velocity)
    fast = float(np.nanquantile(speed, 0.98))
    if fast <= 0:
        return None
    used = np.isfinite(jerk) & (speed > _SLOWEST * fast) & (speed < _JUMP * fast)
    smooth = [_mean(values, width) for values in rows[2:]]
    columns = [np.radians(angle), velocity, acceleration, jerk, *smooth]
    found = np.stack([column[used] for column in columns], axis=1)
    return found if len(found) else None


def _slope(values: Array, time: Array, width: int) -> Array:
    """Return central differences over ``width`` samples to either side, NaN at the ends."""
    slope = np.full(len(values), np.nan)
    change, elapsed = values[2 * width :] - values[: -2 * width], time[2 * width :]
    slope[width:-width] = change / (elapsed - time[: -2 * width])
    return slope


def _mean(values: Array, width: int) -> Array:
    """Return means over ``width`` samples to either side, NaN at the ends."""
    found = np.full(len(values), np.nan)
    if width == 1:
        return values
    window = np.ones(2 * width + 1) / (2 * width + 1)
    found[width:-width] = np.convolve(values, window, "valid")
    return found


def _blocks(lengths: Sequence[int], most: int) -> Numbers:
    """Return the number of the block of time of each row; none spans two recordings."""
    numbers: list[Numbers] = []
    first = 0
    for length in lengths:
        count = max(round(length / most), 1)
        numbers.append(first + np.arange(length) * count // length)
        first += count
    return np.concatenate(numbers)


def _columns(rows: Array, seen_by: str) -> tuple[Array, Array, Array]:
    """Return the instruments, and what only one channel has without and with a delay's effect."""
    angle, velocity, acceleration, jerk = rows.T[:4]
    waves = np.stack([f(n * angle) for n in (1, 2) for f in (np.cos, np.sin)], axis=1)
    sign = np.sign(velocity)
    odd = [np.ones_like(sign), np.sqrt(np.abs(velocity)), np.abs(velocity)]
    own = [np.ones_like(sign), *(sign * one for one in odd), *(sign[:, np.newaxis] * waves).T]
    own += [acceleration] if seen_by == GRAVITY else [*waves.T]
    instruments = waves if seen_by == GRAVITY else acceleration[:, np.newaxis]
    delayed = [jerk, *(velocity[:, np.newaxis] * waves[:, :2]).T]
    return instruments, np.stack(own, axis=1), np.stack(delayed, axis=1)


@dataclass(frozen=True, slots=True)
class SharedRun:
    """Columns of a run, and the blocks of time of its rows.

    Attributes
    ----------
    table : ndarray, shape (rows, columns)
        Instruments, what only one channel has, current and torque.
    instruments : int
        Number of the first of these.
    block : ndarray of int, shape (rows,)
        Block of time of each row.
    angle : ndarray, shape (rows,)
        Angle. [rad]
    """

    table: Array
    instruments: int
    block: Numbers
    angle: Array

    def shared(self, gram: Array) -> tuple[Array, Array]:
        """Return inner products of what the instruments alone explain of both channels, and rest.

        Parameters
        ----------
        gram : ndarray, shape (columns, columns)
            Inner products of the columns.

        Returns
        -------
        explained, left : ndarray, shape (2, 2)
            Of current and torque.
        """
        own = slice(self.instruments, -2)
        channels = gram[:-2, -2:]
        inverse = np.linalg.pinv(gram[:-2, :-2], _TOLERANCE, hermitian=True)
        explained = channels.T @ inverse @ channels
        left = gram[-2:, -2:] - explained
        inverse = np.linalg.pinv(gram[own, own], _TOLERANCE, hermitian=True)
        return explained - gram[own, -2:].T @ inverse @ gram[own, -2:], left


def shared_run(parts: Sequence[Array], seen_by: str, most: int) -> SharedRun:
    """Return the columns of a run.

    Parameters
    ----------
    parts : sequence of ndarray, shape (rows, 6)
        Rows of its recordings, see :func:`rows_in_motion`.
    seen_by : str
        ``gravity`` or ``inertia``: what is taken as instrument.
    most : int
        Rows of a block of time.
    """
    rows = np.concatenate(parts)
    instruments, *own = _columns(rows, seen_by)
    regressors = np.hstack([instruments, *own])
    size = np.linalg.norm(regressors, axis=0)
    regressors /= np.where(size > 0, size, 1.0)
    both = rows[:, 4:] - rows[:, 4:].mean(axis=0)
    block = _blocks([len(part) for part in parts], most)
    return SharedRun(np.hstack([regressors, both]), instruments.shape[1], block, rows[:, 0])
