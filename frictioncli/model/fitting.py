"""Friction model of one joint from its friction torques."""

from typing import Any

import numpy as np
import pandas as pd

from frictioncli.errors import NotEnoughData
from frictioncli.model.document import PARAMETERS, FrictionModel, InputRange, ParameterEstimate
from frictioncli.model.identifiability import Determination, at_bound, determined_fit
from frictioncli.model.identification import Estimate, with_error_of
from frictioncli.model.late_torque import (
    FREED,
    UNKNOWN_ERROR,
    late_column,
    torque_delay,
    without_delay,
)
from frictioncli.model.observations import observations
from frictioncli.model.paper_method import consecutive_fit
from frictioncli.model.settings import LEAST_OPPOSING, LEAST_PAIRS, FitSettings, not_opposing
from frictioncli.model.zero_load import temperature_of, with_temperature
from frictioncli.wording import count_text, quantity_text

_LATE = (
    f"the torque in these logs lags the position by {{delay}}, by the pairs alone; {FREED}"
    " ('frictioncli diagnose' uses starts of moves, too, and may state another delay)"
)

_MAY_BE_LATE = (
    "these moves do not tell whether the torque lags the position; the intervals allow for a delay"
    f" or an advance of up to {2e3 * UNKNOWN_ERROR:.0f} ms, which here counts as much as the noise"
)

__all__ = ["LEAST_PAIRS", "fit_joint"]


def fit_joint(torques: pd.DataFrame, facts: dict[str, Any], settings: FitSettings) -> FrictionModel:
    """Identify equation (16) from the torques of one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    facts : dict
        Facts of the torque table: ``torque_unit``, ``load_unit``, ``torque_side``, ``sign``.
    settings : FitSettings
        Method and temperature.

    Returns
    -------
    FrictionModel
        The parameters with confidence intervals, and those that the data do not determine.

    Raises
    ------
    NotEnoughData
        If there are too few pairs, or the log lacks what the method or the temperature needs.
    """
    joint = int(torques["joint"].iloc[0])
    temperature = settings.temperature
    if temperature == "auto":
        temperature = _automatic_temperature(torques, settings)
    known, notes = _with_temperature(torques, temperature, joint)
    delay, may_be_late = None, _may_be_late(facts, settings, joint)
    if may_be_late:
        delay = torque_delay(known)
    if delay is not None and delay.interval[0] > 0:
        notes.append(_LATE.format(delay=quantity_text(delay.value, delay.interval, "s")))
    freed = without_delay(known, None if delay is None else delay.value)
    observed = observations(freed, temperature)
    n_pairs = len(observed.friction)
    opposing = float(np.mean(observed.friction > 0))
    if opposing < LEAST_OPPOSING:
        notes.append(f"friction is doubtful: {not_opposing(opposing)}")
    two_loads = facts.get("two_loads", {}).get(str(joint))
    if two_loads:
        notes.append(f"friction is doubtful: {two_loads}")
    separated_by = facts.get("separated_by", {}).get(str(joint), "pairs")
    if n_pairs < LEAST_PAIRS and separated_by == "regression":
        raise NotEnoughData(
            f"joint {joint}: {count_text(n_pairs, 'group')} of one speed, temperature and time"
            f" found by regression, expected at least {LEAST_PAIRS}; log more motion"
        )
    if n_pairs < LEAST_PAIRS:
        raise NotEnoughData(
            f"joint {joint}: {count_text(n_pairs, 'pair')} of counter-directed moves found,"
            f" expected at least {LEAST_PAIRS}; log more moves, or loosen the options of"
            " 'frictioncli pair'"
        )
    if settings.method == "paper":
        estimate, determination = consecutive_fit(known, observed, temperature)
    else:
        estimate, determination = determined_fit(observed)
    if may_be_late:
        late = observations(known.assign(friction_torque=late_column(known)), temperature)
        error = UNKNOWN_ERROR if delay is None else delay.error
        widened = with_error_of(estimate, observed, determination.terms, late, error)
        if delay is None and _is_mostly_added(estimate, widened):
            notes.append(_MAY_BE_LATE)
        estimate = widened
    return FrictionModel(
        joint=joint,
        method=settings.method,
        temperature=temperature,
        torque_unit=facts.get("torque_unit", "N·m"),
        torque_side=facts.get("torque_side", "joint"),
        sign=int(facts.get("sign", {}).get(str(joint), 1)),
        parameters=_estimates(estimate, determination, facts, joint),
        rmse=estimate.rmse,
        n_pairs=n_pairs,
        noise=estimate.noise,
        correlation=_correlations(estimate),
        range=_ranges(known, observed.temperature),
        notes=tuple(notes),
        separated_by=str(separated_by),
        delay=None
        if delay is None
        else ParameterEstimate(
            estimate=delay.value, ci95=delay.interval, unit="s", determined=True
        ),
    )


def _automatic_temperature(torques: pd.DataFrame, settings: FitSettings) -> str:
    """Return the temperature of friction where none is chosen: one that is logged, if any is."""
    motor, housing = (
        bool(torques[f"{part}_temperature"].notna().any()) for part in ("motor", "housing")
    )
    if not housing:
        return "motor"
    if not motor:
        return "housing"
    return "mean" if settings.method == "paper" else "motor"


