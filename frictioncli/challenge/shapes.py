"""Shapes of the planted laws, drawn to fit the speeds, temperatures, loads and angles of a log.

A law of the simulator is stated for a robot of its size: a bump of friction at 95 deg is none for a
joint that turns from 0 to 40 deg. So the ranges from which its shape is drawn follow from the log.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from zlib import crc32

import numpy as np
import pandas as pd

from frictioncli.challenge.log_state import LogState
from frictioncli.simulator.planted.catalogue import EFFECTS
from frictioncli.simulator.planted.effect import (
    Draw,
    PlantedEffect,
    log_uniform,
    uniform,
)

_STREAM = 3_000_000
"""Keeps these random numbers apart from those of simulated joints."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LogScale:
    """What a log spans.

    Attributes
    ----------
    speed : float
        Geometric mean of the lowest and the highest speed of its pairs. [deg/s]
    temperature : (float, float)
        Lowest and highest motor temperature of its pairs. [°C]
    load : float
        Root mean square of its load torque. [load unit]
    angle : (float, float)
        Lowest and highest angle of its pairs. [deg]
    bin_width : float
        Least distance of two angles of its pairs. [deg]
    duration : float
        Duration of all runs. [s]
    travel : float
        Angle turned in all runs. [deg]
    seen : float
        Share of that duration in the runs from which the diagnosis learns; a change takes place in
        them. [-]
    """

    speed: float
    temperature: tuple[float, float]
    load: float
    angle: tuple[float, float]
    bin_width: float
    duration: float
    travel: float
    seen: float = 1.0


def log_scale(torques: pd.DataFrame, states: Sequence[LogState], seen: Sequence[str]) -> LogScale:
    """Return what the log of a joint spans.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    states : sequence of LogState
        Its state in each run.
    seen : sequence of str
        Runs from which the diagnosis learns, which come first.
    """
    speed = torques["speed"].to_numpy(float)
    motor = np.concatenate([state.motor for state in states])
    angles = np.unique(torques["position"].to_numpy(float))
    steps = np.diff(angles)
    last = states[-1].operation
    return LogScale(
        speed=float(np.sqrt(speed.min() * speed.max())),
        temperature=(float(motor.min()), float(motor.max())),
        load=float(np.sqrt(np.mean(np.square(torques["load_torque"].to_numpy(float))))),
        angle=(float(angles[0]), float(angles[-1])),
        bin_width=float(steps[steps > 1e-6].min()) if np.any(steps > 1e-6) else 1.0,
        duration=last.earlier.total,
        travel=last.earlier.travelled + float(last.travel[-1]),
        seen=_share_seen(states, seen),
    )


def _share_seen(states: Sequence[LogState], seen: Sequence[str]) -> float:
    """Return the share of the duration of all runs before the first one that is not seen."""
    unseen = [state.operation.earlier for state in states if state.run.name not in seen]
    return min((one.operated / one.total for one in unseen), default=1.0)


def drawn_effect(name: str, scale: LogScale, seed: int) -> PlantedEffect:
    """Return an effect of magnitude 1 whose shape fits a log.

    Parameters
    ----------
    name : str
        Its name in :data:`frictioncli.simulator.planted.catalogue.EFFECTS`.
    scale : LogScale
        What the log spans.
    seed : int
        Source of the shape.

    Returns
    -------
    PlantedEffect
        The effect.
    """
    key = (_STREAM, crc32(name.encode()))
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
    effect = EFFECTS[name].draw(generator)
    fitted = {one: draw(generator) for one, draw in _draws(scale).get(name, {}).items()}
    return PlantedEffect(
        effect.definition, 1.0, {**effect.parameters, **fitted}, history=effect.history
    )


def _draws(scale: LogScale) -> Mapping[str, Mapping[str, Draw]]:
    """Return the parameters that depend on the log, and what they are drawn from, by effect."""
    low, high = scale.angle
    stroke = max(high - low, 1e-6)
    cold, hot = scale.temperature
    warming = max(hot - cold, 1e-6)
    turns, hours = scale.travel / 360.0, scale.duration / 3600.0
    # two periods in the stroke at least, and four bins in a period
    most = max(360.0 / (4.0 * scale.bin_width), 720.0 / stroke * 1.01)
    angle = uniform(low + 0.25 * stroke, low + 0.75 * stroke)
    warm = uniform(cold + 0.3 * warming, cold + 0.7 * warming)
    moment = uniform(0.2 * scale.seen, 0.8 * scale.seen)
    return {
        "stribeck": {"velocity": log_uniform(0.25 * scale.speed, 0.6 * scale.speed)},
        "velocity_exponent": {"crossing": log_uniform(0.5 * scale.speed, 2.0 * scale.speed)},
        "linear_viscous": {"rounding": uniform(0.1 * scale.speed, 0.25 * scale.speed)},
        "coulomb_temperature": {"reference": warm},
        "load_linear": {"rounding": uniform(0.1 * scale.load, 0.2 * scale.load)},
        "load_temperature": {
            "reference": warm,
            "width": uniform(0.3 * warming, 0.6 * warming),
        },
        "drift": {"time_constant": log_uniform(0.1 * hours, 0.4 * hours)},
        "run_in": {"turns": log_uniform(0.1 * turns, 0.6 * turns)},
        "rest_recovery": {"travel": log_uniform(0.5 * stroke, 4.0 * stroke)},
        "payload_change": {"moment": moment},
        "step_change": {
            "moment": moment,
            "duration": log_uniform(1e-4 * scale.duration, 0.005 * scale.duration),
        },
        "torque_constant": {"reference": uniform(cold, cold + 0.3 * warming)},
        "dress_pack": {
            "rest": uniform(low + 0.1 * stroke, low + 0.9 * stroke),
            "slack": uniform(0.2 * stroke / 180.0, 0.5 * stroke / 180.0),
        },
        "position_ripple": {"order": log_uniform(720.0 / stroke, min(most, 4500.0 / stroke))},
        "reversal_transient": {"travel": log_uniform(0.06 * stroke, 0.2 * stroke)},
        "speed_resonance": {"centre": log_uniform(0.6 * scale.speed, 1.7 * scale.speed)},
        "stroke_bump": {
            "centre": angle,
            "width": uniform(
                max(0.04 * stroke, scale.bin_width), max(0.1 * stroke, 2.0 * scale.bin_width)
            ),
        },
        "cooling_fan": {"period": uniform(0.06 * scale.duration, 0.2 * scale.duration)},
        "position_temperature": {"reference": warm},
        "temperature_band": {
            "centre": warm,
            "width": uniform(0.04 * warming, 0.1 * warming),
        },
        "moving_resonance": {"centre": log_uniform(0.7 * scale.speed, 1.4 * scale.speed)},
        "position_speed": {"crossing": log_uniform(0.6 * scale.speed, 1.7 * scale.speed)},
        "load_band": {
            "centre": uniform(0.4 * scale.load, 1.0 * scale.load),
            "width": uniform(0.1 * scale.load, 0.2 * scale.load),
        },
    }
