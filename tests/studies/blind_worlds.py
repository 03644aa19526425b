"""The joints of the blind study, in an order that stays balanced wherever it is cut short."""

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import cycle, islice

import numpy as np

from frictioncli.effects import EFFECTS, MEASUREMENT_EFFECTS
from frictioncli.simulator.planted.unlisted import UNLISTED_EFFECTS
from frictioncli.simulator.settings import NOISE_KINDS, SynthesisSettings
from tests.studies.rows import sources_digest

PACKAGES = ("diagnosis", "effects", "simulator", "model", "pairs")
"""Packages that a result depends on."""

ROUNDS = 10
"""Joints of each case in the whole plan."""

CLEAN = 20
"""Joints with nothing hidden, in each round."""

SIZES = (0.5, 1.0, 2.0)
"""RMS torque of a single hidden effect; most have 1. [N·m]"""

LISTED = tuple(effect.name for effect in EFFECTS)
"""Effects of the catalogue that are properties of a joint."""

MEASUREMENT = tuple(one.name for one in MEASUREMENT_EFFECTS)
"""Effects of the catalogue that are properties of a log."""

UNLISTED = tuple(effect.name for effect in UNLISTED_EFFECTS)
"""Effects that can be hidden and that no catalogue lists."""

CHANGE_SIZE = 2.0
"""RMS torque of a change while it is there. [N·m]"""

CHANGES = ("payload_change", "step_change")
HISTORIES = ("recurring", "vanishing", "lasting")

LAG = "thermal_lag"

ORDINARY: Mapping[str, tuple[str, ...]] = {
    "gravity_constant": ("gravity_constant:{constant}",),
    "torque_delay": ("torque_delay:0.012",),
    "torque_filter": ("torque_filter:0.04",),
    "all_three": ("gravity_constant:{constant}", "torque_delay:0.012", "torque_filter:0.04"),
}
"""Joints that do one ordinary thing and nothing else: their nuisances."""

NUISANCES = ("all", "friction_zones:0.02")
"""Nuisances of a joint that has all. Zones that differ more than so leave more than the margin,
nine tenths of which is another exponent of the speed: that is no nuisance, but a cause."""

CONSTANTS = (2.0, 4.0)
"""Range of the constant of gravity in these. [N·m]"""

TWELVE = "12 pairs"
"""A joint with nothing hidden of which so many pairs are known."""

ZONES = ("stribeck", "coulomb_temperature", "load_linear", "dress_pack", "inertia", "drift")
"""Effects hidden in the sample joint, whose friction has three zones."""

CONSTANT_HEAT = (0.5,)
"""Share of the heat that enters at the motor in a network with constant coefficients. [-]"""

MOVED_HEAT = SynthesisSettings().motor_heat_share
"""The same on each day of all other joints. [-]"""

KINDS = (
    *("clean", "single", "pair", "unlisted", "change", "network", "ordinary", "zones"),
    "moved_heat",
)
KEY = ("kind", "hidden", "size", "history", "protocol", "noise", "path", "seed")

_ENRICHED = 4
"""Every so many-th joint of a kind has the enriched programme."""

_LOGS = 10
"""Every so many-th joint goes through the whole chain, logs included."""

_JOINTS = {"network": "network", "moved_heat": "network", "zones": "zones"}
"""Simulated joints of the kinds whose friction is not at the motor's temperature."""

_SHUFFLE = 20190


