"""Rows of the torque table that a programme is predicted to add."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.design.limits import bin_width
from frictioncli.design.planned_joint import PLANNING_COLUMNS, PlannedJoint
from frictioncli.design.steps import (
    ACCELERATION,
    LEAD,
    PAYLOAD_CHANGE,
    HeatStep,
    RestStep,
    SeriesStep,
    Step,
    payload_changes,
    round_trip,
)
from frictioncli.diagnosis.data.gravity import form_of
from frictioncli.model.friction import friction_torque

SETTLING = 0.2
"""Time after a ramp until the speed is constant. [s]"""

_LEAST_COVERAGE = 0.6
"""Least share of an angle bin that must be passed at constant speed."""

_HEATING_STEP = 60.0
"""Heating moves are integrated in steps of this length. [s]"""


@dataclass(frozen=True, slots=True)
class Timing:
    """Start and end of a part of the programme, and the motor temperatures then.

    Attributes
    ----------
    start, end : float
        Time since the start of the programme, after a change of payload. [s]
    temperatures : (float, float)
        Motor temperature at the start and at the end; NaN where unknown. [°C]
    """

    start: float
    end: float
    temperatures: tuple[float, float]


class _Pair(NamedTuple):
    """A planned pair.

    Mid time [s], speed [deg/s], motor temperature [°C], bin centres [deg], payload [kg] and travel
    before it. [deg]
    """

    time: float
    speed: float
    motor: float
    bins: Array
    payload: float | None
    travel: float


def predict_rows(
    joint: PlannedJoint, steps: Sequence[Step], run: str
) -> tuple[pd.DataFrame, tuple[Timing, ...]]:
    """Return the rows that steps would add as a new run from a cold start, and their timing.

    Parameters
    ----------
    joint : PlannedJoint
        The joint.
    steps : sequence of Step
        The programme.
    run : str
        Name of the new run.

    Returns
    -------
    rows : DataFrame
        Planned rows with the noise-free torques of the base model. Column ``travel`` is the true
        travel before the pair, recorded or not. [deg]
    timings : tuple of Timing
        One per step.
    """
    width = bin_width(joint.torques)
    motor = joint.thermal_model.ambient if joint.thermal_model else float("nan")
    now, travel, payload = 0.0, 0.0, joint.payload
    pairs: list[_Pair] = []
    timings = []
    changes = payload_changes(steps, payload)
    for step, change in zip(steps, changes, strict=True):
        if change:
            motor, now = _after(joint, motor, PAYLOAD_CHANGE, None), now + PAYLOAD_CHANGE
        start, motor_at_start = now, motor
        if isinstance(step, SeriesStep):
            payload = payload if step.payload is None else step.payload
            now, motor = now + LEAD, _after(joint, motor, LEAD, None)
            for speed in step.speeds:
                now, motor = _cooled(joint, now, motor)
                half = round_trip(speed, step.high - step.low) / 2
                motor_at_mid = _after(joint, motor, half, speed)
                bins = constant_speed_bins(speed, step.low, step.high, width)
                if not joint.angle_logged:
                    bins = np.full(min(len(bins), 1), joint.torques["position"].iloc[0])
                if len(bins):
                    pairs.append(_Pair(now + half, speed, motor_at_mid, bins, payload, travel))
                travel += 2 * (step.high - step.low)
                now, motor = now + 2 * half, _after(joint, motor_at_mid, half, speed)
        elif isinstance(step, HeatStep):
            seconds, motor = _heat(joint, motor, step)
            now, travel = now + seconds, travel + seconds * step.speed
        elif isinstance(step, RestStep):
            now, motor = now + step.seconds, _after(joint, motor, step.seconds, None)
        timings.append(Timing(start, now, (motor_at_start, motor)))
    return _table(joint, pairs, run), tuple(timings)


def constant_speed_bins(speed: float, low: float, high: float, width: float) -> Array:
    """Return the centres of the angle bins that a move passes at constant speed.

    Parameters
    ----------
    speed : float
        Speed of the move. [deg/s]
    low, high : float
        Ends of the move. [deg]
    width : float
        Width of the bins. [deg]

    Returns
    -------
    ndarray, shape (bins,)
        Bin centres. [deg]

    Examples
    --------
    >>> constant_speed_bins(20.0, low=0.0, high=30.0, width=5.0)
    array([ 7.5, 12.5, 17.5, 22.5])
    """
    trimmed = speed**2 / (2 * ACCELERATION) + SETTLING * speed
    edges = np.arange(np.floor(low / width), np.ceil(high / width)) * width
    passed = np.minimum(edges + width, high - trimmed) - np.maximum(edges, low + trimmed)
    return np.asarray(edges[passed >= _LEAST_COVERAGE * width] + width / 2)


def _heat(joint: PlannedJoint, motor: float, step: HeatStep) -> tuple[float, float]:
    """Return the duration of heating moves [s] and the motor temperature after them [°C]."""
    spent = 0.0
    while spent < step.seconds:
        if step.until is not None and motor >= step.until:
            break
        part = min(_HEATING_STEP, step.seconds - spent)
        motor, spent = _after(joint, motor, part, step.speed), spent + part
    return spent, motor


def _cooled(joint: PlannedJoint, now: float, motor: float) -> tuple[float, float]:
    """Return time and motor temperature at the next move, which waits while the motor is hot."""
    model = joint.thermal_model
    if model is None:
        return now, motor
    limit = max(joint.waiting, model.ambient + 1.0)  # colder than that it never gets
    return (now, motor) if motor <= limit else (now + model.seconds_to(motor, limit), limit)


def _after(joint: PlannedJoint, motor: float, seconds: float, speed: float | None) -> float:
    """Return the motor temperature after a time at rest (speed None) or at a speed [°C]."""
    if joint.thermal_model is None:
        return float("nan")
    power = 0.0
    if speed is not None:
        power = speed * float(_friction(joint, np.array(speed), np.array(motor), np.array(0.0)))
    return joint.thermal_model.after(motor, seconds, power)


def _friction(joint: PlannedJoint, speed: Array, motor: Array, load: Array) -> Array:
    """Return the base model's friction torque at motor temperatures [N·m]."""
    used = motor
    if joint.temperature != "motor" and joint.thermal_model is not None:
        weight = {"housing": 1.0, "mean": 0.5}[joint.temperature]
        used = motor + weight * (joint.thermal_model.housing(motor) - motor)
    return friction_torque(
        joint.parameters, load=load, speed=speed, temperature=np.nan_to_num(used, nan=0.0)
    )


