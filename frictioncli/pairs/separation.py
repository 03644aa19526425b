"""Separation of friction torque and load torque in each pair and angle bin."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.pairs.slices import slice_means


class SeparatedTorques(NamedTuple):
    """Friction and load torque of the same motion [N·m]."""

    friction: Array
    load: Array


def separate_torques(
    *, torque_forward: ArrayLike, torque_reverse: ArrayLike, sign: int = 1
) -> SeparatedTorques:
    r"""Split the torques of counter-directed motion into friction and load torque.

    A joint passes the same angle twice at the same constant speed, once in each direction. Gravity
    loads the motor equally both times, while friction changes its sign.

    Parameters
    ----------
    torque_forward, torque_reverse : array_like
        Control torque while the position increases, and while it decreases. [N·m]
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

    It holds at constant speed and for friction that is the same in both directions; the difference
    between the directions adds to the load.

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
class HalfDifferences:
    """Count, mean and scatter of the half differences of the torques of pairs.

    Attributes
    ----------
    count : int
        Number of values so far.
    mean : float
        Their mean. [N·m]
    squares : float
        Sum of the squared deviations from the mean. [(N·m)²]
    """

    count: int = 0
    mean: float = 0.0
    squares: float = 0.0

    def add(self, values: Array) -> None:
        """Add values [N·m]."""
        if not len(values):
            return
        mean = float(np.mean(values))
        total = self.count + len(values)
        difference = mean - self.mean
        self.squares += float(np.sum(np.square(values - mean)))
        self.squares += difference**2 * self.count * len(values) / total
        self.mean += difference * len(values) / total
        self.count = total

    @property
    def is_significant(self) -> bool:
        """Whether the mean differs from 0 by more than three standard deviations."""
        deviation = np.sqrt(self.squares / (self.count - 1)) if self.count > 1 else 0.0
        return bool(abs(self.mean) > 3 * deviation)


def half_differences(batches: Iterable[pa.RecordBatch]) -> dict[int, dict[str, HalfDifferences]]:
    """Return the half differences of the torques of pairs, by joint and run.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`; those of a pair stand together, and count as one
        value.

    Returns
    -------
    dict of int to dict of str to HalfDifferences
        Half differences by joint and run.
    """
    found: dict[int, dict[str, HalfDifferences]] = {}
    names = ["run", "joint", "pair", "torque_forward", "torque_reverse"]
    rest: pa.Table | None = None
    for batch in batches:
        rows = pa.Table.from_batches([batch.select(names)])
        if rest is not None:
            rows = pa.concat_tables([rest, rows]).unify_dictionaries()
        rest = _add_pairs(found, rows, ended=False)
    if rest is not None:
        _add_pairs(found, rest, ended=True)
    return found


def _add_pairs(
    found: dict[int, dict[str, HalfDifferences]], rows: pa.Table, *, ended: bool
) -> pa.Table:
    """Add whole pairs; return the rows of the last one, which may go on in the next batch."""
    run = rows["run"].combine_chunks()
    run = run if pa.types.is_dictionary(run.type) else run.dictionary_encode()
    code, joint, pair = run.indices.to_numpy(), rows["joint"].to_numpy(), rows["pair"].to_numpy()
    half = (rows["torque_forward"].to_numpy() - rows["torque_reverse"].to_numpy()) / 2
    new = (np.diff(code) != 0) | (np.diff(joint) != 0) | (np.diff(pair) != 0)
    start = np.append(0, np.flatnonzero(new) + 1)[: len(half)]
    stop = np.append(start[1:], len(half))[: len(start)]
    complete = slice(None if ended else -1)
    mean = slice_means(half, start, stop)[complete]
    first = start[complete]
    for number, one in sorted({*zip(joint[first].tolist(), code[first].tolist(), strict=True)}):
        of_joint = found.setdefault(number, {})
        values = of_joint.setdefault(run.dictionary[one].as_py(), HalfDifferences())
        values.add(mean[(joint[first] == number) & (code[first] == one)])
    return rows.slice(start[-1] if len(start) else 0)


def inferred_sign(joint: int, runs: Mapping[str, HalfDifferences]) -> int:
    """Return the sign convention of a joint's log: the one that makes mean friction positive.

    Parameters
    ----------
    joint : int
        Joint number.
    runs : mapping of str to HalfDifferences
        Its half differences by run, as :func:`half_differences` gives them.

    Returns
    -------
    {+1, -1}
        +1 for load plus friction while moving forward, -1 for load minus friction.

    Raises
    ------
    NotEnoughData
        If the signs of two runs are both significant and opposite.
    """
    means = {run: values.mean for run, values in runs.items() if values.is_significant}
    if means and min(means.values()) < 0 < max(means.values()):
        opposite = ", ".join(f"{run}: {mean:+.3g}" for run, mean in means.items())
        raise NotEnoughData(
            f"joint {joint}: runs contradict each other in the sign of friction"
            f" (mean half difference of the torques {opposite}); give them separate work folders,"
            " or force one with --sign"
        )
    return 1 if sum(values.mean * values.count for values in runs.values()) >= 0 else -1


