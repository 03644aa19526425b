"""What changed between the runs of one joint."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.comparison.causes import CauseOfChange, cause_of, changed, with_witness
from frictioncli.comparison.conditions import Condition, changes_at
from frictioncli.comparison.day_to_day import LevelEstimate, Scatter
from frictioncli.comparison.days import Days
from frictioncli.comparison.loads import load_scales
from frictioncli.comparison.parameters import ParameterChange, parameter_changes
from frictioncli.comparison.run_levels import constant, constant_and_viscous, noises_of, run_levels
from frictioncli.comparison.settings import USUAL_MARGIN, ComparisonSettings
from frictioncli.diagnosis.data.problem import build_problems
from frictioncli.errors import NotEnoughData
from frictioncli.model.zero_load import temperature_of

_LEAST_PAIRS = 3
"""Fewest pairs of a run that has a level."""

_NEAR = 2.0
"""Runs this far apart in temperature can still be compared. [°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """What changed between the runs of one joint.

    Attributes
    ----------
    days : Days
        The runs.
    mean_friction : float
        Of all measurements; what percentages are of. [torque unit]
    levels : ndarray, shape (runs,)
        Friction of each run against the mean of all, as measured. [%]
    adjusted : ndarray, shape (runs,)
        The same, less what the surroundings explain. [%]
    errors : ndarray, shape (runs,)
        Half width of the 95 % interval of one adjusted level. [%]
    scatter : float
        Standard deviation from day to day that the intervals reckon with. [%]
    trend : LevelEstimate
        Change from the first run to the last, as a straight line through all. [%]
    last_run : LevelEstimate or None
        Last run against the mean of the earlier ones; none with two runs, where it is the trend.
    load : LevelEstimate or None
        Change of the load torque from the first run to the last; none where the joint carries
        next to nothing. [%]
    conditions : tuple of Condition
        The change of friction at reference conditions; empty where the runs cannot tell its
        constant part from its viscous one, or there is no temperature.
    parameters : tuple of ParameterChange
        The models of the first and the last work folder; empty if there is one.
    causes : tuple of CauseOfChange
        What the change looks like.
    verdict : {"no_evidence", "changed", "undetermined"}
        ``undetermined``: nothing found, and a change of ``margin`` is not ruled out.
    margin : float
        What is asked for. [%]
    exceeded : bool or None
        Whether a change was found that is above the threshold; none without a threshold.
    settings : ComparisonSettings
        How they were compared.
    """

    days: Days
    mean_friction: float
    levels: Array
    adjusted: Array
    errors: Array
    scatter: float
    trend: LevelEstimate
    last_run: LevelEstimate | None
    load: LevelEstimate | None
    conditions: tuple[Condition, ...]
    parameters: tuple[ParameterChange, ...]
    causes: tuple[CauseOfChange, ...]
    verdict: str
    margin: float
    exceeded: bool | None
    settings: ComparisonSettings

    @property
    def weak(self) -> bool:
        """Whether the scatter from day to day is assumed, as two runs cannot tell it."""
        return len(self.levels) == 2


def compare_runs(days: Days, settings: ComparisonSettings) -> Comparison:
    """Compare the runs of one joint.

    Parameters
    ----------
    days : Days
        The runs, in the order of time.
    settings : ComparisonSettings
        How.

    Raises
    ------
    NotEnoughData
        If a run has too few pairs, or the runs share too few conditions to be compared.
    """
    kind = days.models[0].temperature
    known = temperature_of(days.torques, kind).notna()
    usable = days.torques[known] if known.any() else days.torques
    _check_pairs(days, usable)
    _check_temperatures(days, usable.assign(temperature=temperature_of(usable, kind)))
    problem, _ = build_problems(usable, kind)
    mean = float(np.mean(problem.friction))
    loads = load_scales(problem)
    scale = np.ones(len(days.days)) if loads is None else 1 + loads[0] / 100
    noises = noises_of(problem, scale)
    found = run_levels(problem, constant(problem), noises, scale)
    if not found.comparable:
        raise NotEnoughData(
            f"joint {days.models[0].joint}: the runs share too few conditions to be compared, as"
            " temperatures and speeds differ from run to run; measure the same speeds over the same"
            " temperatures each time"
        )
    levels = 100 * (found.coefficients[:, 0] - found.coefficients[:, 0].mean()) / mean
    within = 1e4 * found.covariance / mean**2
    scatter = Scatter.of(within, days.surroundings, settings.day_to_day)
    trend_design, last_design = _designs(days.time)
    fitted = scatter.fitted(levels, trend_design)
    trend = fitted.estimate(np.array([0.0, 1.0]))
    last = None
    if len(levels) > 2:
        last = scatter.fitted(levels, last_design).estimate(np.array([0.0, 1.0]))
    load = None
    if loads is not None:
        load = loads[1].fitted(loads[0], trend_design).estimate(np.array([0.0, 1.0]))
    tests = sum(one is not None for one in (trend, last, load))
    findings = [one for one in (trend, last) if one is not None and changed(one, tests)]
    causes = with_witness(
        cause_of(levels, scatter, days.time, "friction") if findings else None,
        cause_of(*loads, days.time, "load") if loads and load and changed(load, tests) else None,
    )
    conditions: tuple[Condition, ...] = ()
    two_parts = run_levels(problem, constant_and_viscous(problem), noises, scale)
    if two_parts.comparable and known.any():
        conditions = changes_at(
            problem, two_parts, days.surroundings, settings.day_to_day, trend_design
        )
    margin = USUAL_MARGIN
    if settings.fail_above is not None:
        margin = settings.fail_above.percent(mean)
    return Comparison(
        days=days,
        mean_friction=mean,
        levels=levels,
        adjusted=levels - scatter.by_surroundings(levels, trend_design),
        errors=fitted.reach(within, settings.day_to_day),
        scatter=settings.day_to_day * float(np.sqrt(fitted.factor)),
        trend=trend,
        last_run=last,
        load=load,
        conditions=conditions,
        parameters=()
        if len(days.models) < 2
        else parameter_changes(days.models[0], days.models[-1]),
        causes=causes,
        verdict=_verdict(causes, trend, margin),
        margin=margin,
        exceeded=None
        if settings.fail_above is None
        else any(abs(one.value) > margin for one in findings),
        settings=settings,
    )


def _check_pairs(days: Days, usable: pd.DataFrame) -> None:
    pairs = usable.groupby("run")["pair"].nunique()
    for day, run in zip(days.days, days.torques["run"].unique(), strict=True):
        count = int(pairs.get(run, 0))
        if count < _LEAST_PAIRS:
            raise NotEnoughData(
                f"{day.label}: {count} pair(s) of counter-directed moves that can be used, expected"
                f" at least {_LEAST_PAIRS} in each run; leave the run out, or log more moves"
            )


def _check_temperatures(days: Days, usable: pd.DataFrame) -> None:
    """Raise NotEnoughData if a run was at temperatures that no other one has come near."""
    reached = usable.groupby("run")["temperature"].agg(["min", "max"]).to_numpy()
    for number, (low, high) in enumerate(reached):
        others = np.delete(reached, number, axis=0)
        # where no temperature is known, nothing is apart
        apart = (others[:, 0] > high + _NEAR) | (others[:, 1] < low - _NEAR)
        if apart.all():
            raise NotEnoughData(
                f"{days.days[number].label}: measured at {low:.0f} to {high:.0f} °C, where no other"
                " run was; measure over the same temperatures each time, or leave the run out"
            )


def _designs(time: Array) -> tuple[Array, Array]:
    """Return the courses of a steady trend and of a last run that differs, beside a constant."""
    steady = (time - time[0]) / (time[-1] - time[0])
    last = (np.arange(len(time)) == len(time) - 1).astype(float)
    ones = np.ones_like(time)
    return np.column_stack([ones, steady]), np.column_stack([ones, last])


def _verdict(causes: tuple[CauseOfChange, ...], trend: LevelEstimate, margin: float) -> str:
    if causes:
        return "changed"
    return "undetermined" if max(-trend.low, trend.high) > margin else "no_evidence"
