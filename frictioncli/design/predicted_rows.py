"""Rows of the table of torques that a programme would add."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.design.limits import bin_width
from frictioncli.design.steps import (
    ACCELERATION,
    LEAD,
    MOUNTING,
    HeatStep,
    RestStep,
    SeriesStep,
    Step,
    mountings,
    round_trip,
)
from frictioncli.design.thermal_model import ThermalModel
from frictioncli.diagnosis.data.gravity import columns_of, known_payload
from frictioncli.model.friction import FrictionParameters, friction_torque

_SETTLING = 0.2
"""Time after a ramp that is not yet constant speed. [s]"""

_COVERED = 0.6
"""Least share of a bin that must be passed at constant speed."""

_COLUMNS = (
    *("run", "joint", "pair", "speed", "time", "phase", "motor_temperature"),
    *("housing_temperature", "position", "motor_temperature_reading", "load", "payload"),
    *("friction_torque", "load_torque"),
)
"""Columns of the table that planning needs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedJoint:
    """What is known of the joint that a programme is planned for.

    Attributes
    ----------
    torques : DataFrame
        Rows at hand, of a single joint, as of :func:`plain`.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    parameters : FrictionParameters
        Friction of the base model.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of the gravity torque. [N·m], [N·m/kg]
    warmth : ThermalModel or None
        How its motor warms; None where its temperature is not known.
    """

    torques: pd.DataFrame
    temperature: str
    parameters: FrictionParameters
    gravity: Array
    warmth: ThermalModel | None

    @property
    def payload(self) -> float | None:
        """Payload that is on, as far as the last run tells [kg]."""
        known = known_payload(self.torques)
        return float(known[-1]) if len(known) and np.isfinite(known[-1]) else None


@dataclass(frozen=True, slots=True)
class Moment:
    """When a step begins, and how warm the motor is then and at its end.

    Attributes
    ----------
    start, end : float
        Since the programme's start, a change of payload before it included. [s]
    temperatures : (float, float)
        Motor temperature at its start and its end; NaN where unknown. [°C]
    """

    start: float
    end: float
    temperatures: tuple[float, float]


class _Pair(NamedTuple):
    """A pair to come: middle [s], speed, motor temperature, bins, payload, and way before [deg]."""

    time: float
    speed: float
    motor: float
    bins: Array
    payload: float | None
    way: float


def foreseen(
    joint: PlannedJoint, steps: Sequence[Step], run: str
) -> tuple[pd.DataFrame, tuple[Moment, ...]]:
    """Return the rows that steps would add as a run of their own, from a cold start, and when.

    Torques in them are those of the base model, without noise. Column ``way`` is the way before
    the pair, recorded or not. [deg]

    Parameters
    ----------
    joint : PlannedJoint
        The joint.
    steps : sequence of Step
        The programme.
    run : str
        Name of the run.
    """
    width = bin_width(joint.torques)
    warm = joint.warmth.ambient if joint.warmth else float("nan")
    now, way, payload = 0.0, 0.0, joint.payload
    pairs: list[_Pair] = []
    moments = []
    changes = mountings(steps, payload)
    for step, change in zip(steps, changes, strict=True):
        if change:
            warm, now = _warmer(joint, warm, MOUNTING, None), now + MOUNTING
        start, before = now, warm
        if isinstance(step, SeriesStep):
            payload = payload if step.payload is None else step.payload
            now, warm = now + LEAD, _warmer(joint, warm, LEAD, None)
            for speed in step.speeds:
                half = round_trip(speed, step.high - step.low) / 2
                middle = _warmer(joint, warm, half, speed)
                bins = constant_bins(speed, step.low, step.high, width)
                if len(bins):
                    pairs.append(_Pair(now + half, speed, middle, bins, payload, way))
                way += 2 * (step.high - step.low)
                now, warm = now + 2 * half, _warmer(joint, middle, half, speed)
        elif isinstance(step, HeatStep):
            spent, warm = _heated(joint, warm, step)
            now, way = now + spent, way + spent * step.speed
        elif isinstance(step, RestStep):
            now, warm = now + step.seconds, _warmer(joint, warm, step.seconds, None)
        moments.append(Moment(start, now, (before, warm)))
    return _table(joint, pairs, run), tuple(moments)


