"""What is said of a cause besides its own sentence: how much over all runs, and when."""

from collections.abc import Mapping

import numpy as np

from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.effects import dress_pack, drift, stribeck
from frictioncli.effects.base import Effect
from frictioncli.effects.history_text import history_text
from frictioncli.wording import number_text

_SEVERAL_RUNS = 3
"""Runs from which on the change over all of them is stated."""


def words_for(
    diagnosis: Diagnosis, effect: Effect, parameters: Mapping[str, ParameterRecord]
) -> str | None:
    """Return the sentence on an effect where its own would mislead; None where it does not.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    effect : Effect
        The effect.
    parameters : mapping of str to ParameterRecord
        Its parameters.
    """
    slowest = float(np.min(diagnosis.base.table.speed))
    if effect.name == stribeck.EFFECT.name and parameters["velocity"].estimate < slowest:
        return stribeck.EXTRAPOLATED
    if effect.name == dress_pack.EFFECT.name and _pushes(diagnosis, parameters["stiffness"]):
        return dress_pack.PUSHING
    return None


def over_runs(diagnosis: Diagnosis, parameters: Mapping[str, ParameterRecord]) -> str:
    """Return what a drift is over several runs; empty for one.

    A check every week logs minutes of motion; what is asked is the change from check to check.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    parameters : mapping of str to ParameterRecord
        The parameters of the drift.
    """
    table = diagnosis.base.all_runs
    runs = np.unique(table.run)
    if len(runs) < _SEVERAL_RUNS:
        return "" if len(runs) == 1 else " The time between runs does not count."
    shape = {"time_constant": parameters["time_constant"].estimate}
    torque = drift.EFFECT.evaluate(table, shape).friction[:, 0] * parameters["rate"].estimate
    first, last = (float(np.mean(torque[table.run == run])) for run in (runs[0], runs[-1]))
    change = number_text(last - first, 2)
    return (
        f" The time between runs does not count; from the first of {len(runs)} runs to the last it"
        f" is {change} {diagnosis.torque_unit}."
    )


def _pushes(diagnosis: Diagnosis, stiffness: ParameterRecord) -> bool:
    """Return whether a spring certainly does not pull back; a load channel may count otherwise."""
    if stiffness.ci95 is None or diagnosis.base.has_load_channel:
        return False
    return max(diagnosis.base.counted * bound for bound in stiffness.ci95) < 0


def when_there(diagnosis: Diagnosis, cause: Cause) -> str:
    """Return the runs and hours in which a change was there; empty for what always is.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    cause : Cause
        The cause.
    """
    if cause.fit.effect.moments is None:
        return ""
    runs = list(dict.fromkeys([*diagnosis.runs, *filter(None, [diagnosis.held_out])]))
    return history_text(cause.fit.shape, diagnosis.base.all_runs, runs)
