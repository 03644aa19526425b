r"""Evidence of the ramps of moves on inertia and on friction after a reversal.

Pairs at constant velocity cannot distinguish the two. In the ramps they differ: inertia follows the
acceleration, and what is left of it later grows with speed and decays in time; a friction deficit
after a reversal is the same at all speeds and decays over an angle. Counted as friction, the misfit
of an angle bin is

.. math:: \sigma d (u - \hat u) = \sigma d\, J \ddot q - b\, e^{-s/s_0} + \sigma d\, m\, a_\tau(t)
    + \text{nuisance columns},

with sign convention :math:`\sigma`, direction *d*, angle *s* and time *t* since the reversal, and
:math:`a_\tau` the acceleration of the move after a first-order lag :math:`\tau`. The nuisance
columns have free coefficients: a constant and a square root of speed for each move (temperature,
drift), a misfit common to all speeds, acceleration, gravity, and acceleration two samples earlier
and later, which stands for any lag between the channels and for smoothing.

Standard errors are robust to correlation within a move and within all moves of one direction, part
and speed: a servo repeats its misfit exactly.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli import schemas, tables
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.noise.significance import log_bayes_factor
from frictioncli.diagnosis.ramps.misfit import RampMisfit, resolved
from frictioncli.diagnosis.ramps.robust_fit import Residual, RobustFit
from frictioncli.distributions import t_quantile
from frictioncli.pairs.ramps import LAGS
from frictioncli.workfiles import STARTS

DISTANCES = np.geomspace(0.3, 20.0, 15)
"""Angles over which a friction deficit may decay. [deg]"""

DELAYS = np.geomspace(0.05, 1.0, 11)
"""Time constants with which inertia may act late. [s]"""

LEAST_MOVES = 6
"""Least number of moves that start at a reversal."""

MAX_LOG_ODDS = 12.0
"""Greatest log odds that the ramps may contribute, 160,000 to 1: their model is not exact."""

_STEP = 1.01
"""Relative step of the distance for its derivative."""

_CONVINCING = 3.0
"""Log Bayes factor from which an explanation is fitted before the others are estimated."""

_PAIR = ("inertia", "reversal_transient")


@dataclass(frozen=True, slots=True)
class RampLog:
    """Ramps of one joint.

    Attributes
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.RAMPS`.
    sign : int
        Sign convention of the log: +1 where forward torque is load plus friction, else -1.
    starts : DataFrame or None
        Rows of :data:`frictioncli.schemas.STARTS`; none in work folders of older versions.
    """

    rows: pd.DataFrame
    sign: int
    starts: pd.DataFrame | None = None


@dataclass(frozen=True, slots=True)
class RampEstimate:
    """An estimate with its 95 % interval.

    Attributes
    ----------
    value, low, high : float
        Estimate and ends of the interval, in the unit of the quantity.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RampEvidence:
    """Estimates from the ramps, and Bayes factors of the two explanations.

    Attributes
    ----------
    inertia : RampEstimate
        Inertia J about the joint axis; every joint has it, so that it is no finding.
        [N·m/(deg/s²)]
    lag : float
        Delay of the logged torque after the acceleration. [samples]
    deficit : RampEstimate
        Friction deficit right after a reversal, b. [N·m]
    distance : RampEstimate
        Angle over which it decays, s₀. [deg]
    delayed_inertia : RampEstimate
        Inertia that acts late, when the speed is constant already, m. [N·m/(deg/s²)]
    delay : float
        Time constant of its lag, τ. [s]
    rms_before, rms_after : float
        RMS misfit of the ramps, by the base model alone and with inertia and what else is
        convincing. [N·m]
    transient : float
        Log Bayes factor of a friction deficit, against inertia that follows the acceleration and
        nothing else.
    inertial : float
        The same of inertia that also acts late, or does not, with even odds.
    moves : int
        Number of moves that start at a reversal.
    """

    inertia: RampEstimate
    lag: float
    deficit: RampEstimate
    distance: RampEstimate
    delayed_inertia: RampEstimate
    delay: float
    rms_before: float
    rms_after: float
    transient: float
    inertial: float
    moves: int

    @property
    def log_odds(self) -> float:
        """Log odds of a friction deficit against inertia, at most 12 either way."""
        return float(np.clip(self.transient - self.inertial, -MAX_LOG_ODDS, MAX_LOG_ODDS))


def ramp_logs(path: Path, signs: Mapping[str, int]) -> dict[int, RampLog]:
    """Return the ramps of each joint whose sign convention is known; none without the table.

    Parameters
    ----------
    path : Path
        The table ``ramps``, beside ``starts``; work folders of older versions do not have them.
    signs : mapping of str to int
        Sign convention by joint, as stage ``separate`` writes it.
    """
    if not path.exists():
        return {}
    near = path.with_name(STARTS)
    starts = tables.read(near, schemas.STARTS) if near.exists() else None
    return {
        int(joint): RampLog(
            rows, signs[str(joint)], None if starts is None else starts[starts["joint"] == joint]
        )
        for joint, rows in tables.read(path, schemas.RAMPS).groupby("joint")
        if str(joint) in signs
    }


def with_ramp_evidence(
    log_bayes_factors: Mapping[str, float], ramps: RampEvidence | None
) -> dict[str, float]:
    """Return log Bayes factors updated with the ramps' odds of inertia against a transient.

    The sum of the Bayes factors of ``inertia`` and ``reversal_transient`` stays. Nothing changes
    where one of them is missing or there are no ramps.

    Parameters
    ----------
    log_bayes_factors : mapping of str to float
        Logarithm of each effect's Bayes factor from the pairs.
    ramps : RampEvidence or None
        Evidence of the ramps.
    """
    updated = dict(log_bayes_factors)
    if ramps is None or not all(
        np.isfinite(log_bayes_factors.get(name, -np.inf)) for name in _PAIR
    ):
        return updated
    inertia, transient = (log_bayes_factors[name] for name in _PAIR)
    odds = transient + ramps.log_odds - inertia
    together = float(np.logaddexp(inertia, transient))
    updated["inertia"] = together - float(np.logaddexp(0.0, odds))
    updated["reversal_transient"] = together - float(np.logaddexp(0.0, -odds))
    return updated


def ramp_evidence(log: RampLog, problem: Problem, temperature: str) -> RampEvidence | None:
    """Return the evidence of the ramps of a problem's runs; None where there are too few.

    Parameters
    ----------
    log : RampLog
        The ramps of the joint.
    problem : Problem
        One joint's measurements and base model.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    """
    rows = log.rows
    rows = resolved(rows[rows["run"].isin(problem.runs)])
    after_reversal = (rows["part"] == "accelerating") & rows["reversal"]
    moves = int(rows.loc[after_reversal & rows["accelerates"], "move"].nunique())
    if moves < LEAST_MOVES:
        return None
    return _evidence(RampMisfit.of(rows, log.sign, problem, temperature), moves)


def _evidence(ramps: RampMisfit, moves: int) -> RampEvidence:
    """Return the evidence; a convincing explanation is fitted before the other is estimated."""
    off_inertia = Residual.of(
        ramps.projection.with_common(ramps.inertial), ramps.misfit, ramps.clusters
    )
    transient = log_bayes_factor(off_inertia.scores(ramps.deficit, DISTANCES, negative=False), 1)
    delayed = log_bayes_factor(off_inertia.scores(ramps.delayed_acceleration, DELAYS), 1)
    has_deficit = transient > max(delayed, _CONVINCING)
    has_delay = not has_deficit and delayed > _CONVINCING
    if has_deficit:
        distance = off_inertia.best(ramps.deficit, DISTANCES, negative=False)
        off_deficit = off_inertia.without(ramps.deficit(distance))
        time = off_deficit.best(ramps.delayed_acceleration, DELAYS)
    else:
        time = off_inertia.best(ramps.delayed_acceleration, DELAYS)
        rest = off_inertia.without(ramps.delayed_acceleration(time)) if has_delay else off_inertia
        distance = rest.best(ramps.deficit, DISTANCES, negative=False)
    slope = (ramps.deficit(distance * _STEP) - ramps.deficit(distance / _STEP)) / (
        2 * np.log(_STEP)
    )
    deficit = np.column_stack([ramps.deficit(distance), slope])
    delay = ramps.delayed_acceleration(time)[:, np.newaxis]
    residual = Residual.of(ramps.projection, ramps.misfit, ramps.clusters)
    with_deficit = residual.fitted(ramps.inertial, *([delay] if has_delay else []), deficit)
    with_delay = residual.fitted(ramps.inertial, *([deficit] if has_deficit else []), delay)
    if has_deficit:
        final = with_deficit
    elif has_delay:
        final = with_delay
    else:
        final = residual.fitted(ramps.inertial)
    lags = np.array(list(LAGS.values()), float)
    inertia = _estimate(final, range(len(lags)))
    size = _estimate(with_deficit, [-2])
    moment = float(lags @ final.coefficients[: len(lags)])
    half = np.log(0.5)
    return RampEvidence(
        inertia=inertia,
        lag=-moment / inertia.value if inertia.value else 0.0,
        deficit=size,
        distance=_distance_estimate(distance, _estimate(with_deficit, [-1]), size.value),
        delayed_inertia=_estimate(with_delay, [-1]),
        delay=time,
        rms_before=float(np.sqrt(np.mean(np.square(ramps.misfit * residual.projection.weight)))),
        rms_after=float(np.sqrt(np.mean(np.square(final.residual)))),
        transient=transient,
        inertial=float(np.logaddexp(half, half + delayed)),
        moves=moves,
    )


def _estimate(fit: RobustFit, places: Sequence[int]) -> RampEstimate:
    """Return the sum of some coefficients with its 95 % interval."""
    combination = np.zeros(len(fit.coefficients))
    combination[list(places)] = 1.0
    value = float(combination @ fit.coefficients)
    error = math.sqrt(max(float(combination @ fit.covariance @ combination), 0.0))
    reach = -t_quantile(0.025, fit.freedom) * error
    return RampEstimate(value, value - reach, value + reach)


def _distance_estimate(distance: float, slope: RampEstimate, deficit: float) -> RampEstimate:
    """Return the distance with its 95 % interval, from the coefficient of its derivative.

    Parameters
    ----------
    distance : float
        Angle over which the deficit decays. [deg]
    slope : RampEstimate
        Coefficient of the derivative of the deficit by the logarithm of the distance. [N·m]
    deficit : float
        Size of the deficit. [N·m]
    """
    low, high = float(DISTANCES[0]), float(DISTANCES[-1])
    half_width = (slope.high - slope.low) / 2
    if half_width < abs(deficit) * float(np.log(DISTANCES[-1] / DISTANCES[0])):
        factor = math.exp(half_width / abs(deficit))
        low, high = max(low, distance / factor), min(high, distance * factor)
    return RampEstimate(distance, min(low, distance), max(high, distance))
