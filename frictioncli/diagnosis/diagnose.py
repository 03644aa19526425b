"""Stage ``diagnose``: what the simulation of one joint's torque gets wrong, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import brentq

from frictioncli.diagnosis.adequacy import Structure, structures
from frictioncli.diagnosis.candidates import Score
from frictioncli.diagnosis.extension import Extension, Gain, extend, measured_gain, misfits
from frictioncli.diagnosis.problem import Problem, build_problems
from frictioncli.diagnosis.search import Candidate, Cause, Found, find_causes
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import EFFECTS
from frictioncli.effects.base import Effect
from frictioncli.errors import NotEnoughData

Array = NDArray[np.float64]

LEAST_PAIRS = 12
"""With fewer pairs noise cannot be told from structure."""

WORTHWHILE = 0.03
"""A cause that takes away less of the misfit than this share is seen, but not worth modelling."""

_SLIGHT = 0.002
"""And so is a cause smaller than this share of the mean friction."""

_POWER = 0.8
_WORST = 5

_UNEXPLAINED = 1e-3
"""Structure that is left beside causes must be this unlikely by chance to count on its own."""

_SHARE_LEFT = 0.35
"""And it must be this large beside the smallest cause: a basis never fits to the last digit."""


@dataclass(frozen=True, slots=True)
class Misfit:
    """Where the simulated torque misses the measured one: mean misfit there. [N·m]."""

    channel: str
    axis: str
    low: float
    high: float
    speed: float
    misfit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """What the simulated torque of a joint gets wrong.

    Attributes
    ----------
    joint : int
        Joint number.
    torque_unit : str
        Unit of everything torque-like.
    verdict : {"no_evidence", "named", "ambiguous", "unnamed"}
        What can be said.
    causes : tuple of Cause
        Causes found, strongest first.
    visible : tuple of Cause
        Causes that stand out of the noise but are not worth modelling.
    structure : Structure or None
        Structure that no effect of the catalogue explains.
    gain : Gain or None
        What the extension is worth; none where nothing was found.
    extension : Extension or None
        The base with the causes, refitted.
    base : Problem
        The data seen, with the base model about which the extension is linear.
    detectable : dict of str to (float or None)
        Smallest size found four times in five, per effect. [N·m]
    rmse : float
        RMS misfit of the simulated torque before any extension. [N·m]
    worst : tuple of Misfit
        Where it misses most.
    runs, held_out : tuple of str, str or None
        Runs that the diagnosis has seen, and the one kept for the gain.
    """

    joint: int
    torque_unit: str
    verdict: str
    causes: tuple[Cause, ...]
    visible: tuple[Cause, ...]
    structure: Structure | None
    gain: Gain | None
    extension: Extension | None
    base: Problem
    detectable: dict[str, float | None]
    rmse: float
    worst: tuple[Misfit, ...]
    runs: tuple[str, ...]
    held_out: str | None


def diagnose_joint(
    torques: pd.DataFrame,
    temperature: str,
    torque_unit: str,
    settings: DiagnosisSettings,
    effects: Sequence[Effect] = EFFECTS,
) -> Diagnosis:
    """Diagnose one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint. With two runs or more the
        last one is kept out of everything but the gain.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    torque_unit : str
        Unit of everything torque-like.
    settings : DiagnosisSettings
        How sure a finding must be.
    effects : sequence of Effect, optional
        The catalogue.

    Raises
    ------
    NotEnoughData
        If there are too few pairs to tell noise from structure.
    """
    joint = int(torques["joint"].iloc[0])
    runs = sorted(torques["run"].unique())
    held_out = str(runs[-1]) if len(runs) > 1 else None
    seen = torques[torques["run"] != held_out]
    pairs = seen.groupby(["run", "pair"], observed=True).ngroups
    if pairs < LEAST_PAIRS:
        raise NotEnoughData(
            f"joint {joint}: {pairs} pairs to learn from, expected at least {LEAST_PAIRS}, to tell"
            " noise from structure; log more moves there and back"
        )
    problem, new = build_problems(torques, temperature, held_out)
    found = find_causes(problem, effects, settings)
    causes, visible = worthwhile(found, new or problem)
    left = _left(found, causes, settings)
    extension = gain = None
    if causes:
        extension = extend(problem, found.step.weighing, _scores(causes))
        gain = measured_gain(
            new or problem,
            extension,
            basis="new_run" if new else "within_run",
            floor=_floor(found),
            seed=settings.seed,
        )
    whole = np.square(problem.friction_misfit) + np.square(problem.load_misfit)
    return Diagnosis(
        joint=joint,
        torque_unit=torque_unit,
        verdict=_verdict(causes, left),
        causes=causes,
        visible=visible,
        structure=left,
        gain=gain,
        extension=extension,
        base=problem,
        detectable=detectable(found, effects, settings.alpha),
        rmse=float(np.sqrt(np.mean(whole))),
        worst=worst_misfits(problem),
        runs=problem.runs,
        held_out=held_out,
    )


def worthwhile(found: Found, judged: Problem) -> tuple[tuple[Cause, ...], tuple[Cause, ...]]:
    """Return the causes that are worth modelling, and those that are only visible.

    A cause of less than 0.2 % of the friction is not. Then the cause whose loss costs least is
    dropped, and the others refitted, until each takes away at least 3 % of the misfit that its
    channel has without it.

    Parameters
    ----------
    found : Found
        Result of the search.
    judged : Problem
        Rows on which a cause must prove itself, of a new run where there is one.
    """
    slight = _SLIGHT * float(np.mean(np.abs(judged.friction)))
    kept = [cause for cause in found.causes if cause.size >= slight]
    dropped = [cause for cause in found.causes if cause.size < slight]
    while kept:
        whole = _misfit(found, kept, judged)
        costs = []
        for i, cause in enumerate(kept):
            channel = cause.candidate.score.effect.channel
            without = _misfit(found, kept[:i] + kept[i + 1 :], judged)
            costs.append(1 - whole[channel] / without[channel])
        least = int(np.argmin(costs))
        if costs[least] >= WORTHWHILE:
            break
        dropped.append(kept.pop(least))
    return tuple(kept), tuple(dropped)


def _misfit(found: Found, causes: Sequence[Cause], judged: Problem) -> dict[str, float]:
    """Return the RMS misfit per channel that the base extended with these causes leaves. [N·m]."""
    extension = extend(found.step.problem, found.step.weighing, _scores(causes))
    friction, load = misfits(judged, extension)
    return {
        "friction": float(np.sqrt(np.mean(np.square(friction)))),
        "load": float(np.sqrt(np.mean(np.square(load)))),
    }


def _scores(causes: Sequence[Cause]) -> list[Score]:
    return [cause.candidate.score for cause in causes]


def _left(found: Found, causes: Sequence[Cause], settings: DiagnosisSettings) -> Structure | None:
    """Return structure that the causes leave, if it is more than noise and rough edges."""
    step = found.step
    strongest = structures(step.problem, step.channels, step.projector, step.misfit)
    if not strongest:
        return None
    first = strongest[0]
    slight = _SLIGHT * float(np.mean(np.abs(step.problem.friction)))
    if first.size < slight:
        return None
    if not found.causes:
        return first if first.p_value < settings.alpha else None
    smallest = min(cause.size for cause in (causes or found.causes))
    if first.p_value < _UNEXPLAINED and first.size > _SHARE_LEFT * smallest:
        return first
    return None


def _verdict(causes: Sequence[Cause], left: Structure | None) -> str:
    if left is not None:
        return "unnamed"
    if not causes:
        return "no_evidence"
    return "named" if all(len(cause.effects) == 1 for cause in causes) else "ambiguous"


def _floor(found: Found) -> float:
    """Return the RMS of point and pair noise of both channels."""
    return float(np.sqrt(sum(noise.point**2 + noise.pair**2 for noise in found.step.noise)))


def detectable(found: Found, effects: Sequence[Effect], alpha: float) -> dict[str, float | None]:
    """Return per effect the smallest RMS size that is found four times in five. [N·m].

    The white norm that a noncentral chi-squared score needs to pass the threshold, times the
    effect's RMS per white norm. None where the data lack what the effect needs.
    """
    catalogue = max(len(found.last) + len(found.causes), 1)
    candidates = found.last | {
        cause.candidate.score.effect.name: cause.candidate for cause in found.causes
    }
    return {
        effect.name: _smallest(candidates.get(effect.name), alpha / catalogue) for effect in effects
    }


def _smallest(candidate: Candidate | None, level: float) -> float | None:
    if candidate is None or candidate.freedom == 0:
        return None
    once = -np.expm1(np.log1p(-level) / candidate.tries)
    threshold = float(stats.chi2.isf(once, candidate.freedom))
    needed = brentq(
        lambda shift: stats.ncx2.sf(threshold, candidate.freedom, shift) - _POWER, 1e-6, 1e4
    )
    return float(np.sqrt(needed) * candidate.size_scale)


def worst_misfits(problem: Problem) -> tuple[Misfit, ...]:
    """Return where the simulated torque misses the measured one most, in the mean."""
    table = problem.table
    axes = {"temperature": table.temperature, "angle": table.position}
    places = []
    for channel, values in (("friction", problem.friction_misfit), ("load", problem.load_misfit)):
        for axis, along in axes.items():
            edges = np.unique(np.quantile(along, np.linspace(0, 1, 7)))
            if len(edges) < 2:
                continue
            cell = np.clip(np.searchsorted(edges, along, side="right") - 1, 0, len(edges) - 2)
            frame = pd.DataFrame({"cell": cell, "speed": table.speed, "misfit": values})
            means = frame.groupby(["cell", "speed"])["misfit"].agg(["mean", "size"])
            for (number, speed), row in means[means["size"] >= 10].iterrows():
                low, high = float(edges[number]), float(edges[number + 1])
                places.append(Misfit(channel, axis, low, high, float(speed), float(row["mean"])))
    return tuple(sorted(places, key=lambda place: -abs(place.misfit))[:_WORST])
