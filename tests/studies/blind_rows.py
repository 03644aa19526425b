"""Rows of the blind study as joints with what is true and what is said of each, and shares."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from tests.studies.blind_examined import DOCUMENTS, FAILED, NOT_PLANTED, NUMBERS
from tests.studies.blind_worlds import LAG, MEASUREMENT, World

NOWHERE = 0.01
"""An effect that is no larger in the runs seen, as one of the second day, is not there. [N·m]"""


@dataclass(frozen=True)
class Joint:
    """A row: one joint, what is true of it and what is said of it.

    Attributes
    ----------
    world : World
        The joint.
    verdict, note : str
        The verdict, or why there is none; the message where there is one.
    hidden : list of dict
        Effects that are hidden in it: name, raw and left size [N·m].
    nuisances : dict
        True values of its nuisances, by name.
    causes, visible : list of dict
        Causes, and what else stands out, as in ``diagnosis.json``.
    structure : dict or None
        Structure without a name.
    parameters : dict
        Estimate and interval of the base's parameters.
    detectable, without_discrepancy : dict
        Sizes that would be found [N·m], where nothing is hidden; and without the discrepancy.
    numbers : dict
        Numbers of the row, NaN where there are none.
    """

    world: World
    verdict: str
    note: str
    hidden: list[dict[str, Any]]
    nuisances: dict[str, dict[str, float]]
    causes: list[dict[str, Any]]
    visible: list[dict[str, Any]]
    structure: dict[str, Any] | None
    parameters: dict[str, list[float | None]]
    detectable: dict[str, float | None]
    without_discrepancy: dict[str, float | None]
    numbers: dict[str, float]

    @property
    def judged(self) -> bool:
        """Whether the joint could be made and the program did not break down."""
        return self.verdict not in (NOT_PLANTED, FAILED)

    @property
    def margin(self) -> float:
        """Smallest size worth a name. [N·m]"""
        return self.numbers["margin"]

    @cached_property
    def sets(self) -> list[list[str]]:
        """Credible sets of the causes that are named, those of the measurement apart."""
        return [one["effects"] for one in self.causes if not _of_measurement(one)]

    @cached_property
    def findings(self) -> list[list[str]]:
        """Credible sets of what is found of the measurement."""
        return [one["effects"] for one in self.causes if _of_measurement(one)]

    @property
    def names(self) -> tuple[str, ...]:
        """Effects that are hidden."""
        return tuple(one["name"] for one in self.hidden)

    @cached_property
    def true_names(self) -> set[str]:
        """Effects of the catalogue that are truly there, hidden or not."""
        network = {LAG} if self.world.kind in ("network", "moved_heat", "zones") else set()
        return {*self.names, *self.nuisances} | network

    @property
    def shows(self) -> bool:
        """Whether the base leaves the margin or more of every effect that is hidden."""
        return all(one["left"] >= self.margin for one in self.hidden)

    @property
    def possible(self) -> bool:
        """Whether anything of every effect that is hidden falls into the runs seen."""
        return all(one["raw"] > NOWHERE for one in self.hidden)

    @cached_property
    def held(self) -> bool:
        """Whether every effect that is hidden is in a set."""
        return all(any(name in one for one in self.sets) for name in self.names)

    @cached_property
    def alone(self) -> bool:
        """Whether every effect that is hidden is named alone."""
        return all([name] in self.sets for name in self.names)

    @cached_property
    def wrong(self) -> list[list[str]]:
        """Sets, those of the measurement too, that hold nothing that is truly there."""
        return [one for one in (*self.sets, *self.findings) if not self.true_names & set(one)]

    @property
    def causes_alone(self) -> float:
        """RMS misfit on the day kept out of base and causes. [N·m]"""
        after = self.numbers["after"]
        return self.numbers["before"] if np.isnan(after) else after

    @property
    def after(self) -> float:
        """RMS misfit on the day kept out of all that the program hands out. [N·m]"""
        after = self.numbers["with_term"]
        return self.causes_alone if np.isnan(after) else after

    @property
    def over_floor(self) -> float:
        """That over the noise of that day."""
        return self.after / self.numbers["floor"]


def _of_measurement(cause: Mapping[str, Any]) -> bool:
    return cause.get("kind") == "measurement" or set(cause["effects"]) <= set(MEASUREMENT)


def joints_of(rows: pd.DataFrame) -> list[Joint]:
    """Return the joints of rows as the store has them, in the order of their keys."""
    return [joint_of(row) for row in rows.to_dict("records")]


def joint_of(row: Mapping[Any, str]) -> Joint:
    """Return the joint of a row of texts."""
    empty: Mapping[str, Any] = {"hidden": [], "causes": [], "visible": [], "structure": None}
    found = {
        name: json.loads(row[f"{name}_json"]) if row[f"{name}_json"] else empty.get(name, {})
        for name in DOCUMENTS
    }
    world = World(
        kind=row["kind"],
        hidden=row["hidden"],
        seed=int(row["seed"]),
        size=float(row["size"]),
        history=row["history"],
        protocol=row["protocol"],
        noise=row["noise"],
        path=row["path"],
    )
    numbers = {name: float(row[name]) if row[name] else float("nan") for name in NUMBERS}
    return Joint(world=world, verdict=row["verdict"], note=row["note"], numbers=numbers, **found)


def of_kind(joints: Iterable[Joint], *kinds: str) -> list[Joint]:
    """Return the joints of some kinds that can be judged."""
    return [one for one in joints if one.judged and one.world.kind in kinds]


def interval(count: int, total: int, level: float = 0.95) -> tuple[float, float]:
    """Return the Clopper-Pearson interval of a share."""
    tail = (1.0 - level) / 2.0
    low = stats.beta.ppf(tail, count, total - count + 1) if count else 0.0
    high = stats.beta.isf(tail, count + 1, total - count) if count < total else 1.0
    return float(low), float(high)


def share(values: Iterable[object]) -> str:
    """Return a share in percent with its count and its 95 % interval; empty without values."""
    flags = np.array(list(values), dtype=bool)
    if not flags.size:
        return ""
    count, total = int(flags.sum()), int(flags.size)
    low, high = interval(count, total)
    return f"{count / total:.0%} ({count}/{total}) [{low:.0%}, {high:.0%}]"


def percent(values: Iterable[object]) -> str:
    """Return a bare share in percent; a dash without values."""
    flags = np.array(list(values), dtype=bool)
    return f"{flags.mean():.0%}" if flags.size else "–"


def median_interval(values: Iterable[float]) -> tuple[float, float, float]:
    """Return the median with its 95 % interval from order statistics."""
    ordered = np.sort(np.array(list(values), dtype=float))
    count = len(ordered)
    low = int(stats.binom.ppf(0.025, count, 0.5))
    high = count - 1 - low
    return float(np.median(ordered)), float(ordered[low]), float(ordered[max(high, low)])


def text_of(sets: Iterable[Iterable[str]]) -> str:
    """Return credible sets in words: ``a + b or c``."""
    return " + ".join(" or ".join(one) for one in sets)
