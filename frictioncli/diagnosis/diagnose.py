"""Diagnosis of one joint: causes of the misfit of its simulated torque, and the extended model.

The misfit of the base model (16) plus gravity is searched for effects of the catalogue
(:mod:`frictioncli.diagnosis.search`). Causes that improve the prediction extend the model; a test
of the lack of fit tells what no effect explains; the gain is measured on a held-out run, if any.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.worst_misfits import worst_misfits
from frictioncli.diagnosis.empirical.estimate import as_structure, empirical_term
from frictioncli.diagnosis.empirical.on_new_run import structure_on_new_run
from frictioncli.diagnosis.empirical.unexplained import unexplained
from frictioncli.diagnosis.explained_share import without_small_parts
from frictioncli.diagnosis.fit.extension import Extension, extend, rms_misfit
from frictioncli.diagnosis.fit.gain import measured_gain
from frictioncli.diagnosis.found_causes import found_causes
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.needless_steps import without_needless_steps
from frictioncli.diagnosis.ramps.evidence import RampLog, ramp_evidence
from frictioncli.diagnosis.ramps.settling import settled_problems
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.judging import Judging
from frictioncli.diagnosis.search.late_ripple import shown_by_ripple
from frictioncli.diagnosis.search.margin import channel_margin, margin_of
from frictioncli.diagnosis.search.measurement import (
    beside_the_rest,
    corrected_without_name,
)
from frictioncli.diagnosis.search.named_causes import named_causes
from frictioncli.diagnosis.search.new_run_changes import changes_on_new_run, with_effect
from frictioncli.diagnosis.search.new_run_misfit import NewRunMisfit
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.search_result import given_up_causes
from frictioncli.diagnosis.search.stated_size import sizes_in_model
from frictioncli.diagnosis.search.timing_causes import late_torque
from frictioncli.diagnosis.search.verdict import verdict_of, visible_causes
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.diagnosis.thermal.refine import LAG, settled
from frictioncli.effects import EFFECTS, RIVALS
from frictioncli.effects.base import Effect
from frictioncli.effects.payload_change import EFFECT as PAYLOAD_CHANGE
from frictioncli.errors import NotEnoughData
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.zero_load import with_temperature

LEAST_PAIRS = 12
"""With fewer pairs noise cannot be distinguished from structure."""


def diagnose_joint(
    torques: pd.DataFrame,
    temperature: str,
    torque_unit: str,
    settings: DiagnosisSettings,
    effects: Sequence[Effect] = EFFECTS,
    ramps: RampLog | None = None,
    doubt: str = "",
) -> Diagnosis:
    """Diagnose one joint.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint. With two runs or more the
        last one is held out of everything but the selection of causes and the gain.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    torque_unit : str
        Unit of everything torque-like.
    settings : DiagnosisSettings
        Significance level, seed and greatest number of causes.
    effects : sequence of Effect, optional
        The catalogue.
    ramps : RampLog, optional
        Measurements outside the constant-velocity segments.
    doubt : str, optional
        Why no cause but those of the measurement can have a name; empty where some can.

    Raises
    ------
    NotEnoughData
        If there are too few pairs.
    """
    known, lost = with_temperature(torques, temperature)
    found = without_needless_steps(
        lambda catalogue: without_small_parts(
            partial(_diagnosed, known, temperature, torque_unit, settings, catalogue, ramps, doubt)
        ),
        effects,
    )
    return replace(found, without_temperature=lost.without, stuck_temperature=lost.stuck)


def _diagnosed(
    torques: pd.DataFrame,
    temperature: str,
    torque_unit: str,
    settings: DiagnosisSettings,
    effects: Sequence[Effect],
    ramps: RampLog | None,
    doubt: str,
    without_name: Mapping[str, str],
) -> Diagnosis:
    """Return the diagnosis of one joint with one catalogue, some effects without a name."""
    joint = int(torques["joint"].iloc[0])
    runs = runs_in_order(torques)
    held_out = runs[-1] if len(runs) > 1 else None
    pairs = torques[torques["run"] != held_out].groupby(["run", "pair"], observed=True).ngroups
    if pairs < LEAST_PAIRS:
        raise NotEnoughData(
            f"joint {joint}: {pairs} pairs to learn from, expected at least {LEAST_PAIRS} to"
            " distinguish structure from noise; log more moves in both directions"
        )
    rows = settled_problems(torques, temperature, held_out, ramps, LEAST_PAIRS)
    known = Preparation()
    late = late_torque(rows.problem, rows.timing, known.beside, torques)
    base = replace(rows.problem, late=late, doubt=doubt)
    base_new = rows.new and replace(rows.new, late=late, doubt=doubt)
    margin = margin_of(base, torque_unit, settings)
    evidence = ramp_evidence(ramps, base, temperature) if ramps else None
    search = partial(
        find_causes, settings=settings, margin=margin, ramps=evidence, preparation=known
    )
    judging = Judging(
        problem=base,
        new=base_new,
        measured=(base, base_new),
        preparation=known,
        starts=rows.timing,
        margin=margin,
        alpha=settings.alpha,
    )
    result = found_causes(judging, effects, search)
    measured = [one.fit for one in result.search.measurement]
    if (late := shown_by_ripple(result.search.step, measured)) is not None:
        base = replace(base, late=late)
        base_new = base_new and replace(base_new, late=late)
        judging = replace(judging, problem=base, new=base_new, measured=(base, base_new))
        result = found_causes(judging, effects, search)
    found, lag = result.search, result.lag
    problem, new = result.judging.problem, result.judging.new
    judged = result.judged
    for name, reason in without_name.items():
        judged = judged.without_names({name}, "visible", reason)
    named = named_causes(result.judging, judged)
    causes, step = named.causes, named.step
    noticed = corrected_without_name(named.others, causes, problem)
    extension = gain = None
    if lag is not None and not any(cause.fit.effect.name == LAG for cause in causes):
        # what is not named does not move the temperature of the extended model
        problem, new, lag = base, base_new, None
    weighted_fit = step.predicting_fit()
    fits = [cause.fit for cause in (*causes, *noticed)]
    if causes:
        weighted_fit = beside_the_rest(problem, weighted_fit, named.measurement, fits)
        extension = extend(problem, weighted_fit, fits)
        if lag is not None:
            lag, extension = settled(lag, fits, weighted_fit)
            problem, new = lag.problem, lag.new
        causes = sizes_in_model(causes, extension, step, named.measurement, base, found.refused)
    appeared: tuple[Cause, ...] = ()
    modelled = extension or extend(problem, weighted_fit, fits)
    if new:
        predicted = predicting(modelled, causes)
        appeared = changes_on_new_run(
            NewRunMisfit.of(problem, new, predicted, weighted_fit, step.noise()),
            [one for one in effects if one.name not in _found(causes)],
            floor=found.floor,
            # structure without a name may be on the held-out run in another way
            usual=rms_misfit(problem, modelled) if named.structure is None else found.floor,
            margin=margin,
            structure=named.structure,
        )
        for cause in appeared:
            modelled = extension = with_effect(modelled, cause.fit, len(causes))
        causes = (*causes, *appeared)
    predicted = predicting(modelled, causes)
    if extension is not None:
        gain = measured_gain(
            new or problem,
            predicted,
            base=base_new or base,
            # a change that begins on the held-out run was fitted there
            basis="new_run" if new and not appeared else "within_run",
            floor=found.floor,
            seed=settings.seed,
        )
    empirical = empirical_term(
        step,
        (problem, modelled),
        (new, lambda one: predicting(one, causes)) if new else None,
        margin=margin,
        floor=found.floor,
        seed=settings.seed,
        structure=named.structure,
    )
    evident = as_structure(empirical)
    structure = unexplained(named.structure, causes, evident, step, settings.alpha)
    if new and structure is None and evident is None and not appeared:
        begun = structure_on_new_run(
            step, causes, (new, predicted), margin=margin, floor=found.floor, seed=settings.seed
        )
        structure, evident = begun or (None, None)
        empirical = evident or empirical
    corrected = noticed if extension is not None or empirical is not None else ()
    names = {one.fit.effect.name for one in corrected}
    rest = [one for one in named.others if one.fit.effect.name not in names]
    rest += [*corrected, *given_up_causes(found, settings.alpha), *result.refuted]
    visible = visible_causes(rest, found.refused, causes, problem)
    return Diagnosis(
        joint=joint,
        torque_unit=torque_unit,
        verdict=verdict_of(causes, structure),
        causes=causes,
        visible=visible,
        structure=structure,
        gain=gain,
        corrected=corrected,
        extension=extension,
        predicted=predicted,
        base=problem,
        judged=new or problem,
        floor=found.floor,
        search=found,
        tried=tuple(effects),
        margin=margin,
        load_margin=channel_margin(base, "load", margin) if base.has_load_channel else None,
        rmse=float(np.sqrt(np.mean(base.squared(base.friction_misfit, base.load_misfit)))),
        worst=worst_misfits(base),
        runs=problem.runs,
        held_out=held_out,
        ramps=evidence,
        thermal=None if lag is None else lag.estimate,
        timing=named.timing,
        settling=rows.settling,
        empirical=empirical,
    )


def _found(causes: Sequence[Cause]) -> frozenset[str]:
    """Return the effects that causes were found as, and a payload for a rival of it."""
    names = {one.fit.effect.name for one in causes}
    is_rival = not names.isdisjoint(one.name for one in RIVALS)
    return frozenset(names | {PAYLOAD_CHANGE.name} if is_rival else names)


def predicting(extension: Extension, causes: Sequence[Cause]) -> Extension:
    """Return an extension as it predicts a new run: without properties that did not last.

    The history of a change already says that it is not there; the base was fitted beside all.

    Parameters
    ----------
    extension : Extension
        The base with the causes, refitted.
    causes : sequence of Cause
        The causes, in the order of its effects; other effects may follow.
    """
    gone = {
        number
        for number, cause in enumerate(causes)
        if cause.holds_on_new_run is False and cause.fit.effect.moments is None
    }
    effects = tuple(one for number, one in enumerate(extension.effects) if number not in gone)
    return replace(extension, effects=effects)
