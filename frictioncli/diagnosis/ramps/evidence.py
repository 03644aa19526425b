r"""What the ramps of moves say about inertia and about friction after a reversal.

Paired data at constant velocity confuse the two. In the ramps they are different things: inertia
follows the acceleration, and what is left of it later grows with speed and fades in time; a lack of
friction after a reversal is the same at all speeds and fades over an angle. Counted as friction,
the misfit of a bin is taken as

.. math:: \sigma d (u - \hat u) = \sigma d\, J \ddot q - b\, e^{-s/s_0} + \sigma d\, m\, a_\tau(t)
    + \text{what both could be confused with},

with sign convention :math:`\sigma`, direction *d*, angle *s* and time *t* since the reversal, and
:math:`a_\tau` the move's ramp as a first-order lag :math:`\tau` would follow it. The
rest is taken out with free coefficients: a constant and a square root of speed for each move
(temperature, drift), what all speeds have in common, acceleration, gravity, and acceleration two
samples earlier and later, which stands for any lag between the channels and for smoothing.

Errors are robust against correlation within a move and, added to that, within all moves of one
direction, part and speed: a servo repeats its misfit exactly.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats
from scipy.optimize import minimize_scalar

from frictioncli import schemas, tables
from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.noise.significance import log_evidence
from frictioncli.diagnosis.ramps.misfit import RampMisfit, resolved
from frictioncli.diagnosis.ramps.robust_fit import Fit, Projection, fitted
from frictioncli.pairs.ramps import LAGS

DISTANCES = np.geomspace(0.3, 20.0, 15)
"""Angles over which a lack of friction may fade. [deg]"""

SETTLINGS = np.geomspace(0.05, 1.0, 11)
"""Lags with which acceleration that is not seen in the velocity may act. [s]"""

LEAST_MOVES = 6
"""With fewer moves that begin at a reversal the ramps say nothing."""

MOST_SAID = 12.0
"""The ramps' word counts at most as much: the logarithm of 160,000 to 1."""

_STEP = 1.01
_STANDS_OUT = 3.0
"""What has less log evidence than this leaves the estimates of the others alone."""

_PAIR = ("inertia", "reversal_transient")


@dataclass(frozen=True, slots=True)
class RampLog:
    """Rows of :data:`frictioncli.schemas.RAMPS` of one joint, and the log's sign convention."""

    rows: pd.DataFrame
    sign: int


@dataclass(frozen=True, slots=True)
class RampEstimate:
    """A number with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RampEvidence:
    """What the ramps say.

    Attributes
    ----------
    inertia : RampEstimate
        Inertia J about the joint axis as seen in the torque; always there, never a finding.
        [N·m/(deg/s²)]
    lag : float
        By how much torque is logged later than acceleration. [samples]
    lack : RampEstimate
        Friction lacking right after a reversal, b. [N·m]
    distance : RampEstimate
        Angle over which it fades, s. [deg]
    settling : RampEstimate
        Inertia that acts late, when speed looks constant already, m. [N·m/(deg/s²)]
    settling_time : float
        Lag with which it acts. [s]
    rms_before, rms_after : float
        RMS misfit of the ramps, by the base alone and with all of it. [N·m]
    transient : float
        Logarithm of the Bayes factor of a lack of friction, against inertia that follows the
        acceleration and nothing else.
    inertial : float
        The same of inertia that also settles unseen, or does not.
    moves : int
        Moves that begin at a reversal.
    """

    inertia: RampEstimate
    lag: float
    lack: RampEstimate
    distance: RampEstimate
    settling: RampEstimate
    settling_time: float
    rms_before: float
    rms_after: float
    transient: float
    inertial: float
    moves: int

    @property
    def log_odds(self) -> float:
        """Logarithm of the odds of a lack of friction over inertia, bounded to what ramps bear."""
        return float(np.clip(self.transient - self.inertial, -MOST_SAID, MOST_SAID))


def ramp_logs(path: Path, signs: Mapping[str, int]) -> dict[int, RampLog]:
    """Return the ramps of each joint whose sign convention is known; none without the table.

    Parameters
    ----------
    path : Path
        The table ``ramps``; work folders of older versions have none.
    signs : mapping of str to int
        Sign convention by joint, as stage ``separate`` notes it.
    """
    if not path.exists():
        return {}
    return {
        int(joint): RampLog(own, signs[str(joint)])
        for joint, own in tables.read(path, schemas.RAMPS).groupby("joint")
        if str(joint) in signs
    }


def arbitrated(evidence: Mapping[str, float], ramps: RampEvidence | None) -> dict[str, float]:
    """Return log evidence in which the ramps have shifted weight between the two they can tell.

    ``inertia`` and ``reversal_transient`` keep their weight together; nothing else is changed, and
    nothing at all where one of them is missing or the ramps say nothing.

    Parameters
    ----------
    evidence : mapping of str to float
        Logarithm of each effect's Bayes factor by the paired data.
    ramps : RampEvidence or None
        What the ramps say.
    """
    changed = dict(evidence)
    if ramps is None or not all(np.isfinite(evidence.get(name, -np.inf)) for name in _PAIR):
        return changed
    inertia, transient = (evidence[name] for name in _PAIR)
    odds = transient + ramps.log_odds - inertia
    together = float(np.logaddexp(inertia, transient))
    changed["inertia"] = together - float(np.logaddexp(0.0, odds))
    changed["reversal_transient"] = together - float(np.logaddexp(0.0, -odds))
    return changed


def ramp_evidence(log: RampLog, problem: Problem, temperature: str) -> RampEvidence | None:
    """Return what the ramps of a problem's runs say; None where there are too few.

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
    fresh = (rows["part"] == "accelerating") & rows["reversal"]
    moves = int(rows.loc[fresh & rows["accelerates"], "move"].nunique())
    if moves < LEAST_MOVES:
        return None
    return _told(RampMisfit.of(rows, log.sign, problem, temperature), moves)


