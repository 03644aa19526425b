"""Rivals of what a log does to the torque: nothing, a delay, a filter, or both.

Each is judged by the integral of the likelihood of shift and smear, a normal distribution, over
uniform priors of the delay and of the filter's time constant.
"""

import math
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.ramps.evidence import RampEstimate
from frictioncli.distributions import normal_log_density, normal_quantile

DELAYS = (-0.1, 0.2)
"""Least and greatest delay of the torque. [s]"""

LONGEST_FILTER = 0.3
"""Greatest time constant of the filter. [s]"""

RIVALS = ("none", "torque_delay", "torque_filter", "both")
"""What the log may do to the torque."""

_GRID = 1500
_DEVIATES = 41
_CONFIDENT = 0.975


@dataclass(frozen=True, slots=True)
class TimingRivals:
    """Rivals of what the log does to the torque.

    Attributes
    ----------
    point : ndarray, shape (2,)
        Estimate of shift and smear. [s], [s²]
    covariance : ndarray, shape (2, 2)
        Its covariance.
    """

    point: Array
    covariance: Array

    def log_evidence(self) -> dict[str, float]:
        """Return the logarithm of the evidence of each of :data:`RIVALS`."""
        step = LONGEST_FILTER / _GRID
        prior_of_delay = -math.log(DELAYS[1] - DELAYS[0])
        both = np.logaddexp.reduce(self._smear_likelihood(self._time_constants)) + math.log(step)
        filtered = np.logaddexp.reduce(self._filter_likelihood()) + math.log(step)
        return {
            "none": self._likelihood_of_neither(),
            "torque_delay": float(self._smear_likelihood(np.zeros(1))[0]) + prior_of_delay,
            "torque_filter": float(filtered) - math.log(LONGEST_FILTER),
            "both": float(both) + prior_of_delay - math.log(LONGEST_FILTER),
        }

    @property
    def best(self) -> str:
        """The rival with the greatest evidence."""
        evidence = self.log_evidence()
        return max(RIVALS, key=lambda name: evidence[name])

    @property
    def log_odds(self) -> float:
        """Log odds of a filter, with or without a delay, against a delay alone."""
        evidence = self.log_evidence()
        filtered = np.logaddexp(evidence["torque_filter"], evidence["both"])
        return float(filtered - evidence["torque_delay"])

    @property
    def shift(self) -> RampEstimate:
        """Mean time by which the torque is late, whatever the reason [s]."""
        reach = float(normal_quantile(_CONFIDENT)) * math.sqrt(self.covariance[0, 0])
        value = float(self.point[0])
        return RampEstimate(value, value - reach, value + reach)

    def combined(self, other: "TimingRivals") -> "TimingRivals":
        """Return the rivals by two estimates that are independent of each other."""
        weights = [np.linalg.inv(one.covariance) for one in (self, other)]
        covariance = np.linalg.inv(weights[0] + weights[1])
        point = covariance @ (weights[0] @ self.point + weights[1] @ other.point)
        return TimingRivals(point, covariance)

    def estimates(self) -> tuple[RampEstimate, RampEstimate]:
        """Return delay and time constant [s] over all rivals, each with its probability."""
        evidence = self.log_evidence()
        total = np.logaddexp.reduce(list(evidence.values()))
        share = {name: math.exp(value - total) for name, value in evidence.items()}
        tau = self._time_constants
        both = _normalised(self._smear_likelihood(tau))
        filtered = _normalised(self._filter_likelihood())
        mass = share["both"] * both + share["torque_filter"] * filtered
        unfiltered = share["none"] + share["torque_delay"]
        time_constant = _estimate(np.append(0.0, tau), np.append(unfiltered, mass))
        # standard normal deviates at which a normal distribution is represented
        deviates = normal_quantile((np.arange(_DEVIATES) + 0.5) / _DEVIATES)
        spread = self._sd * deviates
        delays = np.concatenate(
            [
                [0.0],
                self._delay_at(np.zeros(1)) + spread,
                (self._delay_at(tau)[:, np.newaxis] + spread).ravel(),
            ]
        )
        weight = np.concatenate(
            [
                [share["none"] + share["torque_filter"]],
                np.full(_DEVIATES, share["torque_delay"] / _DEVIATES),
                np.repeat(share["both"] * both / _DEVIATES, _DEVIATES),
            ]
        )
        return _estimate(delays, weight), time_constant

    @property
    def _time_constants(self) -> Array:
        half_step = LONGEST_FILTER / _GRID / 2
        return np.linspace(half_step, LONGEST_FILTER - half_step, _GRID)

    def _filter_likelihood(self) -> Array:
        """Return the log likelihood of a filter without a delay, by time constant."""
        tau = self._time_constants
        found: Array = self._smear_likelihood(tau)
        return found + normal_log_density(self._delay_at(tau), self._sd)

    def _likelihood_of_neither(self) -> float:
        """Return the log likelihood of a torque that is logged with the position."""
        distance = float(self.point @ np.linalg.solve(self.covariance, self.point))
        determinant = float(np.linalg.slogdet(2 * math.pi * self.covariance)[1])
        return -(distance + determinant) / 2

    def _smear_likelihood(self, time_constant: Array) -> Array:
        """Return the log likelihood of the smear by time constant, whatever the delay."""
        sd = math.sqrt(self.covariance[1, 1])
        return np.asarray(normal_log_density(self.point[1] - np.square(time_constant), sd))

    def _delay_at(self, time_constant: Array) -> Array:
        """Return the most likely delay beside each time constant [s]."""
        regression = self.covariance[0, 1] / self.covariance[1, 1]
        smear = self.point[1] - np.square(time_constant)
        return np.asarray(self.point[0] - time_constant - regression * smear)

    @property
    def _sd(self) -> float:
        """Standard error of the delay beside a known time constant [s]."""
        rest = self.covariance[0, 0] - self.covariance[0, 1] ** 2 / self.covariance[1, 1]
        return math.sqrt(max(rest, 0.0))


def _normalised(log_likelihood: Array) -> Array:
    """Return probabilities from log likelihoods."""
    weight = np.exp(log_likelihood - np.max(log_likelihood))
    return np.asarray(weight / np.sum(weight))


def _estimate(values: Array, weight: Array) -> RampEstimate:
    """Return mean and 95 % interval of weighted values."""
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weight[order])
    places = np.searchsorted(total, [(1 - _CONFIDENT) * total[-1], _CONFIDENT * total[-1]])
    low, high = values[order][np.minimum(places, len(values) - 1)]
    return RampEstimate(float(np.sum(values * weight) / total[-1]), float(low), float(high))
