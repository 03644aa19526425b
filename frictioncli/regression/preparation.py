"""Rows that may enter the regression of a joint, and those that may not, counted by reason."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.pairs.other_joints import OTHER_MOVES
from frictioncli.pairs.settings import SteadySettings
from frictioncli.regression.arm_dynamics import ArmColumns
from frictioncli.regression.equation import EquationTerms, JointEquations
from frictioncli.regression.filters import STEP_TIMES, matched_filters
from frictioncli.regression.motion_rows import MotionLog, MotionRows
from frictioncli.regression.speed_law import SpeedLaw

SLOW = "slower than friction's law holds"
AFTER_REVERSAL = "just after a start or reversal"
NO_TEMPERATURE = "no motor temperature"
NO_LOAD = "no measured load"
UNKNOWN_ARM = "angle of another joint unknown"
RARE_STATE = "little motion with that payload and pose of the other joints"

_SLOWEST_SHARE = 0.01
"""Rows slower than this share of the highest speed are left out: the joint may stick."""

_PRESLIDING = 0.5
"""Way after a reversal within which friction builds up. [deg]"""

_MOST_WITH_OTHERS = 0.5
"""Share of rows during motion of other joints above which they are kept, as by pairing."""

_CONSISTENT = 0.02
"""Share by which logged velocity and slope of the position may differ."""

_NOISY = 2e-4
"""Share of noise in the variance of the acceleration above which a wider filter is taken."""

_LEAST_ROWS_OF_STATE = 60
"""Rows with a payload and pose from which inertia and gravity are told, about 3 s."""

_MOST_RARE = 0.5
"""Share of rows in rare states above which poses are not told apart."""

_KNOWN = 0.9
"""A load channel with values in this share of rows is used."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedJoint:
    """Equations of a joint, and what was left out and noticed on the way.

    Attributes
    ----------
    equations : JointEquations
        The rows that remain.
    terms : EquationTerms
        The terms that the log can have at all.
    dropped : dict of str to int
        Samples that are in no row, by reason.
    notes : tuple of str
        What a user should know.
    other_share : float
        Share of the rows during motion of other joints, where they were kept; else 0.
    payloads : tuple of float
        Payloads that are bodies of the whole arm, the lightest first; empty if not all are known,
        or without its kinematics. [kg]
    """

    equations: JointEquations
    terms: EquationTerms
    dropped: dict[str, int]
    notes: tuple[str, ...] = ()
    other_share: float = 0.0
    payloads: tuple[float, ...] = ()

    def without_delay(self) -> "PreparedJoint":
        """Return the same rows for an equation without a delay."""
        return replace(self, terms=replace(self.terms, delay=False))


def prepare(
    motion: MotionLog,
    payload: pd.Series | None = None,
    arm: Callable[[Array, Numbers | None], ArmColumns] | None = None,
    state: Array | None = None,
) -> PreparedJoint:
    """Choose the rows and the source of the acceleration.

    Parameters
    ----------
    motion : MotionLog
        Rows of the joint.
    payload : Series, optional
        Payload by run and recording, missing where unknown. [kg]
    arm : callable, optional
        Makes the columns of the whole arm's dynamics from the motion of all joints, and the number
        of the payload of each row where all are known.
    state : ndarray, shape (rows, joints, 3), optional
        That motion. [deg], [deg/s], [deg/s²]

    Returns
    -------
    PreparedJoint
        Equations for the regression; there may be none left.
    """
    rows = motion.rows()
    dropped, notes = dict(motion.dropped), []
    from_position, consistent = _source(motion, rows)
    if not consistent:
        notes.append(
            "position and velocity of the log contradict each other: speed and acceleration are"
            " taken from the velocity, and gravity is not to be trusted"
        )
    carried = np.full(len(motion.recordings), np.nan)
    if payload is not None:
        keys = pd.MultiIndex.from_tuples(motion.recordings, names=["run", "recording"])
        carried = payload.reindex(keys).to_numpy(float)

    def leave_out(reason: str, unfit: Flags) -> None:
        nonlocal rows, state
        if unfit.any():
            state = None if state is None else state[~unfit]
            dropped[reason] = dropped.get(reason, 0) + int(rows.samples[unfit].sum())
            rows = rows.where(~unfit)

    shared = np.nan_to_num(rows.other_speed) > 0
    share = float(shared.mean()) if len(rows) else 0.0
    if state is not None:
        leave_out(UNKNOWN_ARM, np.isnan(state.sum(axis=(1, 2))))
        share = 0.0
    elif 0 < share <= _MOST_WITH_OTHERS:
        leave_out(OTHER_MOVES, shared)
        share = 0.0
    elif share:
        notes.append(
            f"other joints move in {share:.0%} of the motion; friction includes what they add"
        )
    speed = np.abs(_velocity(rows, from_position))
    fastest = float(np.quantile(speed, 0.99)) if len(rows) else 0.0
    slowest = max(SteadySettings().min_speed, _SLOWEST_SHARE * fastest)
    leave_out(SLOW, speed < slowest)
    if rows.position.any():  # else the log has no angles
        leave_out(AFTER_REVERSAL, rows.travel < _PRESLIDING)
    known = np.isfinite(rows.motor_temperature)
    if known.any():
        leave_out(NO_TEMPERATURE, ~known)
    measured = np.isfinite(rows.load)
    has_load = bool(len(rows)) and float(measured.mean()) >= _KNOWN
    if has_load:
        leave_out(NO_LOAD, ~measured)

    def states() -> Array:
        of_recording = carried[rows.recording.astype(np.int64)]
        payload = np.where(np.isnan(rows.payload), of_recording, rows.payload)
        # while others move no pose is known
        return np.stack([payload, rows.pose if told_apart else np.full(len(rows), np.nan)], axis=1)

    told_apart = not share
    rare = _rare(states())
    if rare.sum() > _MOST_RARE * len(rows):
        told_apart = False
        notes.append(
            "the other joints stand elsewhere in nearly every move: gravity is that of all"
            " poses together, and friction may include what they change"
        )
        rare = _rare(states())
    if rare.any() and not rare.all():
        leave_out(RARE_STATE, rare)
    payloads, poses, number = _state_numbers(states())
    equations = JointEquations(
        rows=rows,
        speed_from_position=from_position,
        temperature=np.nan_to_num(rows.motor_temperature),
        state=number,
        known_delay=motion.known_delay,
    )
    terms = EquationTerms(
        offset=len(np.unique(equations.direction)) > 1,
        gravity=bool(len(rows)) and float(np.ptp(rows.position)) > 1.0,
        load_channel=has_load,
        speed_law=SpeedLaw.of(np.abs(equations.velocity)),
        payloads=payloads,
        poses=poses,
    )
    if not known.any():
        terms = terms.without("gamma")
    bodies: tuple[float, ...] = ()
    if arm is not None and state is not None and len(rows):
        masses, of_row = np.unique(states()[:, 0], return_inverse=True)
        if np.isfinite(masses).all():
            bodies = tuple(masses.tolist())
        elif len(masses) > 1:
            notes.append(
                "payloads are not told apart in the dynamics of the whole arm, as not all are known"
            )
        columns = arm(state, of_row if bodies else None)
        equations = replace(equations, arm=columns, state=np.zeros_like(number))
        terms = replace(
            terms,
            base_parameters=columns.torque.shape[1],
            gravity=False,
            delay=False,
            payloads=(float("nan"),),
            poses=(float("nan"),),
        )
    return PreparedJoint(
        equations=equations,
        terms=terms,
        dropped=dropped,
        notes=tuple(notes),
        other_share=share,
        payloads=bodies,
    )