def constant_bins(speed: float, low: float, high: float, width: float) -> Array:
    """Return the centres of the angle bins that a move passes at constant speed [deg].

    Parameters
    ----------
    speed : float
        Speed of the move. [deg/s]
    low, high, width : float
        Its ends, and the width of the bins. [deg]
    """
    trimmed = speed**2 / (2 * ACCELERATION) + _SETTLING * speed
    edges = np.arange(np.floor(low / width), np.ceil(high / width)) * width
    passed = np.minimum(edges + width, high - trimmed) - np.maximum(edges, low + trimmed)
    return np.asarray(edges[passed >= _COVERED * width] + width / 2)


def _heated(joint: PlannedJoint, warm: float, step: HeatStep) -> tuple[float, float]:
    """Return how long heating moves last [s] and the motor temperature after them [°C]."""
    pace, spent = 60.0, 0.0
    while spent < step.seconds:
        if step.until is not None and warm >= step.until:
            break
        part = min(pace, step.seconds - spent)
        warm, spent = _warmer(joint, warm, part, step.speed), spent + part
    return spent, warm


def _warmer(joint: PlannedJoint, warm: float, seconds: float, speed: float | None) -> float:
    """Return the motor temperature after a time of rest or of moves at a speed [°C]."""
    if joint.warmth is None:
        return float("nan")
    power = 0.0
    if speed is not None:
        power = speed * float(_friction(joint, np.array(speed), np.array(warm), np.array(0.0)))
    return joint.warmth.after(warm, seconds, power)


def _friction(joint: PlannedJoint, speed: Array, warm: Array, load: Array) -> Array:
    """Return the base model's friction at motor temperatures. [N·m]."""
    used = warm
    if joint.temperature != "motor" and joint.warmth is not None:
        rise = {"housing": 1.0, "mean": 0.5}[joint.temperature]
        housing = joint.warmth.ambient + joint.warmth.housing_share * (warm - joint.warmth.ambient)
        used = warm + rise * (housing - warm)
    return friction_torque(
        joint.parameters, load=load, speed=speed, temperature=np.nan_to_num(used, nan=0.0)
    )


def _table(joint: PlannedJoint, pairs: Sequence[_Pair], run: str) -> pd.DataFrame:
    """Return pairs as rows of torques."""
    sizes = [len(one.bins) for one in pairs]

    def per_row(values: Sequence[float | None]) -> Array:
        return np.repeat(np.array([np.nan if one is None else one for one in values], float), sizes)

    motor = per_row([one.motor for one in pairs])
    speed = per_row([one.speed for one in pairs])
    housing = np.full_like(motor, np.nan)
    if joint.warmth is not None and joint.torques["housing_temperature"].notna().any():
        housing = joint.warmth.ambient + joint.warmth.housing_share * (motor - joint.warmth.ambient)
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
            "way": per_row([one.way for one in pairs]),
        }
    )
    load = columns_of(table, payloads=len(joint.gravity) > 3) @ joint.gravity
    friction = _friction(joint, speed, motor, load)
    own_load = load if joint.torques["load"].notna().any() else np.nan
    whole = table.assign(load=own_load, friction_torque=friction, load_torque=load)
    return whole[[*_COLUMNS, "way"]]


def plain(torques: pd.DataFrame) -> pd.DataFrame:
    """Return the columns of torques that planning needs, with plain text in place of labels."""
    return torques[list(_COLUMNS)].astype({"run": str, "phase": str}).reset_index(drop=True)


def together(known: pd.DataFrame, new: pd.DataFrame) -> pd.DataFrame:
    """Return the rows at hand, as of :func:`plain`, with those of a further run below them."""
    return pd.concat([known, new[list(_COLUMNS)]], ignore_index=True) if len(new) else known
