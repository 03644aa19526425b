"""Worlds of the planning study: thin experiments on joints that hide one effect."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.design.steps import PAYLOAD_CHANGE, HeatStep, SeriesStep, Step, payload_changes
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.motion_programme import MeasuredMoves, Motion, Standstill, UnrecordedMoves
from tests.studies.rows import sources_digest

PACKAGES = ("diagnosis", "effects", "design", "simulator", "model")
"""Packages that a result depends on."""

LOW, HIGH, FASTEST = 0.0, 180.0, 101.2

HIDDEN = (
    "run_in",
    "drift",
    "coulomb_temperature",
    "linear_viscous",
    "quadratic_drag",
    "velocity_exponent",
)
"""Effects that an experiment of heating alone mistakes for others: laws of time, way and
temperature, and laws of speed."""

SIZES = (2.5,)
"""RMS torque of the hidden effect in the thin experiment. [N·m]"""

DESIGNS = ("heating", "three speeds")
"""Thin experiments of one run: heating only, measured at four speeds or at three."""

BUDGETS = (45.0, 20.0)
"""Minutes that the next experiment may take."""

KEY = ("design", "hidden", "size", "seed", "minutes")


@dataclass(frozen=True)
class World:
    """One thin experiment on a joint that hides one effect, and the minutes for the next one."""

    design: str
    hidden: str
    size: float
    seed: int
    minutes: float

    @property
    def key(self) -> tuple[str, ...]:
        """What identifies it in the store."""
        return tuple(str(getattr(self, name)) for name in KEY)

    def settings(self) -> SynthesisSettings:
        """Return the joint: equation (16) and the hidden effect, noise by the world's own seed.

        The joint is the same whatever the minutes.
        """
        digest = hashlib.sha256(" ".join(self.key[:-1]).encode()).digest()
        return SynthesisSettings(
            seed=int.from_bytes(digest[:4], "big"),
            joint_kind="plain",
            effects=(f"{self.hidden}:{self.size}",),
        )


def worlds(seeds: int) -> list[World]:
    """Return the worlds of so many seeds, in a fixed random order."""
    found = []
    for seed in range(seeds):
        block = [
            World(design, hidden, size, seed, minutes)
            for design in DESIGNS
            for hidden in HIDDEN
            for size in SIZES
            for minutes in BUDGETS
        ]
        order = np.random.default_rng([2019, seed]).permutation(len(block))
        found += [block[place] for place in order]
    return found


def thin(design: str) -> list[Motion]:
    """Return the motions of a thin experiment."""
    heat = UnrecordedMoves(speed=FASTEST, low=LOW, high=HIGH, seconds=180.0)
    if design == "heating":
        one = _series(19.1, 39.4, 67.5, FASTEST)
        return [act for _ in range(12) for act in (one, heat)]
    if design == "three speeds":
        one = _series(20.0, 60.0, FASTEST)
        return [act for _ in range(8) for act in (one, heat, heat)]
    raise ValueError(design)


def _series(*speeds: float) -> MeasuredMoves:
    return MeasuredMoves(speeds=speeds, low=LOW, high=HIGH)


def acts_of(steps: Sequence[Step]) -> list[Motion]:
    """Return what the simulator is to do for the steps of a plan."""
    found: list[Motion] = []
    for step, change in zip(steps, payload_changes(steps, None), strict=True):
        if change:
            found.append(Standstill(PAYLOAD_CHANGE))
        if isinstance(step, SeriesStep):
            found.append(
                MeasuredMoves(
                    speeds=step.speeds, low=step.low, high=step.high, more=step.payload or 0.0
                )
            )
        elif isinstance(step, HeatStep):
            found.append(
                UnrecordedMoves(
                    speed=step.speed,
                    low=step.low,
                    high=step.high,
                    seconds=step.seconds,
                    until=step.until,
                )
            )
        else:
            found.append(Standstill(step.seconds))
    return found


def seconds_of(act: Motion) -> float:
    """Return about how long a motion takes [s]."""
    if isinstance(act, MeasuredMoves):
        return sum(2 * (act.high - act.low) / speed + 2.0 for speed in act.speeds)
    return act.seconds


def beginning(acts: Sequence[Motion], seconds: float) -> list[Motion]:
    """Return motions, begun again where they end, that fit into a time [s]."""
    found: list[Motion] = []
    left, place = seconds, 0
    while seconds_of(acts[place % len(acts)]) <= left:
        found.append(acts[place % len(acts)])
        left -= seconds_of(found[-1])
        place += 1
    return found


def sources() -> str:
    """Return a digest of the sources that the results depend on."""
    return sources_digest(*(f"frictioncli/{package}" for package in PACKAGES), "tests/simulation")
