"""One simulated joint as the methods of the comparison see it, and the library they choose from.

The library holds the catalogue's columns, each effect at the shape that explains most of the
misfit, off the span of the base's derivatives: what the base could take itself is no finding.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects import EFFECTS
from frictioncli.effects.base import Effect, applicable

Mask = NDArray[np.bool_]

WORTHWHILE, SLIGHT = 0.03, 0.002
"""Gates of ``diagnose``: share of a channel's misfit on the new run, share of the friction."""

_VISIBLE = 1e-3
"""A column of which the base leaves less than this share is not in the library."""


@dataclass(frozen=True, slots=True)
class Joint:
    """One simulated joint: what may be seen, and the run kept for the gain."""

    torques: pd.DataFrame
    seen: Problem
    new: Problem
    seed: int

    @classmethod
    def of(cls, torques: pd.DataFrame, seed: int) -> "Joint":
        """Return the joint of a table of torques, its last run kept out."""
        seen, new = build_problems(torques, "motor", str(max(torques["run"].unique())))
        assert new is not None
        return cls(torques, seen, new, seed)


@dataclass(frozen=True, slots=True)
class Finding:
    """What is said of a joint.

    Attributes
    ----------
    found : bool
        Whether it is said that the base model misses anything.
    claims : tuple of tuple of str
        Causes claimed, each a set of effects one of which it is.
    gain : float
        Share of the RMS misfit on the new run that the extension takes away; 0 without one.
    """

    found: bool
    claims: tuple[tuple[str, ...], ...] = ()
    gain: float = 0.0


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a method says of a joint as it is, and what passes the gates of ``diagnose``."""

    plain: Finding
    gated: Finding


NOTHING = Outcome(Finding(False), Finding(False))


@dataclass(frozen=True, slots=True)
class Entry:
    """One effect in the library.

    Attributes
    ----------
    effect : Effect
        The effect.
    shape : dict of str to float
        The shape of the catalogue's grid at which it explains most.
    columns : ndarray, shape (2 * rows, coefficients)
        Its columns at the rows seen, friction above load, off the base. [N·m]
    explained : float
        Sum of squares that they explain. [(N·m)²]
    freedom : int
        Number of independent columns.
    """

    effect: Effect
    shape: dict[str, float]
    columns: Array
    explained: float
    freedom: int


def base_columns(problem: Problem) -> Array:
    """Return the derivatives of both channels by the base's parameters, shape (2 * rows, ...)."""
    friction, load = problem.friction_base, problem.load_base
    return np.block(
        [
            [friction, np.zeros((len(friction), load.shape[1]))],
            [np.zeros((len(load), friction.shape[1])), load],
        ]
    )


def misfit_of(problem: Problem) -> Array:
    """Return the misfit of both channels, friction above load. [N·m]."""
    return np.concatenate([problem.friction_misfit, problem.load_misfit])


def off_base(problem: Problem, columns: Array) -> Array:
    """Return what the base leaves of columns; those of which it leaves next to nothing are zero."""
    base = base_columns(problem)
    orthogonal = np.linalg.qr(base / np.linalg.norm(base, axis=0))[0]
    left = columns - orthogonal @ (orthogonal.T @ columns)
    nothing = np.linalg.norm(left, axis=0) < _VISIBLE * np.linalg.norm(columns, axis=0)
    left[:, nothing] = 0.0
    return left


def library(problem: Problem) -> list[Entry]:
    """Return the catalogue's effects that the data can be asked about, each at its best shape."""
    misfit = off_base(problem, misfit_of(problem)[:, np.newaxis])[:, 0]
    return [_entry(effect, problem, misfit) for effect in applicable(EFFECTS, problem.table)]


def _entry(effect: Effect, problem: Problem, misfit: Array) -> Entry:
    axes = [[(one.name, float(value)) for value in one.grid()] for one in effect.shape]
    shapes = [dict(values) for values in product(*axes)]
    bases = [np.concatenate(problem.basis(effect, shape)) for shape in shapes]
    left = np.split(off_base(problem, np.hstack(bases)), len(shapes), axis=1)
    tried = [_explained(columns, misfit) for columns in left]
    best = int(np.argmax([explained for explained, _ in tried]))
    return Entry(effect, shapes[best], left[best], *tried[best])


def visible_columns(entry: Entry) -> Mask:
    """Return which of an effect's columns the base leaves anything of."""
    return np.any(entry.columns != 0, axis=0)


def _explained(columns: Array, misfit: Array) -> tuple[float, int]:
    size = np.linalg.norm(columns, axis=0)
    scaled = columns[:, size > 0] / size[size > 0]
    if not scaled.size:
        return 0.0, 0
    coefficients, _, rank, _ = np.linalg.lstsq(scaled, misfit, rcond=1e-6)
    return float(np.sum(np.square(scaled @ coefficients))), int(rank)


