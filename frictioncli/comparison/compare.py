"""Comparison of the runs of one joint."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.comparison.causes import (
    CauseOfChange,
    cause_of,
    is_significant,
    reconcile_channels,
)
from frictioncli.comparison.conditions import ReferenceCondition, changes_at_references
from frictioncli.comparison.day_to_day import LevelEstimate, LevelModel
from frictioncli.comparison.parameters import ParameterChange, parameter_changes
from frictioncli.comparison.run_history import RunHistory
from frictioncli.comparison.run_levels import (
    constant_and_viscous_components,
    constant_component,
    load_levels,
    plausible_noises,
    run_levels,
)
from frictioncli.comparison.settings import USUAL_MARGIN, ComparisonSettings
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.errors import NotEnoughData
from frictioncli.model.zero_load import temperature_of
from frictioncli.wording import count_text

_LEAST_PAIRS = 3
"""Least number of pairs in a run."""

_LARGEST_GAP = 2.0
"""Largest gap between the temperature ranges of runs that can be compared. [°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Changes between the runs of one joint.

    Attributes
    ----------
    history : RunHistory
        The runs.
    mean_friction : float
        Mean of all measurements, to which percentages refer. [torque unit]
    levels : ndarray, shape (runs,)
        Friction level of each run less the mean of all, as measured. [%]
    adjusted : ndarray, shape (runs,)
        The levels less the effect of ambient temperature. [%]
    half_widths : ndarray, shape (runs,)
        Half-width of the 95 % interval of each adjusted level. [%]
    day_to_day : float
        Day-to-day standard deviation that the intervals assume. [%]
    trend : LevelEstimate
        Linear trend from the first run to the last. [%]
    last_run : LevelEstimate or None
        Last run less the mean of the earlier ones; None with two runs, where it is the trend. [%]
    load : LevelEstimate or None
        Linear trend of the load torque; None where the joint carries nearly no load. [%]
    conditions : tuple of ReferenceCondition
        Change of friction at reference conditions; empty where the runs cannot distinguish its
        constant and its viscous part, or no temperature is known.
    parameters : tuple of ParameterChange
        Changes from the model of the first to that of the last work folder; empty if there is one.
    causes : tuple of CauseOfChange
        Likely causes of the change.
    verdict : {"no_evidence", "changed", "undetermined"}
        ``undetermined``: nothing found, and a change of ``margin`` is not ruled out.
    margin : float
        Change that should be detected. [%]
    exceeded : bool or None
        Whether a change above the threshold was found; None without a threshold.
    settings : ComparisonSettings
        The settings.
    """

    history: RunHistory
    mean_friction: float
    levels: Array
    adjusted: Array
    half_widths: Array
    day_to_day: float
    trend: LevelEstimate
    last_run: LevelEstimate | None
    load: LevelEstimate | None
    conditions: tuple[ReferenceCondition, ...]
    parameters: tuple[ParameterChange, ...]
    causes: tuple[CauseOfChange, ...]
    verdict: str
    margin: float
    exceeded: bool | None
    settings: ComparisonSettings

    @property
    def weak(self) -> bool:
        """Whether the day-to-day variance is assumed, because two runs cannot determine it."""
        return len(self.levels) == 2


def compare_runs(history: RunHistory, settings: ComparisonSettings) -> Comparison:
    """Compare the runs of one joint.

    Parameters
    ----------
    history : RunHistory
        The runs in the order of time.
    settings : ComparisonSettings
        The settings.

    Returns
    -------
    Comparison
        Changes of friction and load torque, with intervals and causes.

    Raises
    ------
    NotEnoughData
        If a run has too few pairs, or the runs share too few conditions to be compared.
    """
    kind = history.models[0].temperature
    known = temperature_of(history.torques, kind).notna()
    usable = history.torques[known] if known.any() else history.torques
    _check_pairs(history, usable)
    _check_temperatures(history, usable.assign(temperature=temperature_of(usable, kind)))
    problem, _ = build_problems(usable, kind)
    mean = float(np.mean(problem.friction))
    loads = load_levels(problem)
    scale = np.ones(len(history.runs)) if loads is None else 1 + loads[0] / 100
    noises = plausible_noises(problem, scale)
    constant = run_levels(problem, constant_component(problem), noises, scale)
    if not constant.comparable:
        raise NotEnoughData(
            f"joint {history.models[0].joint}: the runs share too few conditions to be compared, as"
            " temperatures and speeds differ from run to run; measure the same speeds over the same"
            " temperatures each time"
        )
    levels = 100 * (constant.coefficients[:, 0] - constant.coefficients[:, 0].mean()) / mean
    within = 1e4 * constant.covariance / mean**2
    model = LevelModel.of(within, history.ambient, settings.day_to_day)
    trend_design, last_run_design = _designs(history.time)
    fit = model.fit(levels, trend_design)
    trend = fit.estimate(np.array([0.0, 1.0]))
    last_run = None
    if len(levels) > 2:
        last_run = model.fit(levels, last_run_design).estimate(np.array([0.0, 1.0]))
    load = None
    if loads is not None:
        load = loads[1].fit(loads[0], trend_design).estimate(np.array([0.0, 1.0]))
    tests = sum(one is not None for one in (trend, last_run, load))
    findings = [one for one in (trend, last_run) if one is not None and is_significant(one, tests)]
    load_changed = loads and load and is_significant(load, tests)
    causes = reconcile_channels(
        cause_of(levels, model, history.time, "friction") if findings else None,
        cause_of(*loads, history.time, "load") if loads and load_changed else None,
    )
    conditions: tuple[ReferenceCondition, ...] = ()
    components = constant_and_viscous_components(problem)
    two_components = run_levels(problem, components, noises, scale)
    if two_components.comparable and known.any():
        conditions = changes_at_references(
            problem, two_components, history.ambient, settings.day_to_day, trend_design
        )
    margin = USUAL_MARGIN
    if settings.fail_above is not None:
        margin = settings.fail_above.percent(mean)
    return Comparison(
        history=history,
        mean_friction=mean,
        levels=levels,
        adjusted=levels - model.ambient_effect(levels, trend_design),
        half_widths=fit.half_widths(within, settings.day_to_day),
        day_to_day=settings.day_to_day * float(np.sqrt(fit.variance_factor)),
        trend=trend,
        last_run=last_run,
        load=load,
        conditions=conditions,
        parameters=()
        if len(history.models) < 2
        else parameter_changes(history.models[0], history.models[-1]),
        causes=causes,
        verdict=_verdict(causes, trend, margin),
        margin=margin,
        exceeded=None
        if settings.fail_above is None
        else any(abs(one.value) > margin for one in findings),
        settings=settings,
    )


def _check_pairs(history: RunHistory, usable: pd.DataFrame) -> None:
    """Raise NotEnoughData if a run has too few pairs."""
    pairs = usable.groupby("run")["pair"].nunique()
    for run, number in zip(history.runs, history.torques["run"].unique(), strict=True):
        count = int(pairs.get(number, 0))
        if count < _LEAST_PAIRS:
            raise NotEnoughData(
                f"{run.label}: {count_text(count, 'pair')} of counter-directed moves that can be"
                f" used, expected at least {_LEAST_PAIRS} in each run; leave the run out, or log"
                " more moves"
            )


def _check_temperatures(history: RunHistory, usable: pd.DataFrame) -> None:
    """Raise NotEnoughData if the temperatures of a run are far from those of all others."""
    ranges = usable.groupby("run")["temperature"].agg(["min", "max"]).to_numpy()
    for number, (low, high) in enumerate(ranges):
        others = np.delete(ranges, number, axis=0)
        # comparisons with NaN are false: unknown temperatures are never distant
        distant = (others[:, 0] > high + _LARGEST_GAP) | (others[:, 1] < low - _LARGEST_GAP)
        if distant.all():
            raise NotEnoughData(
                f"{history.runs[number].label}: measured at {low:.0f} to {high:.0f} °C, where no"
                " other run was; measure over the same temperatures each time, or leave the run out"
            )


def _designs(time: Array) -> tuple[Array, Array]:
    """Return the designs of a linear trend and of a deviating last run, each with a constant."""
    linear = (time - time[0]) / (time[-1] - time[0])
    last = (np.arange(len(time)) == len(time) - 1).astype(float)
    ones = np.ones_like(time)
    return np.column_stack([ones, linear]), np.column_stack([ones, last])


def _verdict(causes: tuple[CauseOfChange, ...], trend: LevelEstimate, margin: float) -> str:
    if causes:
        return "changed"
    return "undetermined" if max(-trend.low, trend.high) > margin else "no_evidence"
