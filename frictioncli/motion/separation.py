"""Stage ``separate``: friction torque and load torque of each pair and angle bin."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from frictioncli.errors import NotEnoughData, OptionError


class SeparatedTorques(NamedTuple):
    """Friction and load torque of the same motion, in N·m."""

    friction: NDArray[np.float64]
    load: NDArray[np.float64]


def separate_torques(
    *, torque_forward: ArrayLike, torque_reverse: ArrayLike, sign: int = 1
) -> SeparatedTorques:
    r"""Split the torques of counter-directed motion into friction and load torque.

    A joint passes the same angle twice at the same constant speed, once in each direction. Gravity
    loads the motor equally both times; friction changes its sign.

    Parameters
    ----------
    torque_forward, torque_reverse : array_like
        Control torque while the position grows, and while it falls. [N·m]
    sign : {+1, -1}
        +1 where the log holds load plus friction while moving forward; -1 for the convention of the
        source paper, load minus friction.

    Returns
    -------
    SeparatedTorques
        Friction, positive where it opposes the motion, and load. [N·m]

    Raises
    ------
    ValueError
        If the two inputs differ in shape.

    Notes
    -----
    Equation (8) of [1]_ (there ``sign`` is -1):

    .. math:: \tau = \pm \frac{u_+ - u_-}{2}, \qquad l_g = \frac{u_+ + u_-}{2}

    It holds at constant speed and where friction is the same in both directions; a part that is not
    ends up in the load.

    References
    ----------
    .. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of
       industrial robot joint with temperature correction by example of KUKA KR10," J. Robotics,
       2019, doi:10.1155/2019/6931563.

    Examples
    --------
    A joint that needs 30 N·m to rise and -10 N·m to descend:

    >>> separate_torques(torque_forward=[30.0], torque_reverse=[-10.0])
    SeparatedTorques(friction=array([20.]), load=array([10.]))
    """
    forward = np.asarray(torque_forward, dtype=float)
    reverse = np.asarray(torque_reverse, dtype=float)
    if forward.shape != reverse.shape:
        raise ValueError(f"torques differ in shape: {forward.shape} and {reverse.shape}")
    return SeparatedTorques(friction=sign * (forward - reverse) / 2, load=(forward + reverse) / 2)


def separate(pairs: pd.DataFrame, sign: int | None = None) -> tuple[pd.DataFrame, dict[int, int]]:
    """Return the torques of all pairs, and the sign convention of each joint.

    Parameters
    ----------
    pairs : DataFrame
        Rows of :data:`frictioncli.schemas.PAIRS`. A ``load`` channel takes the place of the load
        that the separation gives.
    sign : {+1, -1}, optional
        Sign convention; inferred per joint where not given: friction opposes motion, so its mean
        is positive.

    Raises
    ------
    NotEnoughData
        If the runs of a joint contradict each other in sign.
    """
    if sign not in (None, 1, -1):
        raise OptionError(f"sign {sign}: expected +1 or -1")
    signs = {int(joint): sign or inferred_sign(group) for joint, group in pairs.groupby("joint")}
    torques = separate_torques(
        torque_forward=pairs["torque_forward"], torque_reverse=pairs["torque_reverse"]
    )
    load = pairs["load"].where(pairs["load"].notna(), torques.load)
    separated = pairs.assign(
        friction_torque=pairs["joint"].map(signs) * torques.friction, load_torque=load
    )
    return separated, signs


def inferred_sign(pairs: pd.DataFrame) -> int:
    """Return the sign convention of one joint's log: that which makes mean friction positive.

    Raises
    ------
    NotEnoughData
        If one run clearly says +1 and another clearly says -1.
    """
    half = (pairs["torque_forward"] - pairs["torque_reverse"]) / 2
    by_pair = half.groupby([pairs["run"], pairs["pair"]], observed=True).mean()
    by_run = by_pair.groupby(level=0, observed=True).agg(["mean", "std", "count"])
    clear = by_run[by_run["mean"].abs() > 3 * by_run["std"].fillna(0.0)]
    if clear["mean"].gt(0).any() and clear["mean"].lt(0).any():
        opposite = ", ".join(f"{run}: {mean:+.3g}" for run, mean in clear["mean"].items())
        raise NotEnoughData(
            f"joint {pairs['joint'].iloc[0]}: runs contradict each other in the sign of friction"
            f" (mean half difference of the torques {opposite}); give them separate work folders,"
            " or force one with --sign"
        )
    return 1 if by_pair.mean() >= 0 else -1