@dataclass(frozen=True)
class World:
    """One hidden experiment: what is planted, under which noise and programme.

    Attributes
    ----------
    kind : str
        One of :data:`KINDS`: what is asked of it.
    hidden : str
        Names of the effects, joined by ``+``; empty where nothing is hidden. What is ordinary
        where the kind is ``ordinary``.
    seed : int
        Number of the repetition.
    size : float
        RMS torque of each effect. [N·m]
    history : str
        When a change is there; empty where nothing changes.
    protocol, noise : str
        As of :class:`SynthesisSettings`.
    path : {"bins", "logs"}
        Whether torques are simulated per angle bin, or in logs that go through the whole chain.
    """

    kind: str
    hidden: str
    seed: int
    size: float = 1.0
    history: str = ""
    protocol: str = "paper"
    noise: str = "default"
    path: str = "bins"

    @property
    def key(self) -> tuple[str, ...]:
        """What identifies the world in the store."""
        return tuple(str(getattr(self, name)) for name in KEY)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects that are hidden."""
        if self.kind == "ordinary":
            return ()
        return tuple(name for name in self.hidden.split("+") if name)

    @property
    def nuisances(self) -> tuple[str, ...]:
        """Nuisances of the joint and of its log."""
        if self.kind == "zones":
            return ()
        if self.kind != "ordinary":
            return NUISANCES
        low, high = CONSTANTS
        constant = low + (high - low) * (self.seed % ROUNDS) / (ROUNDS - 1)
        return tuple(one.format(constant=constant) for one in ORDINARY.get(self.hidden, ()))

    def settings(self, hidden: Iterable[str], noise_scale: float = 1.0) -> SynthesisSettings:
        """Return what to simulate with some of what is hidden; the noise is always the same.

        Every world has a seed of its own, which gives it its noise and the shapes of its effects.
        Torques per bin and logs of a world have the same shapes.
        """
        own = [value for name, value in zip(KEY, self.key, strict=True) if name != "path"]
        digest = hashlib.sha256(" ".join(own).encode()).digest()
        return SynthesisSettings(
            seed=int.from_bytes(digest[:4], "big"),
            joint_kind=_JOINTS.get(self.kind, "plain"),
            motor_heat_share=CONSTANT_HEAT if self.kind == "network" else MOVED_HEAT,
            noise_kind=self.noise,
            noise_scale=noise_scale,
            protocol=self.protocol,
            nuisances=self.nuisances,
            effects=tuple(self._request(name) for name in hidden),
        )

    def _request(self, name: str) -> str:
        history = f"@{self.history}" if self.history else ""
        return f"{name}{history}:{self.size}"


def plan(rounds: int = ROUNDS) -> list[World]:
    """Return the joints of so many rounds; each round spreads its kinds evenly."""
    found: list[World] = []
    for seed in range(rounds):
        generator = np.random.default_rng([_SHUFFLE, seed])
        places: list[tuple[float, World]] = []
        for kind in KINDS:
            worlds = _MAKERS[kind](seed)
            begin = generator.random()
            for place, number in enumerate(generator.permutation(len(worlds))):
                places.append(((place + begin) / len(worlds), worlds[number]))
        found += [world for _, world in sorted(places, key=lambda one: one[0])]
    return [_through_logs(world) if n % _LOGS == 0 else world for n, world in enumerate(found)]


def _through_logs(world: World) -> World:
    return World(**vars(world) | {"path": "logs"}) if world.hidden != TWELVE else world


def _clean(seed: int) -> list[World]:
    kinds = ["default"] * (CLEAN - 2 * (len(NOISE_KINDS) - 1))
    kinds += list(islice(cycle(kind for kind in NOISE_KINDS if kind != "default"), CLEAN))
    return [
        World("clean", "", CLEAN * seed + n, 0.0, noise=kind, protocol=_protocol(n, seed))
        for n, kind in enumerate(kinds[:CLEAN])
    ]


def _single(seed: int) -> list[World]:
    found = [
        World("single", name, seed, protocol=_protocol(n, seed)) for n, name in enumerate(LISTED)
    ]
    # every effect has each of the other sizes in two of ten rounds
    for n, name in enumerate(LISTED):
        size = {0: 0.5, 1: 2.0}.get((n + seed) % 5)
        if size:
            found.append(World("single", name, seed, size, protocol=_protocol(n, seed)))
    return found


def _pair(seed: int) -> list[World]:
    others = [name for name in LISTED if name != LAG]
    return [
        World("pair", f"{LAG}+{name}", seed, protocol=_protocol(n, seed))
        for n, name in enumerate(others)
    ]


def _unlisted(seed: int) -> list[World]:
    return [
        World("unlisted", name, seed, protocol=_protocol(n, seed))
        for n, name in enumerate(UNLISTED)
    ]


def _change(seed: int) -> list[World]:
    return [
        World("change", name, seed, CHANGE_SIZE, history=history)
        for name in CHANGES
        for history in HISTORIES
    ]


def _network(seed: int) -> list[World]:
    return [World("network", "", seed, 0.0)]


def _moved_heat(seed: int) -> list[World]:
    return [
        World("moved_heat", "", seed, 0.0, protocol=protocol) for protocol in ("paper", "enriched")
    ]


def _ordinary(seed: int) -> list[World]:
    return [World("ordinary", name, seed, 0.0) for name in (*ORDINARY, TWELVE)]


def _zones(seed: int) -> list[World]:
    chosen = [ZONES[(2 * seed + n) % len(ZONES)] for n in range(2)]
    return [World("zones", name, seed) for name in chosen]


_MAKERS: Mapping[str, Callable[[int], list[World]]] = {
    "clean": _clean,
    "single": _single,
    "pair": _pair,
    "unlisted": _unlisted,
    "change": _change,
    "network": _network,
    "moved_heat": _moved_heat,
    "ordinary": _ordinary,
    "zones": _zones,
}


def _protocol(number: int, seed: int) -> str:
    return "enriched" if (number + seed) % _ENRICHED == 0 else "paper"


def sources() -> str:
    """Return a digest of the sources that the results depend on."""
    return sources_digest(*(f"frictioncli/{package}" for package in PACKAGES), "tests/simulation")