def with_wide_enough_filter(
    read: Callable[[float], dict[int, MotionLog]],
) -> dict[int, MotionLog]:
    """Return the rows of each joint with the narrowest filter whose acceleration has little noise.

    Noise of the acceleration would make the inertia too small, and leave inertial torque to the
    friction.

    Parameters
    ----------
    read : callable
        Reads the log and makes rows with filters of a given width [s].

    Returns
    -------
    dict of int to MotionLog
        Motion by joint.
    """
    found: dict[int, MotionLog] = {}
    for step_time in STEP_TIMES:
        for joint, motion in read(step_time).items():
            if joint not in found or noise_share(found[joint]) > _NOISY:
                found[joint] = motion
        if all(noise_share(motion) <= _NOISY for motion in found.values()):
            break
    return found


def noise_share(motion: MotionLog) -> float:
    """Return the share of noise in the variance of the acceleration of a joint.

    Parameters
    ----------
    motion : MotionLog
        Its rows.
    """
    rows = motion.rows()
    from_position, _ = _source(motion, rows)
    return _noise_shares(motion, rows)[0 if from_position else 1]


def _noise_shares(motion: MotionLog, rows: MotionRows) -> tuple[float, float]:
    """Return the share of noise in accelerations from positions and from velocities."""
    if len(rows) < 2:
        return 0.0, 0.0
    of_position, of_velocity = (
        noise**2 / max(float(np.var(acceleration)), 1e-300)
        for noise, acceleration in zip(
            _acceleration_noise(motion), (rows.acceleration, rows.velocity_slope), strict=True
        )
    )
    return of_position, of_velocity


def _acceleration_noise(motion: MotionLog) -> tuple[float, float]:
    """Return the noise of the acceleration from positions and from velocities [deg/s²]."""
    filters = matched_filters(max(motion.step, 1), motion.period or 1.0)
    position, velocity = motion.noise
    return (
        position * float(np.linalg.norm(filters.curvature)),
        velocity * float(np.linalg.norm(filters.slope)),
    )


def _source(motion: MotionLog, rows: MotionRows) -> tuple[bool, bool]:
    """Return whether acceleration is that of positions, and whether both channels agree."""
    square = float(rows.position_slope @ rows.position_slope)
    if square <= 0:
        return False, True
    ratio = float(rows.velocity @ rows.position_slope) / square
    if abs(ratio - 1) > _CONSISTENT:
        return False, False
    # a velocity that is itself smoothed or late is second choice
    of_position, of_velocity = _noise_shares(motion, rows)
    return of_position <= max(of_velocity, _NOISY), True


def _velocity(rows: MotionRows, from_position: bool) -> Array:
    return rows.position_slope if from_position else rows.velocity


def _rare(states: Array) -> Flags:
    """Return which rows have a payload and pose that few rows have."""
    if not len(states):
        return np.zeros(0, bool)
    _, number, count = np.unique(
        np.nan_to_num(states, nan=-1.0), axis=0, return_inverse=True, return_counts=True
    )
    return np.asarray(count[number.reshape(-1)] < _LEAST_ROWS_OF_STATE)


def _state_numbers(
    states: Array,
) -> tuple[tuple[float, ...], tuple[float, ...], Numbers]:
    """Return the payloads and poses that occur together, unknown last, and that of each row."""
    if not len(states):
        return (float("nan"),), (float("nan"),), np.zeros(0, np.int64)
    found, number = np.unique(np.nan_to_num(states, nan=np.inf), axis=0, return_inverse=True)
    found[np.isinf(found)] = np.nan
    payloads, poses = found.T.tolist()
    return tuple(payloads), tuple(poses), number.reshape(-1).astype(np.int64)