def _table(joint: PlannedJoint, pairs: Sequence[_Pair], run: str) -> pd.DataFrame:
    """Return planned pairs as rows of the torque table."""
    sizes = [len(one.bins) for one in pairs]

    def per_row(values: Sequence[float | None]) -> Array:
        return np.repeat(np.array([np.nan if one is None else one for one in values], float), sizes)

    motor = per_row([one.motor for one in pairs])
    speed = per_row([one.speed for one in pairs])
    housing = np.full_like(motor, np.nan)
    if joint.thermal_model is not None and joint.torques["housing_temperature"].notna().any():
        housing = joint.thermal_model.housing(motor)
    table = pd.DataFrame(
        {
            "run": run,
            "joint": joint.torques["joint"].iloc[0],
            "pair": np.repeat(np.arange(len(pairs)), sizes),
            "speed": speed,
            "time": per_row([one.time for one in pairs]),
            "phase": "sweep",
            "motor_temperature": motor,
            "housing_temperature": housing,
            "position": np.concatenate([np.empty(0), *(one.bins for one in pairs)]),
            "motor_temperature_reading": motor,
            "payload": per_row([one.payload for one in pairs]),
            "travel": per_row([one.travel for one in pairs]),
        }
    )
    load = form_of(joint.gravity).columns(table) @ joint.gravity
    friction = _friction(joint, speed, motor, load)
    load_channel = load if joint.torques["load"].notna().any() else np.nan
    rows = table.assign(load=load_channel, friction_torque=friction, load_torque=load)
    return rows[[*PLANNING_COLUMNS, "travel"]]


def append_run(observed: pd.DataFrame, new: pd.DataFrame) -> pd.DataFrame:
    """Return observed rows, as of ``planning_columns``, followed by those of a run."""
    return (
        pd.concat([observed, new[list(PLANNING_COLUMNS)]], ignore_index=True)
        if len(new)
        else observed
    )
