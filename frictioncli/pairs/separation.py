"""Stage ``separate``: friction torque and load torque of each pair and angle bin."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.pairs.array_runs import means


class SeparatedTorques(NamedTuple):
    """Friction and load torque of the same motion, in N·m."""

    friction: Array
    load: Array


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


@dataclass(slots=True)
class SignTally:
    """Number, mean and scatter of values that go by.

    Attributes
    ----------
    count : int
        Values so far.
    mean : float
        Their mean.
    squares : float
        Sum of the squares of their deviations from it.
    """

    count: int = 0
    mean: float = 0.0
    squares: float = 0.0

    def add(self, values: Array) -> None:
        """Take in more values."""
        if not len(values):
            return
        own = float(np.mean(values))
        together = self.count + len(values)
        apart = own - self.mean
        self.squares += float(np.sum(np.square(values - own)))
        self.squares += apart**2 * self.count * len(values) / together
        self.mean += apart * len(values) / together
        self.count = together

    @property
    def clear(self) -> bool:
        """Whether the mean stands out of the scatter."""
        deviation = np.sqrt(self.squares / (self.count - 1)) if self.count > 1 else 0.0
        return bool(abs(self.mean) > 3 * deviation)


def half_differences(batches: Iterable[pa.RecordBatch]) -> dict[int, dict[str, SignTally]]:
    """Return what the half differences of the torques are like, by joint and run.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`; those of a pair stand together, and count as one.
    """
    found: dict[int, dict[str, SignTally]] = {}
    names = ["run", "joint", "pair", "torque_forward", "torque_reverse"]
    waiting: pa.Table | None = None
    for batch in batches:
        rows = pa.Table.from_batches([batch.select(names)])
        if waiting is not None:
            rows = pa.concat_tables([waiting, rows]).unify_dictionaries()
        waiting = _tally(found, rows, ended=False)
    if waiting is not None:
        _tally(found, waiting, ended=True)
    return found


def _tally(found: dict[int, dict[str, SignTally]], rows: pa.Table, *, ended: bool) -> pa.Table:
    """Take in whole pairs; return the rows of the last one, which may go on."""
    run = rows["run"].combine_chunks()
    run = run if pa.types.is_dictionary(run.type) else run.dictionary_encode()
    code, joint, pair = run.indices.to_numpy(), rows["joint"].to_numpy(), rows["pair"].to_numpy()
    half = (rows["torque_forward"].to_numpy() - rows["torque_reverse"].to_numpy()) / 2
    new = (np.diff(code) != 0) | (np.diff(joint) != 0) | (np.diff(pair) != 0)
    start = np.append(0, np.flatnonzero(new) + 1)[: len(half)]
    stop = np.append(start[1:], len(half))[: len(start)]
    whole = slice(None if ended else -1)
    mean = means(half, start, stop)[whole]
    head = start[whole]
    for number, one in sorted({*zip(joint[head].tolist(), code[head].tolist(), strict=True)}):
        tally = found.setdefault(number, {}).setdefault(run.dictionary[one].as_py(), SignTally())
        tally.add(mean[(joint[head] == number) & (code[head] == one)])
    return rows.slice(start[-1] if len(start) else 0)


def inferred_sign(joint: int, runs: Mapping[str, SignTally]) -> int:
    """Return the sign convention of one joint's log: that which makes mean friction positive.

    Parameters
    ----------
    joint : int
        Joint number.
    runs : mapping of str to SignTally
        Its half differences by run, as :func:`half_differences` gives them.

    Raises
    ------
    NotEnoughData
        If one run clearly says +1 and another clearly says -1.
    """
    clear = {run: tally.mean for run, tally in runs.items() if tally.clear}
    if clear and min(clear.values()) < 0 < max(clear.values()):
        opposite = ", ".join(f"{run}: {mean:+.3g}" for run, mean in clear.items())
        raise NotEnoughData(
            f"joint {joint}: runs contradict each other in the sign of friction"
            f" (mean half difference of the torques {opposite}); give them separate work folders,"
            " or force one with --sign"
        )
    return 1 if sum(tally.mean * tally.count for tally in runs.values()) >= 0 else -1


def sign_conventions(batches: Iterable[pa.RecordBatch], sign: int | None = None) -> dict[int, int]:
    """Return the sign convention of each joint.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`.
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
    found = half_differences(batches)
    return {joint: sign or inferred_sign(joint, found[joint]) for joint in sorted(found)}


def separate(pairs: pa.RecordBatch, signs: Mapping[int, int]) -> pa.RecordBatch:
    """Return pairs with their friction and load torque.

    Parameters
    ----------
    pairs : RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`. A ``load`` channel takes the place of the load
        that the separation gives.
    signs : mapping of int to int
        Sign convention of each joint.
    """
    joint = pairs.column("joint").to_numpy()
    sign = np.select([joint == number for number in signs], list(signs.values()))
    torques = separate_torques(
        torque_forward=pairs.column("torque_forward").to_numpy(),
        torque_reverse=pairs.column("torque_reverse").to_numpy(),
    )
    load = torques.load
    if "load" in pairs.schema.names:
        own = pc.cast(pairs.column("load"), pa.float64()).to_numpy(zero_copy_only=False)
        load = np.where(np.isnan(own), torques.load, own)
    return pairs.append_column("friction_torque", pa.array(sign * torques.friction)).append_column(
        "load_torque", pa.array(load)
    )