def _may_be_late(facts: dict[str, Any], settings: FitSettings, joint: int) -> bool:
    """Return whether torques are of pairs of moves, in which a delay looks like friction."""
    in_pairs = facts.get("separated_by", {}).get(str(joint), "pairs") == "pairs"
    one_unit = facts.get("load_unit", facts.get("torque_unit")) == facts.get("torque_unit")
    return settings.method != "paper" and in_pairs and one_unit


def _is_mostly_added(estimate: Estimate, widened: Estimate) -> bool:
    """Return whether at least half of the variance of some parameter was added."""
    before, after = (np.diag(one.covariance) for one in (estimate, widened))
    return bool(np.any(after > 2.0 * before))


def _with_temperature(
    torques: pd.DataFrame, kind: str, joint: int
) -> tuple[pd.DataFrame, list[str]]:
    """Return the rows with a known temperature, and notes on the others."""
    known, lost = with_temperature(torques, kind)
    notes = []
    if lost.without:
        notes.append(f"{lost.without} pairs without {kind} temperature were not used")
    if lost.stuck:
        notes.append(
            f"{lost.stuck} pairs were not used whose {kind} temperature stood still and then"
            " jumped, as where a sensor is no longer read"
        )
    if notes:
        return known, notes
    if temperature_of(known, kind).notna().all():
        return known, []
    if kind != "motor":
        both = ["motor_temperature", "housing_temperature"]
        columns = ["housing_temperature"] if kind == "housing" else both
        raise NotEnoughData(
            f"joint {joint}: the log has no {' and '.join(columns)}, which --temperature {kind}"
            " needs; use --temperature motor"
        )
    return torques, ["no motor temperature in the log: friction is a function of speed and load"]


def _estimates(
    estimate: Estimate, determination: Determination, facts: dict[str, Any], joint: int
) -> dict[str, ParameterEstimate]:
    units = _units(facts)
    bounds = at_bound(estimate)
    found = {}
    for name in PARAMETERS:
        if name not in estimate.names:
            found[name] = ParameterEstimate(
                estimate=0.0,
                ci95=None,
                unit=units[name],
                determined=False,
                reason=determination.dropped.get(name),
            )
            continue
        low, high = _with_shared_error(estimate.interval(name), facts, joint, name)
        has_interval = bool(np.isfinite(low) and np.isfinite(high))
        without = None if has_interval else "the data give it no interval"
        found[name] = ParameterEstimate(
            estimate=getattr(estimate.parameters, name),
            ci95=(max(low, 0.0), high) if has_interval else None,
            unit=units[name],
            determined=has_interval and name not in bounds,
            reason=bounds.get(name) or without or determination.merged.get(name),
        )
    return found


def _with_shared_error(
    interval: tuple[float, float], facts: dict[str, Any], joint: int, name: str
) -> tuple[float, float]:
    """Return an interval widened by what errs in all torques alike, which scatter does not show.

    That is inertia, gravity and offset of a regression from which the torques come, and the torque
    constant by which a current was brought to N·m.
    """
    widths = [interval[1] - interval[0]]
    regression = facts.get("regression", {}).get(str(joint), {}).get("parameters", {})
    if name in regression:
        low, high = regression[name]["ci95"]
        widths.append(high - low)
    constant = facts.get("torque_constant", {}).get(str(joint), {})
    if constant.get("ci95") and name != "delta":
        low, high = constant["ci95"]
        widths.append(abs(sum(interval) / 2 * (high - low) / constant["estimate"]))
    if len(widths) == 1:
        return interval
    centre, half = sum(interval) / 2, float(np.linalg.norm(widths)) / 2
    return centre - half, centre + half


def _units(facts: dict[str, Any]) -> dict[str, str]:
    torque = facts.get("torque_unit", "N·m")
    load = facts.get("load_unit", torque)
    alpha = f"1/({load})" if load == torque else f"{torque}/({load})²"
    viscous = f"{torque}/(deg/s)^0.5"
    return {
        "tau_c": torque,
        "alpha": alpha,
        "beta": viscous,
        "gamma": viscous,
        "delta": "1/°C",
    }


def _correlations(estimate: Estimate) -> dict[str, dict[str, float]]:
    # what no data tell is correlated with nothing
    covariance = np.where(np.isfinite(estimate.covariance), estimate.covariance, 0.0)
    deviation = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = covariance / np.outer(deviation, deviation)
    return {
        name: {other: round(float(correlation[i, j]), 4) for j, other in enumerate(estimate.names)}
        for i, name in enumerate(estimate.names)
    }


def _ranges(torques: pd.DataFrame, temperature: np.ndarray) -> InputRange:
    def limits(values: Any) -> tuple[float, float] | None:
        finite = np.asarray(values, dtype=float)
        finite = finite[np.isfinite(finite)]
        return (float(finite.min()), float(finite.max())) if finite.size else None

    return InputRange(
        speed=limits(torques["speed"]),
        load=limits(torques["load_torque"]),
        temperature=limits(temperature),
        position=limits(torques["position"]),
    )
