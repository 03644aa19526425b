"""Sampling of a log: period, rate, jitter, gaps, repeated and backward times, clock resets."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array, Indices
from frictioncli.inspection.monitors.log_histogram import LogHistogram
from frictioncli.inspection.monitors.windows import CONTEXT, Window
from frictioncli.logs.samples.differentiation import max_gap

_SHARP = 0.3
"""Least share of steps at one value that makes it the period, however the others scatter. [-]"""

_SAME = 1e-3
_GAPS_SHOWN = 5
_LEAST_AFTER_RESET = 3
_RESETS_SHOWN = 100
"""Of a window of 32,768 rows."""

_STEADY = 0.2
"""Above this jitter, as a share of the period, missing samples cannot be counted. [-]"""

_NEGLIGIBLE = 1e-5


@dataclass(frozen=True, slots=True)
class Gap:
    """A gap between two samples.

    Attributes
    ----------
    seconds : float
        Its length. [s]
    at_s : float
        Its beginning since the first sample. [s]
    line : int
        Line of the first sample after it.
    """

    seconds: float
    at_s: float
    line: int


@dataclass(frozen=True, slots=True)
class Reset:
    """A reset of the clock to an earlier time.

    Attributes
    ----------
    line : int
        Line of the first sample after it.
    before_s, after_s : float
        Times before and after it. [s]
    """

    line: int
    before_s: float
    after_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling:
    """Sampling of a log.

    Attributes
    ----------
    samples : int
        Rows with a time and all required values.
    begins_s, duration_s : float
        Time of the first sample by the clock of the log; sum of all forward steps. [s]
    nominal_period_s : float
        Most frequent step; NaN where there is none. [s]
    rate_hz : float
        Forward steps per second, gaps included. [1/s]
    jitter_s : float
        Robust standard deviation of the steps. [s]
    missing_samples : int
        Samples missing between others, without gaps; 0 where the jitter is too large to count them.
    gaps, gaps_s : int, float
        Steps of more than five periods, and their sum. [s]
    longest_gaps : tuple of Gap
        The longest ones, longest first.
    duplicated_times, backward_times : int
        Rows with the time of the row before; rows before that time.
    resets : tuple of Reset
        Where the clock went back and stayed back.
    """

    samples: int
    begins_s: float
    duration_s: float
    nominal_period_s: float
    rate_hz: float
    jitter_s: float
    missing_samples: int
    gaps: int
    gaps_s: float
    longest_gaps: tuple[Gap, ...]
    duplicated_times: int
    backward_times: int
    resets: tuple[Reset, ...]


@dataclass(slots=True)
class SamplingMonitor:
    """Collects statistics of the times of a log."""

    _steps: LogHistogram = field(default_factory=LogHistogram)
    _samples: int = 0
    _begin: float = np.nan
    _duration: float = 0.0
    _duplicated: int = 0
    _backward: int = 0
    _longest: list[Gap] = field(default_factory=list)
    _resets: list[Reset] = field(default_factory=list)

    def update(self, window: Window) -> None:
        """Add the next rows."""
        time, new = window.rows.time, window.new
        if not self._samples:
            self._begin = float(time[new.start])
        steps = window.steps()
        first = new.stop - len(steps)  # the row to which the first step leads
        self._samples += new.stop - new.start
        self._steps.add(steps)
        self._duplicated += int(np.count_nonzero(steps == 0))
        self._backward += int(np.count_nonzero(steps < 0))
        self._update_longest(window, steps, first)
        self._duration += float(steps[steps > 0].sum())
        self._resets += _resets(window, np.flatnonzero(steps < 0) + first)

    def _update_longest(self, window: Window, steps: Array, first: int) -> None:
        since = self._duration + np.cumsum(np.maximum(steps, 0)) - np.maximum(steps, 0)
        top = np.argsort(steps, kind="stable")[::-1][:_GAPS_SHOWN]
        here = [
            Gap(float(steps[i]), float(since[i]), int(window.rows.lines[first + i])) for i in top
        ]
        self._longest = sorted([*self._longest, *here], key=lambda gap: -gap.seconds)[:_GAPS_SHOWN]

    def result(self) -> Sampling | None:
        """Return the sampling; None where there was no row."""
        if not self._samples:
            return None
        period = self._steps.densest()
        if not self._steps.share_near(period, _SAME) >= _SHARP:
            period = self._steps.quantile(0.5)
        limit = max_gap(period)
        jitter = self._steps.spread()
        steady = jitter < _STEADY * period
        return Sampling(
            samples=self._samples,
            begins_s=self._begin,
            duration_s=self._duration,
            nominal_period_s=period,
            rate_hz=self._steps.total / self._duration if self._duration > 0 else np.nan,
            jitter_s=0.0 if jitter < _NEGLIGIBLE * period else jitter,
            missing_samples=self._steps.missing_samples(period, limit) if steady else 0,
            gaps=self._steps.above(limit),
            gaps_s=self._steps.sum_above(limit),
            longest_gaps=tuple(gap for gap in self._longest if gap.seconds > limit),
            duplicated_times=self._duplicated,
            backward_times=self._backward,
            resets=tuple(self._resets),
        )


def _resets(window: Window, where: Indices) -> list[Reset]:
    """Return the backward steps after which time stays below that before the step."""
    time = window.rows.time
    around = np.arange(1, CONTEXT + 1)
    before = time[np.maximum(where[:, None] - around, 0)].min(axis=1, initial=np.inf)
    after = time[np.minimum(where[:, None] + around - 1, len(time) - 1)].max(
        axis=1, initial=-np.inf
    )
    stays = (after < before) & (where + _LEAST_AFTER_RESET <= len(time))
    return [
        Reset(int(window.rows.lines[i]), float(time[i - 1]), float(time[i]))
        for i in where[stays][:_RESETS_SHOWN]
    ]