def extended(joint: Joint, kept: Sequence[tuple[Entry, Mask]]) -> Outcome:
    """Return the outcome of keeping columns of the library: base and columns are refitted."""
    if not kept:
        return NOTHING
    fit = _Fit.of(joint, kept)
    every = list(range(len(kept)))
    names = [entry.effect.name for entry, _ in kept]
    plain = fit.finding(joint, every, names)
    return Outcome(plain, fit.finding(joint, _worthwhile(joint, kept, fit), names))


def _worthwhile(joint: Joint, kept: Sequence[tuple[Entry, Mask]], fit: "_Fit") -> list[int]:
    """Return which effects pass the gates; the least is dropped and the others are refitted."""
    visible = [entry.columns[:, mask] for entry, mask in kept]
    slight = SLIGHT * float(np.mean(np.abs(joint.seen.friction)))
    halves = [0 if entry.effect.channel == "friction" else 1 for entry, _ in kept]
    through = list(range(len(kept)))
    while through:
        sizes = fit.sizes(through, visible)
        if min(sizes) < slight:
            through.pop(int(np.argmin(sizes)))
            continue
        whole = np.split(fit.left(through), 2)
        costs = []
        for i in through:
            without = np.split(fit.left([j for j in through if j != i]), 2)
            costs.append(reduction(without[halves[i]], whole[halves[i]]))
        if min(costs) >= WORTHWHILE:
            break
        through.pop(int(np.argmin(costs)))
    return through


@dataclass(frozen=True, slots=True)
class _Fit:
    """The base's columns and kept ones, at the rows seen and at the new ones."""

    seen: Array
    new: Array
    owner: NDArray[np.intp]
    targets: tuple[Array, Array]

    @classmethod
    def of(cls, joint: Joint, kept: Sequence[tuple[Entry, Mask]]) -> "_Fit":
        seen, new = (
            np.hstack(
                [
                    base_columns(problem),
                    *(
                        np.concatenate(problem.basis(entry.effect, entry.shape))[:, mask]
                        for entry, mask in kept
                    ),
                ]
            )
            for problem in (joint.seen, joint.new)
        )
        counts = [int(mask.sum()) for _, mask in kept]
        base = seen.shape[1] - sum(counts)
        owner = np.concatenate([np.full(base, -1), np.repeat(np.arange(len(kept)), counts)])
        return cls(seen, new, owner, (misfit_of(joint.seen), misfit_of(joint.new)))

    def coefficients(self, through: Sequence[int]) -> Array:
        """Return the coefficients with some of the effects; those of the others are 0."""
        used = np.isin(self.owner, [-1, *through])
        size = np.linalg.norm(self.seen[:, used], axis=0)
        found = np.zeros(len(used))
        scaled = self.seen[:, used] / size
        found[used] = np.linalg.lstsq(scaled, self.targets[0], rcond=1e-9)[0] / size
        return found

    def sizes(self, through: Sequence[int], visible: Sequence[Array]) -> list[float]:
        """Return the RMS torque of each effect by its columns off the base. [N·m]."""
        found = self.coefficients(through)
        torques = [visible[i] @ found[self.owner == i] for i in through]
        return [float(np.linalg.norm(one) / np.sqrt(len(one) / 2)) for one in torques]

    def left(self, through: Sequence[int]) -> Array:
        """Return what base and some of the effects leave on the new run. [N·m]."""
        return self.targets[1] - self.new @ self.coefficients(through)

    def finding(self, joint: Joint, through: Sequence[int], names: Sequence[str]) -> Finding:
        """Return the finding of some of the effects."""
        if not through:
            return Finding(False)
        gain = reduction(misfit_of(joint.new), self.left(through))
        return Finding(True, tuple((names[i],) for i in through), gain)


def predicted(joint: Joint, added: Array, after: Array) -> Outcome:
    """Return the outcome of a model that has no causes, which passes the gates as a whole.

    Parameters
    ----------
    joint : Joint
        The joint.
    added : ndarray, shape (2 * any rows,)
        What it adds on rows of the run seen, friction above load. [N·m]
    after : ndarray, shape (2 * new rows,)
        What it leaves on the new run. [N·m]
    """
    before = misfit_of(joint.new)
    plain = Finding(True, gain=reduction(before, after))
    size = np.linalg.norm(added) / np.sqrt(len(added) / 2)
    channels = zip(np.split(before, 2), np.split(after, 2), strict=True)
    worth = max(reduction(old, left) for old, left in channels)
    passes = (
        plain.gain > 0
        and worth >= WORTHWHILE
        and size >= SLIGHT * np.mean(np.abs(joint.seen.friction))
    )
    return Outcome(plain, plain if passes else Finding(False))


def reduction(before: Array, after: Array) -> float:
    """Return the share by which the RMS misfit fell."""
    return float(1 - np.linalg.norm(after) / np.linalg.norm(before))
