"""Friction and load torque of joints by regression: rows of the table ``torques`` from samples."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa

from frictioncli.errors import NotEnoughData
from frictioncli.pairs.other_joints import OTHER_MOVES
from frictioncli.regression.alignment import aligned_regressions
from frictioncli.regression.arm_bodies import arm_bodies
from frictioncli.regression.arm_dynamics import ArmModel
from frictioncli.regression.arm_motion import arm_motions
from frictioncli.regression.cells import torque_cells
from frictioncli.regression.determination import JointRegression, regress
from frictioncli.regression.motion_rows import MotionLog, motion_rows
from frictioncli.regression.preparation import PreparedJoint, prepare, with_wide_enough_filter
from frictioncli.regression.text import regression_facts, regression_text


@dataclass(frozen=True, slots=True, kw_only=True)
class RegressedTorques:
    """Torques of joints by regression.

    Attributes
    ----------
    table : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`, by joint, run, pair and angle.
    signs : dict of int to int
        Sign convention of each joint.
    facts : dict of int to dict
        What each regression found.
    texts : tuple of str
        Text per joint, also on those that were refused.
    samples : int
        Samples read, of all joints that were regressed.
    dropped : dict of str to int
        Samples in no row of the table, by reason.
    arm : dict or None
        What all joints together tell of the bodies of the arm, where its kinematics are given.
    """

    table: pd.DataFrame
    signs: dict[int, int]
    facts: dict[int, Mapping[str, Any]]
    texts: tuple[str, ...]
    samples: int
    dropped: dict[str, int]
    arm: Mapping[str, Any] | None = None


def torques_by_regression(
    read: Callable[[], Iterable[pa.RecordBatch]],
    *,
    bin_width: float = 5.0,
    sign: int | None = None,
    joints: Collection[int] | None = None,
    manifest: pd.DataFrame | None = None,
    units: tuple[str, str] = ("N·m", "N·m"),
    doubtful: bool = True,
    urdf: Path | None = None,
) -> RegressedTorques:
    r"""Return friction and load torque of any motion by regression of all samples.

    Parameters
    ----------
    read : callable
        Returns the batches of a table of samples from its start; called once or a few times.
    bin_width : float
        Width of the angle bins. [deg]
    sign : {+1, -1}, optional
        Sign convention of the logs; found per joint where not given.
    joints : collection of int, optional
        Joints to regress; all where not given.
    manifest : DataFrame, optional
        Phase and payload by run and recording.
    units : (str, str)
        Units of torque and of a measured load, for the texts.
    doubtful : bool
        Whether a joint is regressed that moves mostly while others move, or in one direction only;
        its friction then holds what the others add, or the offset of the torque.
    urdf : Path, optional
        Kinematics of the arm, for joints that move together; see
        :class:`~frictioncli.regression.arm_dynamics.ArmModel`.

    Returns
    -------
    RegressedTorques
        The torques, and what was found on the way.

    Raises
    ------
    NotEnoughData
        If no joint can be regressed, with the reason of each.
    OptionError
        If the URDF cannot be used.

    Notes
    -----
    With friction of equation (16) of [1]_ the regression is of

    .. math::

        u = J \ddot\varphi + a \cos\varphi + b \sin\varphi + c \pm
        \operatorname{sign}(\dot\varphi) \tau(\dot\varphi, L, T)

    by variable projection [2]_. Its inertia, and where the opposite direction is missing its
    gravity, are subtracted from the torque [3]_; what remains is friction as it was measured, and
    keeps what equation (16) does not explain.

    References
    ----------
    .. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of
       industrial robot joint with temperature correction by example of KUKA KR10," J. Robotics,
       2019, doi:10.1155/2019/6931563.
    .. [2] G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
       squares problems whose variables separate," SIAM J. Numer. Anal. 10(2), 1973,
       doi:10.1137/0710036.
    .. [3] J. Swevers, W. Verdonck, and J. De Schutter, "Dynamic model identification for industrial
       robots," IEEE Control Systems 27(5), 2007, doi:10.1109/MCS.2007.904659.

    Examples
    --------
    A joint that swings at 0.3 Hz, with 5 + 2 sqrt(v) N·m of friction and 3 kg·m² of inertia:

    >>> import numpy as np
    >>> import pyarrow as pa
    >>> time = np.arange(0, 120, 0.01)
    >>> phase = 2 * np.pi * 0.3 * time
    >>> velocity = 40 * 0.6 * np.pi * np.cos(phase)
    >>> friction = np.sign(velocity) * (5 + 2 * np.sqrt(np.abs(velocity)))
    >>> inertial = -3 * np.radians(40 * (0.6 * np.pi) ** 2 * np.sin(phase))
    >>> samples = pa.table({
    ...     "run": np.repeat("day", len(time)), "recording": np.repeat("log", len(time)),
    ...     "joint": np.ones(len(time), int), "time": time, "position": 40 * np.sin(phase),
    ...     "velocity": velocity, "torque": friction + inertial})
    >>> found = torques_by_regression(samples.to_batches)
    >>> row = found.table[found.table["speed"] > 60].iloc[0]
    >>> abs(row["friction_torque"] - 5 - 2 * np.sqrt(row["speed"])) < 0.1
    np.True_
    """
    arm = None if urdf is None else ArmModel(urdf)
    motions = with_wide_enough_filter(lambda width: motion_rows(read(), step_time=width))
    payload = None if manifest is None else manifest["payload"]
    phase = None if manifest is None else manifest["phase"]
    states = {} if arm is None else arm_motions(read, motions, range(1, arm.joints + 1))

    def regress_joint(joint: int, motion: MotionLog, *, late: bool) -> JointRegression:
        columns = None if arm is None else partial(arm.columns, joint)
        prepared = prepare(motion, payload, columns, states.get(joint))
        _refuse_doubtful(joint, prepared, doubtful=doubtful)
        return regress(prepared if late else prepared.without_delay(), joint, sign)

    wanted = {joint: motions[joint] for joint in motions if joints is None or joint in joints}
    standing = [str(joint) for joint, motion in wanted.items() if not motion.moves]
    moving = {joint: motion for joint, motion in wanted.items() if motion.moves}
    tables, texts, faults = [], [], []
    signs: dict[int, int] = {}
    facts: dict[int, Mapping[str, Any]] = {}
    dropped: dict[str, int] = {}
    samples = 0
    regressions: dict[int, JointRegression] = {}
    for joint, outcome in aligned_regressions(read, moving, regress_joint).items():
        if isinstance(outcome, NotEnoughData):
            faults.append(str(outcome))
            continue
        motion, found = outcome
        cells = torque_cells(found, motion, joint, bin_width, phase)
        if cells.table.empty:
            faults.append(f"joint {joint}: no speed and angle is passed often enough")
            continue
        samples += motion.samples
        regressions[joint] = found
        for reason, count in [*found.prepared.dropped.items(), *cells.dropped.items()]:
            dropped[reason] = dropped.get(reason, 0) + count
        tables.append(cells.table)
        signs[joint] = found.sign
        facts[joint] = regression_facts(found, cells, *units)
        texts.append(regression_text(joint, found, cells, *units))
    if not tables:
        if standing:
            faults.append(f"joint {', '.join(standing)}: at rest throughout")
        raise NotEnoughData("; ".join(faults) or "no samples")
    bodies = None if arm is None else arm_bodies(regressions, arm, units[0])
    if bodies is not None:
        texts += bodies.texts()
    return RegressedTorques(
        table=pd.concat(tables, ignore_index=True),
        signs=signs,
        facts=facts,
        texts=(*texts, *faults),
        samples=samples,
        dropped=dropped,
        arm=None if bodies is None else bodies.facts(),
    )


def _refuse_doubtful(joint: int, prepared: PreparedJoint, *, doubtful: bool) -> None:
    """Refuse a joint whose friction holds something else, unless that is allowed."""
    if prepared.other_share and not doubtful:
        raise NotEnoughData(
            f"joint {joint}: {OTHER_MOVES} in {100 * prepared.other_share:.0f} % of its motion,"
            " and the weight and inertia of the others act on it; log it alone, give --urdf, or try"
            " 'frictioncli separate --by regression', whose friction then includes what they add"
        )
    if len(prepared.equations.rows) and not prepared.terms.offset and not doubtful:
        raise NotEnoughData(
            f"joint {joint}: motion in one direction only, in which an offset of the torque counts"
            " as friction; log both directions, or try 'frictioncli separate --by regression'"
        )
