"""Structure without a name in ``diagnosis.json``: located, and described where a form does."""

import numpy as np

from frictioncli.diagnosis.documents.document import CauseRecord, StructureRecord
from frictioncli.diagnosis.documents.empirical_record import (
    EmpiricalGainRecord,
    LocatedRecord,
    gain_record,
)
from frictioncli.diagnosis.documents.torque_units import TorqueUnits
from frictioncli.diagnosis.empirical.estimate import Empirical, as_structure
from frictioncli.diagnosis.empirical.next_experiment import experiment
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.search.axis_columns import friction_tells_load, load_over_angle
from frictioncli.diagnosis.search.confounded import has_temperature
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.search.timing_causes import DELAY


def structure_record(diagnosis: Diagnosis) -> StructureRecord | None:
    """Return structure that no effect explains; None where there is none.

    Where forms describe it, it is the largest of these.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    """
    structure = diagnosis.structure
    if structure is None:
        return None
    forms, only_on = _forms(diagnosis), _only_on(structure)
    later = "time" not in structure.axes and (only_on or _begins(diagnosis))
    in_time = ("time",) if later else ()
    if forms:
        further = tuple(one for one in _further_axes(structure, forms) if one not in in_time)
        return StructureRecord(
            axis=(*forms[0].axes, *further, *in_time),
            channel=forms[0].channel,
            description=f"{_in_words(forms)}{_by_an_amount(further)}{only_on}.",
            formula="; plus ".join(one.formula or "" for one in forms),
            size=forms[0].size,
            ci95=forms[0].ci95,
        )
    return StructureRecord(
        axis=(*structure.axes, *in_time),
        channel=structure.channel,
        description=_residuals(structure.channel, structure.axes, only_on) + _or_angle(diagnosis),
        size=structure.size,
        ci95=known_interval(structure.interval),
    )


def unnamed_record(diagnosis: Diagnosis) -> CauseRecord:
    """Return structure without a name in the form of a cause.

    Parameters
    ----------
    diagnosis : Diagnosis
        A diagnosis with such structure.
    """
    found, structure = structure_record(diagnosis), diagnosis.structure
    # there is structure
    assert found is not None
    assert structure is not None
    along = _along(found.axis)
    claim = found.description
    if found.formula is not None:
        claim = f"{_residuals(found.channel, found.axis)} A form describes it: {claim}"
    return CauseRecord(
        standing="visible",
        reason="no known effect explains it",
        effects=(),
        probabilities={},
        channel=found.channel,
        claim=claim,
        equation=found.formula or "",
        parameters={},
        size=found.size,
        size_ci95=found.ci95,
        p_value=structure.p_value,
        seen_in=along,
        figure=None,
        experiment=_experiment(diagnosis) or _experiment_along(found.axis, diagnosis),
    )


def known_interval(interval: tuple[float, float]) -> tuple[float, float] | None:
    """Return an interval, or None where it has no end."""
    low, high = (float(end) for end in interval)
    return (low, high) if np.isfinite(low) and np.isfinite(high) else None


def empirical_record(diagnosis: Diagnosis) -> EmpiricalGainRecord | None:
    """Return the empirical term of structure, with its forms in words; None without one.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    """
    return _gain_record(diagnosis, as_structure(diagnosis.empirical))


def discrepancy_record(diagnosis: Diagnosis) -> EmpiricalGainRecord | None:
    """Return the empirical term of the smooth error that any model has; None without one.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    """
    found = diagnosis.empirical
    return None if as_structure(found) else _gain_record(diagnosis, found)


def _gain_record(diagnosis: Diagnosis, found: Empirical | None) -> EmpiricalGainRecord | None:
    if found is None:
        return None
    stated = any(one.fit.effect.name == DELAY for one in diagnosis.causes)
    return gain_record(found, TorqueUnits.of_diagnosis(diagnosis), delay_is_stated=stated)


def _forms(diagnosis: Diagnosis) -> tuple[LocatedRecord, ...]:
    found = empirical_record(diagnosis)
    return () if found is None else found.forms


def _further_axes(structure: Structure, forms: tuple[LocatedRecord, ...]) -> tuple[str, ...]:
    """Return what structure depends on besides the quantity of the only form that describes it."""
    own = set(forms[0].axes)
    if len(forms) > 1 or forms[0].channel != structure.channel or not own < set(structure.axes):
        return ()
    return tuple(axis for axis in structure.axes if axis not in own)


def _only_on(structure: Structure) -> str:
    """Return which run alone has structure; empty if others have it, too."""
    return f", on run {structure.only_on} only" if structure.only_on else ""


def _begins(diagnosis: Diagnosis) -> bool:
    """Return whether the largest form is there from a later run on."""
    form = diagnosis.empirical.parts[0].form if diagnosis.empirical is not None else None
    return form is not None and bool(form.since)


def _by_an_amount(further: tuple[str, ...]) -> str:
    """Return that a form is one of a mean over further quantities; empty without any."""
    return f", on average: by an amount that changes with the {_along(further)}" if further else ""


def _experiment(diagnosis: Diagnosis) -> str:
    """Return what to measure next about the largest form; empty without one."""
    found = diagnosis.empirical
    form = found.parts[0].form if found is not None else None
    return "" if form is None else experiment(form, TorqueUnits.of_diagnosis(diagnosis).load)


def _or_angle(diagnosis: Diagnosis) -> str:
    """Return that structure along the load may be one along the angle; empty if it may not."""
    structure, base = diagnosis.structure, diagnosis.base
    if structure is not None and structure.or_load:
        return " It may as well be along the load."
    if structure is None or structure.axes != ("load",) or load_over_angle(base) is None:
        return ""
    if structure.channel == "friction" and friction_tells_load(base):
        return ""
    return " The load is the same at the same angle here: it may as well be along the angle."


def _experiment_along(axes: tuple[str, ...], diagnosis: Diagnosis) -> str:
    """Return what to measure next about structure that no form describes."""
    if axes == ("position",) or _or_angle(diagnosis):
        return (
            "Move through the whole stroke in narrow angle bins, at three speeds, cold and warm,"
            " and with another payload: it then stays at its angle, or moves with the load."
        )
    if axes == ("time",) and not has_temperature(diagnosis.base):
        return (
            "Log the temperature of the motor: friction that changes as the joint warms up or"
            " cools down varies with time."
        )
    if axes == ("time",):
        return (
            "Repeat the same moves over several hours and on another day, and note what changes:"
            " the room, pauses, payloads, what is mounted, oil, and the brake."
        )
    ringing = (
        " Pair again with --settling 0.4 and diagnose: if it is gone, the joint still rings behind"
        " its accelerations."
    )
    return (
        f"Measure more values of {_along(axes)}, in random order, on another day."
        f"{ringing if set(axes) == {'position', 'speed'} else ''}"
    )


def _in_words(forms: tuple[LocatedRecord, ...]) -> str:
    return ", and ".join(one.description or "" for one in forms)


def _residuals(channel: str, axes: tuple[str, ...], only_on: str = "") -> str:
    return f"Residuals of the {channel} have structure along {_along(axes)}{only_on}."


def _along(axes: tuple[str, ...]) -> str:
    """Return the axes in words."""
    return " and ".join(axes).replace("position", "angle")
