"""The worlds of the blind study, in an order that stays balanced wherever it is cut short."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from frictioncli.simulator.settings import NOISE_KINDS, PROTOCOLS, SynthesisSettings
from tests.studies.effect_names import EFFECT_NAMES
from tests.studies.rows import sources_digest

PACKAGES = ("diagnosis", "effects", "simulator", "model")
"""Packages that a result depends on."""

SIZES = (0.25, 0.5, 1.0, 2.0, 4.0)
"""RMS torque of a single hidden effect. [N·m]"""

UNLISTED = (
    "speed_resonance",
    "stroke_bump",
    "cooling_fan",
    "position_temperature",
    "lifting_loss",
)
"""Effects that can be hidden and that no catalogue lists."""

LAG = "thermal_lag"
KINDS = ("clean", "single", "pair", "unlisted")
KEY = ("kind", "noise", "protocol", "hidden", "size", "seed")

_SHUFFLE = 20190


@dataclass(frozen=True)
class World:
    """One hidden experiment: what is planted, under which noise and programme.

    Attributes
    ----------
    kind : {"clean", "single", "pair", "unlisted"}
        What is asked of it.
    noise, protocol : str
        As of :class:`SynthesisSettings`.
    hidden : str
        Names of the effects, joined by ``+``; empty where nothing is hidden.
    size : float
        RMS torque of each. [N·m]
    seed : int
        Number of the repetition.
    """

    kind: str
    noise: str
    protocol: str
    hidden: str
    size: float
    seed: int

    @property
    def key(self) -> tuple[str, ...]:
        """What identifies the world in the store."""
        return tuple(str(getattr(self, name)) for name in KEY)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of what is hidden."""
        return tuple(name for name in self.hidden.split("+") if name)

    def settings(self, hidden: Iterable[str]) -> SynthesisSettings:
        """Return what to simulate with some of what is hidden; the noise is always the same.

        Every world has a seed of its own, which gives it its noise and the shapes of its effects.
        """
        digest = hashlib.sha256(" ".join(self.key).encode()).digest()
        return SynthesisSettings(
            seed=int.from_bytes(digest[:4], "big"),
            joint_kind="plain",
            noise_kind=self.noise,
            protocol=self.protocol,
            effects=tuple(f"{name}:{self.size}" for name in hidden),
        )


def worlds(seeds: int) -> list[World]:
    """Return the worlds of so many seeds: seed after seed, each in a fixed random order."""
    found = []
    for seed in range(seeds):
        block = [world for protocol in PROTOCOLS for world in _of(protocol, seed)]
        order = np.random.default_rng([_SHUFFLE, seed]).permutation(len(block))
        found += [block[place] for place in order]
    return found


def _of(protocol: str, seed: int) -> list[World]:
    others = [name for name in EFFECT_NAMES if name != LAG]
    return [
        *(World("clean", noise, protocol, "", 0.0, seed) for noise in NOISE_KINDS),
        *(
            World("single", "default", protocol, name, size, seed)
            for name in EFFECT_NAMES
            for size in SIZES
        ),
        *(World("pair", "default", protocol, f"{LAG}+{name}", 1.0, seed) for name in others),
        *(World("unlisted", "default", protocol, name, 1.0, seed) for name in UNLISTED),
    ]


def sources() -> str:
    """Return a digest of the sources that the results depend on."""
    return sources_digest(*(f"frictioncli/{package}" for package in PACKAGES), "tests/simulation")
