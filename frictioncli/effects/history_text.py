"""A history in words: the runs and the hours in which a change was there."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import EffectTable
from frictioncli.effects.history import Stretch, run_spans, stretches
from frictioncli.effects.pair_series import measured_share, pair_heads

_ALIKE = 0.05
"""Share of the longest run within which moments of several runs are the same."""

_UNITS = ((3600.0, 3600.0, "h", 1), (180.0, 60.0, "min", 0), (0.0, 1.0, "s", 0))
"""Duration of the longest run from which a unit is used, the unit, its symbol and decimals."""

Times = tuple[float | None, float | None]
"""Begin and end of a stretch in its run; None where it begins or ends with the run. [s]"""


def history_text(shape: Mapping[str, float], table: EffectTable, runs: Sequence[str]) -> str:
    """Return when a change was there, in words.

    Parameters
    ----------
    shape : mapping of str to float
        Shape parameters of its history.
    table : EffectTable
        Pairs and angle bins of all runs.
    runs : sequence of str
        Names of all runs, in order of time.

    Returns
    -------
    str
        As "in run day2 from 3.1 h on" or "from 4.0 h on in every run".
    """
    found = [_run_part(span, shape, table) for span in run_spans(table)]
    if not any(part.times for part in found):
        return "in no run"
    scale = _Scale.of(table)
    if len(found) == 1:
        return scale.text(found[0].times)
    if _same_in_every_run(found, scale):
        begins, ends = zip(*(part.times[0] for part in found), strict=True)
        return f"{scale.text([(_mean(begins), _mean(ends))])} in every run"
    if len(stretches(shape)) == 1 and sum(bool(part.times) for part in found) > 1:
        return _across_runs(found, runs, scale)
    whole = [name for name, part in zip(runs, found, strict=True) if part.whole]
    texts = [f"in {_listed(whole)}"] if whole else []
    texts += [
        f"in run {name} {scale.text(part.times)}"
        for name, part in zip(runs, found, strict=True)
        if part.times and not part.whole
    ]
    return " and ".join(texts)


def _across_runs(found: Sequence["_RunPart"], runs: Sequence[str], scale: "_Scale") -> str:
    """Return one stretch that lasts through several runs, in words."""
    there = [number for number, part in enumerate(found) if part.times]
    first, last = there[0], there[-1]
    begin, end = found[first].times[0][0], found[last].times[0][1]
    text = f"from {'' if begin is None else f'{scale.of_time(begin)} of '}run {runs[first]}"
    if end is None and last == len(found) - 1:
        return f"{text} on"
    return f"{text} to {'the end' if end is None else scale.of_time(end)} of run {runs[last]}"


@dataclass(frozen=True, slots=True)
class _RunPart:
    """The stretches of a history in one run."""

    times: list[Times]

    @property
    def whole(self) -> bool:
        """Whether the change was there throughout the run."""
        return self.times == [(None, None)]


@dataclass(frozen=True, slots=True)
class _Scale:
    """The unit of times, from the duration of the longest run."""

    longest: float
    unit: float
    symbol: str
    decimals: int

    @classmethod
    def of(cls, table: EffectTable) -> "_Scale":
        longest = max(float(np.ptp(table.time[table.run == one])) for one in np.unique(table.run))
        _, unit, symbol, decimals = next(one for one in _UNITS if longest >= one[0])
        return cls(longest, unit, symbol, decimals)

    def number(self, seconds: float) -> str:
        return f"{seconds / self.unit:.{self.decimals}f}"

    def of_time(self, seconds: float) -> str:
        return f"{self.number(seconds)} {self.symbol}"

    def text(self, times: Sequence[Times]) -> str:
        """Return the stretches of one run in words."""
        return " and ".join(self._part(begin, end) for begin, end in times)

    def _part(self, begin: float | None, end: float | None) -> str:
        if begin is None:
            return "throughout" if end is None else f"up to {self.of_time(end)}"
        if end is None:
            return f"from {self.of_time(begin)} on"
        return f"from {self.number(begin)} to {self.of_time(end)}"


def _run_part(span: Stretch, shape: Mapping[str, float], table: EffectTable) -> _RunPart:
    """Return the stretches of a history within one run."""
    heads = pair_heads(table)
    share, time = measured_share(table)[heads.first], table.time[heads.first]
    order = np.argsort(share)
    own = order[(share[order] >= span[0]) & (share[order] < span[1])]
    times: list[Times] = []
    for begin, end in stretches(shape):
        there = own[(share[own] >= begin) & (share[own] < end)]
        if there.size:
            times.append(
                (
                    None if there[0] == own[0] else _time(time, there[0]),
                    None if there[-1] == own[-1] else _time(time, there[-1]),
                )
            )
    return _RunPart(times)


def _time(time: Array, place: int) -> float:
    return float(time[place])


def _same_in_every_run(found: Sequence[_RunPart], scale: _Scale) -> bool:
    """Return whether each run has one stretch, from the same time to the same time."""
    if any(len(part.times) != 1 or part.whole for part in found):
        return False
    for number in (0, 1):
        values = [part.times[0][number] for part in found]
        known = [value for value in values if value is not None]
        if len(known) not in (0, len(values)):
            return False
        if known and max(known) - min(known) > _ALIKE * scale.longest:
            return False
    return True


def _mean(values: Sequence[float | None]) -> float | None:
    """Return the mean of times that are all known, or None where none is."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _listed(names: Sequence[str]) -> str:
    """Return names of runs as a list in words."""
    if len(names) == 1:
        return f"run {names[0]}"
    return f"runs {', '.join(names[:-1])} and {names[-1]}"
