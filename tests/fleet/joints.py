"""Short logs of joints whose friction is known, written by formulas of the tests' own."""

from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np

from tests.equation_16 import friction, write_recording
from tests.moves import move_sequence

SPEEDS = (20.0, 45.0, 90.0)
"""Speeds of each recording. [deg/s]"""

STROKE = 50.0
"""Half the stroke. [deg]"""

_BEGIN = datetime(2024, 1, 8, 8)
_PAUSE = timedelta(minutes=12)
_LAG = 3600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """What a joint is like.

    Attributes
    ----------
    seed : int
        Of its parameters and noise.
    runs : int
        Days of measurements.
    cycle : int
        Recordings of each, half of them while it warms from 25 to 45 °C.
    wear : float
        Friction that the last run has beyond the others. [N·m]
    lags : bool
        Whether friction follows a gear that is an hour behind the motor.
    day_to_day : float
        Standard deviation of an offset that each run has. [N·m]
    period : float
        Time between samples. [s]
    """

    seed: int
    runs: int = 3
    cycle: int = 12
    wear: float = 0.0
    lags: bool = False
    day_to_day: float = 0.0
    period: float = 0.036

    @property
    def parameters(self) -> dict[str, float]:
        """The five parameters of equation (16)."""
        draw = np.random.default_rng(self.seed).uniform
        return {
            "tau_c": draw(8, 14),
            "alpha": draw(0.0008, 0.002),
            "beta": draw(2, 5),
            "gamma": draw(10, 18),
            "delta": draw(0.03, 0.06),
        }


def write_joint(folder, joint, *, axis=2):
    """Write the runs of a joint as ``folder/run=D`` with a manifest each."""
    turns = [-STROKE, *[STROKE, -STROKE] * len(SPEEDS)]
    motion = move_sequence(turns, np.repeat(SPEEDS, 2), period=joint.period)
    direction = np.sign(motion["velocity"].to_numpy())
    speed = np.repeat(SPEEDS, 2)[_move_of(motion)]
    load = 80 * np.cos(np.radians(motion["position"].to_numpy()))
    inertia = 5 * np.radians(motion["acceleration"].to_numpy())
    generator = np.random.default_rng([joint.seed, 1])
    for number in range(joint.runs):
        began = _BEGIN + timedelta(days=7 * number)
        place = folder / f"run={began:%Y-%m-%d}"
        place.mkdir(parents=True)
        offset = joint.day_to_day * generator.standard_normal()
        offset += joint.wear if number == joint.runs - 1 else 0.0
        warmth = _warmth(joint.cycle)
        felt = _lagging(warmth) if joint.lags else warmth
        started = []
        for part, (shown, true) in enumerate(zip(warmth, felt, strict=True)):
            own = friction(joint.parameters, load=load, speed=speed, temperature=true) + offset
            # what a pair shares, and what a sample has for itself
            own = own + 0.15 * generator.standard_normal(len(SPEEDS))[_move_of(motion) // 2]
            torque = load + direction * own + inertia
            torque = torque + 0.4 * generator.standard_normal(len(torque))
            warm = {f"Motortemperatur{axis}[°C]": round(shown, 2)}
            name = f"{part:03d}.csv"
            write_recording(place / name, motion, torque, axis=axis, **warm)
            started.append(f"{name};{(began + part * _PAUSE).isoformat()}")
        text = "\n".join(["file;started_at", *started])
        (place / "manifest.csv").write_text(text, encoding="utf-8")


def _warmth(cycle):
    half = np.linspace(25.0, 45.0, cycle // 2)
    return np.concatenate([half, half[::-1]])


def _lagging(warmth):
    found, share = [warmth[0]], 1 - np.exp(-_PAUSE.total_seconds() / _LAG)
    for value in warmth[1:]:
        found.append(found[-1] + share * (value - found[-1]))
    return np.array(found)


def _move_of(motion):
    """Return the number of the move that each sample belongs to."""
    moving = motion["velocity"].to_numpy() != 0
    begins = moving & ~np.concatenate([[False], moving[:-1]])
    return np.clip(np.cumsum(begins) - 1, 0, None)