def sign_conventions(batches: Iterable[pa.RecordBatch], sign: int | None = None) -> dict[int, int]:
    """Return the sign convention of each joint.

    Parameters
    ----------
    batches : iterable of RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`.
    sign : {+1, -1}, optional
        Sign convention; inferred per joint where not given: friction opposes motion, so its mean
        is positive.

    Returns
    -------
    dict of int to int
        Sign convention by joint.

    Raises
    ------
    OptionError
        If the given sign is neither +1 nor -1.
    NotEnoughData
        If the runs of a joint contradict each other in sign.
    """
    return signs_of(half_differences(batches), sign)


def signs_of(
    found: Mapping[int, Mapping[str, HalfDifferences]], sign: int | None = None
) -> dict[int, int]:
    """Return the same from half differences, as :func:`half_differences` gives them.

    Parameters
    ----------
    found : mapping of int to mapping of str to HalfDifferences
        Half differences by joint and run.
    sign : {+1, -1}, optional
        As of :func:`sign_conventions`, with its errors.
    """
    if sign not in (None, 1, -1):
        raise OptionError(f"sign {sign}: expected +1 or -1")
    return {joint: sign or inferred_sign(joint, found[joint]) for joint in sorted(found)}


def separate(pairs: pa.RecordBatch, signs: Mapping[int, int]) -> pa.RecordBatch:
    """Return pairs with their friction and load torque.

    Parameters
    ----------
    pairs : RecordBatch
        Rows of :data:`frictioncli.schemas.PAIRS`. Where there is a ``load``, it replaces the load
        from the separation.
    signs : mapping of int to int
        Sign convention of each joint.

    Returns
    -------
    RecordBatch
        The rows with ``friction_torque`` and ``load_torque``.
    """
    joint = pairs.column("joint").to_numpy()
    sign = np.select([joint == number for number in signs], list(signs.values()))
    torques = separate_torques(
        torque_forward=pairs.column("torque_forward").to_numpy(),
        torque_reverse=pairs.column("torque_reverse").to_numpy(),
    )
    load = torques.load
    if "load" in pairs.schema.names:
        measured = pc.cast(pairs.column("load"), pa.float64()).to_numpy(zero_copy_only=False)
        load = np.where(np.isnan(measured), torques.load, measured)
    return pairs.append_column("friction_torque", pa.array(sign * torques.friction)).append_column(
        "load_torque", pa.array(load)
    )


@dataclass(slots=True)
class TorqueRanges:
    """Ranges of friction and load torque by joint."""

    friction: dict[int, tuple[float, float]] = field(default_factory=dict)
    load: dict[int, tuple[float, float]] = field(default_factory=dict)
    load_is_measured: bool = False

    def update(self, batches: Iterable[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """Yield rows of :data:`frictioncli.schemas.TORQUES` unchanged, and widen the ranges."""
        for rows in batches:
            joints = rows.column("joint").to_numpy()
            for joint in np.unique(joints).tolist():
                for ranges, name in ((self.friction, "friction"), (self.load, "load")):
                    torque = rows.column(f"{name}_torque").to_numpy()[joints == joint]
                    low, high = ranges.get(joint, (np.inf, -np.inf))
                    ranges[joint] = min(low, float(torque.min())), max(high, float(torque.max()))
            if "load" in rows.schema.names:
                self.load_is_measured |= rows.column("load").null_count < rows.num_rows
            yield rows


def separation_text(
    ranges: TorqueRanges, signs: Mapping[int, int], facts: Mapping[str, Any], *, given: bool
) -> str:
    """Return the text on the sign convention and the ranges of both torques, per joint.

    Parameters
    ----------
    ranges : TorqueRanges
        Ranges of the torques.
    signs : mapping of int to int
        Sign convention of each joint.
    facts : mapping
        ``torque_unit`` and ``load_unit``.
    given : bool
        Whether the user gave the sign.
    """
    unit = facts.get("torque_unit", "N·m")
    lines = []
    for joint, sign in signs.items():
        convention = "load + friction" if sign > 0 else "load - friction"
        friction, load = (
            f"{low:.3g} to {high:.3g}" for low, high in (ranges.friction[joint], ranges.load[joint])
        )
        lines.append(
            f"joint {joint}: forward torque is {convention} (sign {sign:+d},"
            f" {'as given' if given else 'inferred'}), friction {friction}"
            f" {unit}, load {load} {facts.get('load_unit', unit)}"
        )
    return "\n".join(lines)
