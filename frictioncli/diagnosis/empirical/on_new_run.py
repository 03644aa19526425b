"""Structure without a name that the run that was kept out shows, and the runs seen alone do not.

It may be too weak there to be beyond chance, as friction that comes and goes with time, and recur.
Or the runs seen have next to nothing of it: damage, or something that is mounted and rubs. Another
day always differs a little, above all slowly and with the temperature. So what begins counts only
where it is beyond doubt, and along the angle, the speed or the load; along all else where the
misfit is so far above the noise that no day differs by as much.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.estimate import Empirical, as_structure, empirical_term
from frictioncli.diagnosis.fit.extension import Extension, misfits
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.lack_of_fit import structures
from frictioncli.diagnosis.search.largest_structure import inadequacy, size_along
from frictioncli.diagnosis.search.measurement import beside_base
from frictioncli.diagnosis.search.new_run_changes import ADEQUATE
from frictioncli.diagnosis.search.recurring_structure import recurring_structure
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.structure_above_margin import unnamed_structure

_LEAST_PAIRS = 12
"""With fewer pairs noise cannot be distinguished from structure."""

_BEYOND = 0.1
"""How far the base model holds beyond the temperatures that it was fitted to, relative to their
range; as far as the empirical term reaches."""

_SLOW = frozenset({"temperature", "time"})
"""Axes along which days differ anyway."""

_LESS_BEFORE = 0.5
"""Greatest size on the runs seen, relative to that on the new run."""


def structure_on_new_run(
    step: Step,
    causes: Sequence[Cause],
    new: tuple[Problem, Extension],
    *,
    margin: float,
    floor: float,
    seed: int,
) -> tuple[Structure, Empirical | None] | None:
    """Return structure that a new run shows, and a term for what begins there; None without any.

    What recurs counts as well, and what makes the model inadequate there, located and without a
    term.

    Parameters
    ----------
    step : Step
        Base and causes on the runs seen.
    causes : sequence of Cause
        The causes that are named.
    new : (Problem, Extension)
        Rows of the run that was kept out, and base with causes as they predict it.
    margin : float
        Smallest size worth a name. [N·m]
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    seed : int
        Seed of the block bootstrap.
    """
    problem, predicted = new
    misfit = misfits(problem, predicted)
    square = float(np.mean(problem.squared(*misfit)))
    if square <= (ADEQUATE * floor) ** 2 or len(problem.layout.time) < _LEAST_PAIRS:
        return None
    holding = [
        one.fit
        for one in causes
        if not one.fit.effect.measurement and one.holds_on_new_run is not False
    ]
    own = Step.of(beside_base(problem, found=holding).precomputed, holding)
    there = structures(own)
    if all(one.fit.effect.measurement for one in causes):
        recurring = recurring_structure(step, there, margin)
        if recurring is not None:
            return recurring, None
    found = unnamed_structure(own, margin, BEYOND_DOUBT)
    if found is not None and _was_there(found, step):
        return None
    if found is None or not _SLOW.isdisjoint(found.axes):
        within = _at_temperatures_of(step.problem, problem)
        if within is None:
            return None
        lacking = inadequacy(within, *misfits(within, predicted), floor=floor, margin=margin)
        return None if lacking is None else (_located(lacking, step.problem, predicted), None)
    term = empirical_term(
        own,
        new,
        None,
        margin=margin,
        floor=floor,
        seed=seed,
        structure=found,
        base_is_of_others=True,
    )
    return replace(found, only_on=problem.runs[-1]), as_structure(term)


def _at_temperatures_of(seen: Problem, new: Problem) -> Problem | None:
    """Return a new run's rows at the temperatures of the runs seen; None with too few pairs.

    Elsewhere its misfit is the error of an extrapolation: an exponential that fits from 25 to 60 °C
    says little about 5 °C, and a day in the cold shows no change of the joint.
    """
    low, high = np.min(seen.table.temperature), np.max(seen.table.temperature)
    further = _BEYOND * (high - low)
    temperature = new.table.temperature
    within = (temperature >= low - further) & (temperature <= high + further)
    if len(np.unique(new.layout.row_pair[within])) < _LEAST_PAIRS:
        return None
    return new.part(within)


def _located(lacking: Structure, seen: Problem, predicted: Extension) -> Structure:
    """Return what the model lacks on a new run; not of that run alone if the others have it, too.

    There it may have been discrepancy. Along time a run has its own history: what counts is how
    large it is.
    """
    (axis,) = lacking.axes
    misfit = misfits(seen, predicted)[0 if lacking.channel == "friction" else 1]
    if axis == "time":
        means = seen.layout.means(misfit[:, np.newaxis])
        before = float(np.sqrt(np.mean(np.square(means))))
    else:
        before = size_along(seen, axis, misfit)
    return replace(lacking, only_on="") if before > _LESS_BEFORE * lacking.size else lacking


def _was_there(found: Structure, step: Step) -> bool:
    """Return whether the runs seen have much of the structure of a new run."""
    place = (found.axes, found.channel)
    before = (one.size for one in structures(step) if (one.axes, one.channel) == place)
    return next(before, 0.0) > _LESS_BEFORE * found.size