def _told(seen: RampMisfit, moves: int) -> RampEvidence:
    """Return what the misfit says; what stands out takes its share before the rest is sized."""
    view = _View.of(seen, seen.projection.with_free(seen.inertial))
    transient = log_evidence(view.scores(seen.lack, DISTANCES, lacking=True), 1)
    settled = log_evidence(view.scores(seen.settling, SETTLINGS), 1)
    lacks = transient > max(settled, _STANDS_OUT)
    settles = not lacks and settled > _STANDS_OUT
    if lacks:
        distance = view.best(seen.lack, DISTANCES, lacking=True)
        time = view.without(seen.lack(distance)).best(seen.settling, SETTLINGS)
    else:
        time = view.best(seen.settling, SETTLINGS)
        rest = view.without(seen.settling(time)) if settles else view
        distance = rest.best(seen.lack, DISTANCES, lacking=True)
    slope = (seen.lack(distance * _STEP) - seen.lack(distance / _STEP)) / (2 * np.log(_STEP))
    lack = np.column_stack([seen.lack(distance), slope])
    settling = seen.settling(time)[:, np.newaxis]
    whole = _View.of(seen, seen.projection)
    with_lack = whole.fitted(seen.inertial, *([settling] if settles else []), lack)
    with_settling = whole.fitted(seen.inertial, *([lack] if lacks else []), settling)
    last = with_lack if lacks else with_settling if settles else whole.fitted(seen.inertial)
    lags = np.array(list(LAGS.values()), float)
    inertia = _estimate(last, range(len(lags)))
    missing = _estimate(with_lack, [-2])
    moment = float(lags @ last.coefficients[: len(lags)])
    none = np.log(0.5)
    return RampEvidence(
        inertia=inertia,
        lag=-moment / inertia.value if inertia.value else 0.0,
        lack=missing,
        distance=_spread(distance, _estimate(with_lack, [-1]), missing.value),
        settling=_estimate(with_settling, [-1]),
        settling_time=time,
        rms_before=float(np.sqrt(np.mean(np.square(seen.misfit * whole.projection.weight)))),
        rms_after=float(np.sqrt(np.mean(np.square(last.residual)))),
        transient=transient,
        inertial=float(np.logaddexp(none, none + settled)),
        moves=moves,
    )


@dataclass(frozen=True, slots=True)
class _View:
    """The misfit off a projection, ready for columns to be fitted to it."""

    seen: RampMisfit
    projection: Projection
    misfit: Array

    @classmethod
    def of(cls, seen: RampMisfit, projection: Projection) -> "_View":
        return cls(seen, projection, projection.off(seen.misfit[:, np.newaxis])[:, 0])

    def without(self, column: Array) -> "_View":
        """Return the view with a further column taken out."""
        return _View.of(self.seen, self.projection.with_free(column[:, np.newaxis]))

    def fitted(self, *columns: Array) -> Fit:
        """Return the fit of columns, shapes (rows,) or (rows, columns)."""
        together = np.column_stack(columns)
        return fitted(self.projection.off(together), self.misfit, self.seen.clusters)

    def scores(
        self, column: Callable[[float], Array], grid: Array, *, lacking: bool = False
    ) -> Array:
        """Return the score over a grid of shapes; of a lack, none where it has the wrong sign."""
        fits = [self.fitted(column(shape)) for shape in grid]
        return np.array(
            [fit.score(0) if fit.coefficients[0] > 0 or not lacking else 0.0 for fit in fits]
        )

    def best(
        self, column: Callable[[float], Array], grid: Array, *, lacking: bool = False
    ) -> float:
        """Return the shape that leaves least, off the grid."""
        nothing = float(np.sum(np.square(self.misfit)))

        def left(log: float) -> float:
            fit = self.fitted(column(float(np.exp(log))))
            wrong = lacking and fit.coefficients[0] <= 0
            return nothing if wrong else float(np.sum(np.square(fit.residual)))

        values = np.array([left(log) for log in np.log(grid)])
        top = int(np.argmin(values))
        about = np.log(grid[[max(top - 1, 0), min(top + 1, len(grid) - 1)]])
        found = minimize_scalar(left, bounds=about, method="bounded", options={"xatol": 1e-3})
        return float(np.exp(found.x)) if found.fun < values[top] else float(grid[top])


def _estimate(fit: Fit, places: Sequence[int]) -> RampEstimate:
    """Return the sum of some coefficients with its interval."""
    combination = np.zeros(len(fit.coefficients))
    combination[list(places)] = 1.0
    value = float(combination @ fit.coefficients)
    error = math.sqrt(max(float(combination @ fit.covariance @ combination), 0.0))
    reach = float(stats.t.isf(0.025, fit.freedom)) * error
    return RampEstimate(value, value - reach, value + reach)


def _spread(distance: float, slope: RampEstimate, lack: float) -> RampEstimate:
    """Return the distance with the interval that its slope's error gives, within its range."""
    low, high = float(DISTANCES[0]), float(DISTANCES[-1])
    reach = (slope.high - slope.low) / 2
    if reach < abs(lack) * float(np.log(DISTANCES[-1] / DISTANCES[0])):
        factor = math.exp(reach / abs(lack))
        low, high = max(low, distance / factor), min(high, distance * factor)
    return RampEstimate(distance, min(low, distance), max(high, distance))
