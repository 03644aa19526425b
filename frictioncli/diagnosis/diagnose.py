"""Stage ``diagnose``: what the simulation of one joint's torque gets wrong, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.problem import Problem, build_problems
from frictioncli.diagnosis.fit.extension import Extension, Gain, extend, measured_gain
from frictioncli.diagnosis.ramps.evidence import RampEvidence, RampLog, ramp_evidence
from frictioncli.diagnosis.search.cause_search import Cause, Found, find_causes
from frictioncli.diagnosis.search.detectable import detectable
from frictioncli.diagnosis.search.holdout import SLIGHT, worthwhile
from frictioncli.diagnosis.search.lack_of_fit import Structure, structures
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import EFFECTS
from frictioncli.effects.base import Effect
from frictioncli.errors import NotEnoughData

LEAST_PAIRS = 12
"""With fewer pairs noise cannot be told from structure."""

_WORST = 5

_UNEXPLAINED = 1e-3
"""Structure without a name must be this unlikely by chance: fifteen places are looked at."""

_WORTH_SAYING = 0.003
"""And, alone, as large as this share of the mean friction."""

_SIZE_LEFT = 0.3
"""Beside causes it must have this share of the torque that the largest one shows,"""

_SHARE_LEFT = 0.1
"""and explain this share of what they do: no equation is true to the last digit."""


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
    ramps : RampEvidence or None
        What the ramps of the moves say, where the log has them.
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
    ramps: RampEvidence | None


def diagnose_joint(
    torques: pd.DataFrame,
    temperature: str,
    torque_unit: str,
    settings: DiagnosisSettings,
    effects: Sequence[Effect] = EFFECTS,
    ramps: RampLog | None = None,
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
    ramps : RampLog, optional
        What was measured outside the constant-velocity parts.

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
    said = ramp_evidence(ramps, problem, temperature) if ramps else None
    found = find_causes(problem, effects, settings, said)
    weighing = found.step.weighing()
    worthy, visible = worthwhile(found, weighing, new or problem, settings.seed)
    left = _left(found, worthy, settings)
    # what explains less than is left may be a part of what has no name
    causes = tuple(cause for cause in worthy if left is None or _exceeds(cause, left))
    visible += tuple(cause for cause in worthy if cause not in causes)
    extension = gain = None
    if causes:
        extension = extend(problem, weighing, [cause.score for cause in causes])
        gain = measured_gain(
            new or problem,
            extension,
            basis="new_run" if new else "within_run",
            floor=_floor(found),
            seed=settings.seed,
        )
    whole = problem.squared(problem.friction_misfit, problem.load_misfit)
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
        ramps=said,
    )


def _left(found: Found, causes: Sequence[Cause], settings: DiagnosisSettings) -> Structure | None:
    """Return structure that the causes leave, if it is more than noise and rough edges."""
    step = found.step
    shown = max((cause.visible for cause in causes), default=0.0)
    friction = float(np.mean(np.abs(step.problem.friction)))
    least = max(SLIGHT * friction, _SIZE_LEFT * shown) if causes else _WORTH_SAYING * friction
    told = sum(cause.judged.statistic for cause in found.causes) if causes else 0.0
    for one in structures(step, settings.seed):
        unlikely = one.p_value < min(_UNEXPLAINED, settings.alpha)
        if unlikely and one.size >= least and one.statistic - one.freedom > _SHARE_LEFT * told:
            return one
    return None


def _exceeds(cause: Cause, left: Structure) -> bool:
    return cause.judged.statistic > left.statistic - left.freedom


def _verdict(causes: Sequence[Cause], left: Structure | None) -> str:
    if left is not None:
        return "unnamed"
    if not causes:
        return "no_evidence"
    return "named" if all(len(cause.effects) == 1 for cause in causes) else "ambiguous"


def _floor(found: Found) -> float:
    """Return the RMS of point and pair noise of the channels that are simulated."""
    channels = found.step.noise()[: 1 if found.step.problem.own_load else 2]
    return float(np.sqrt(sum(noise.point**2 + noise.pair**2 for noise in channels)))


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
