r"""Angle bins in which the logged torque has not settled yet.

Where the torque in a log is late by a mean time *D* with variance *S*, that of the first bins of a
segment still remembers the start of the move: friction that was lower and inertia. After

.. math:: t_s = D + 2 \sqrt{S}

5 % of it is left behind a filter of first order. The bins before that time, in either direction,
would look like inertia or like friction after a reversal. A segment begins some time after the
acceleration: twice :math:`t_s` after it 0.25 % are left. Half of that time is counted on where the
segment is long enough for all of it, since an acceleration may end later than the speed shows; and
all of it where a pair would lose most of its bins. So a delay that is short against it costs slow
moves no bins, of which the outermost tell how friction builds up after a reversal.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Flags
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.ramps.evidence import RampLog
from frictioncli.diagnosis.ramps.timing import TorqueTiming, torque_timing
from frictioncli.model.zero_load import PAIR_KEY
from frictioncli.pairs.settings import SteadySettings

_TIME_CONSTANTS = 2.0
"""Square roots of the variance that are waited for beside the mean time."""

_DROPPED = SteadySettings().settling
"""Usual time between the acceleration and the start of a segment. [s]"""

_PART_DROPPED = 1 / 3
"""That time in a short segment, relative to the time of its bins."""

_COUNTED = 0.5
"""Part of the time between acceleration and segment that is counted on in long segments."""

_HALF = 0.5
"""Share of the bins of a pair of which more must be settled by themselves."""

_SETTLED = 1e-9
"""Share of the settling time within which a bin counts as settled."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Settling:
    """Bins that were left out because the torque had not settled.

    Attributes
    ----------
    seconds : float
        Settling time after the first bin of a segment. [s]
    bins, pairs : int
        Bins that were left out, and pairs that have lost all theirs.
    """

    seconds: float
    bins: int
    pairs: int


def settling_time(*, shift: float, smear: float) -> float:
    """Return the time after which the logged torque is that of the motion [s].

    Parameters
    ----------
    shift : float
        Mean time by which the torque is late. [s]
    smear : float
        Variance of that time. [s²]

    Examples
    --------
    >>> round(settling_time(shift=0.05, smear=0.04**2), 3)
    0.13
    """
    return max(shift, 0.0) + _TIME_CONSTANTS * math.sqrt(max(smear, 0.0))


def settled(torques: pd.DataFrame, seconds: float) -> Flags:
    """Return which bins were passed when the torque had settled, in both directions.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    seconds : float
        Settling time. [s]

    Returns
    -------
    ndarray of bool, shape (rows,)
    """
    position = torques["position"].to_numpy(float)
    pairs = torques.groupby(PAIR_KEY, sort=False, observed=True)["position"]
    low, high = (pairs.transform(end).to_numpy(float) for end in ("min", "max"))
    speed = torques["speed"].to_numpy(float)
    passed = np.minimum(position - low, high - position) / speed
    before = np.minimum(_DROPPED, _PART_DROPPED * (high - low) / speed)
    counted = np.where(before < _DROPPED, 0.0, _COUNTED * _DROPPED)
    found = (passed >= (1 - _SETTLED) * seconds) | (counted + passed >= 2.0 * seconds)
    share = pd.Series(found, torques.index).groupby(
        [torques[name] for name in PAIR_KEY], sort=False, observed=True
    )
    few = share.transform("mean").to_numpy(float) <= _HALF
    return np.asarray(found | (few & (before + passed >= 2.0 * seconds)))


@dataclass(frozen=True, slots=True, kw_only=True)
class SettledProblems:
    """Problems of one joint without bins in which the torque had not settled.

    Attributes
    ----------
    problem : Problem
        All runs but the one held out.
    new : Problem or None
        The run held out.
    timing : TorqueTiming or None
        Delay and filter of the torque, where the log has starts of moves.
    settling : Settling or None
        What was left out; none where nothing was.
    """

    problem: Problem
    new: Problem | None
    timing: TorqueTiming | None
    settling: Settling | None


def settled_problems(
    torques: pd.DataFrame,
    temperature: str,
    held_out: str | None,
    ramps: RampLog | None,
    least_pairs: int,
) -> SettledProblems:
    """Return the problems of one joint, without bins in which the torque had not settled.

    All bins stay where nothing says that the torque is late, or where too few pairs would be left.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    held_out : str or None
        Name of the run that is held out.
    ramps : RampLog or None
        Measurements outside the constant-velocity segments.
    least_pairs : int
        Least number of pairs to learn from.
    """
    problem, new = build_problems(torques, temperature, held_out)
    timing = torque_timing(ramps, problem, temperature) if ramps else None
    everything = SettledProblems(problem=problem, new=new, timing=timing, settling=None)
    if timing is None or timing.shift.low <= 0:
        return everything
    seconds = settling_time(shift=timing.shift.value, smear=timing.smear.value)
    kept = settled(torques, seconds)
    seen = (torques["run"] != held_out).to_numpy()
    number = torques.groupby(PAIR_KEY, sort=False, observed=True).ngroup().to_numpy()
    if kept.all() or len(np.unique(number[kept & seen])) < least_pairs:
        return everything
    problem, new = build_problems(torques[kept], temperature, held_out)
    lost = len(np.unique(number)) - len(np.unique(number[kept]))
    settling = Settling(seconds=seconds, bins=int(np.sum(~kept)), pairs=lost)
    return SettledProblems(problem=problem, new=new, timing=timing, settling=settling)
