"""``diagnosis.json`` and ``extended-model.json`` of a diagnosis."""

from collections.abc import Mapping
from dataclasses import fields, replace

import numpy as np
from msgspec import UNSET

from frictioncli.diagnosis.data.gravity_document import gravity_document
from frictioncli.diagnosis.documents.cause_words import over_runs, when_there, words_for
from frictioncli.diagnosis.documents.detectable import detectable_sizes, undetectable_reasons
from frictioncli.diagnosis.documents.document import (
    CauseRecord,
    DiagnosisDocument,
    GainRecord,
    SimulationRecord,
)
from frictioncli.diagnosis.documents.empirical_record import term_record
from frictioncli.diagnosis.documents.extended_document import (
    EffectRecord,
    ExtendedDocument,
    ParameterRecord,
)
from frictioncli.diagnosis.documents.parameters import (
    Z95,
    extension_coefficients,
    extension_parameters,
    fitted_parameters,
    statement,
)
from frictioncli.diagnosis.documents.ramps_record import ramps_record
from frictioncli.diagnosis.documents.remainder import remainder_record
from frictioncli.diagnosis.documents.structure_record import (
    discrepancy_record,
    empirical_record,
    known_interval,
    structure_record,
    unnamed_record,
)
from frictioncli.diagnosis.documents.thermal_record import record_of_lag
from frictioncli.diagnosis.documents.torque_units import TorqueUnits
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.ramps.evidence import RampEstimate
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.timing_causes import DELAY, FILTER
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.diagnosis.thermal.refine import LAG
from frictioncli.effects import drift, torque_delay, torque_filter
from frictioncli.model.document import PARAMETERS, FrictionModel, ParameterEstimate
from frictioncli.model.friction import FrictionParameters
from frictioncli.model.late_torque import FREED

_AS_LOGGED = "this model predicts it as it was logged"
"""What a note on a delay says of an extended model."""


def diagnosis_document(
    diagnosis: Diagnosis, settings: DiagnosisSettings, *, sizes: bool = True
) -> DiagnosisDocument:
    """Return one joint's diagnosis as a document.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    settings : DiagnosisSettings
        Its settings.
    sizes : bool, optional
        Whether the smallest size of each effect that would be named is worked out.
    """
    causes = [
        _cause_record(diagnosis, cause, number + 1) for number, cause in enumerate(diagnosis.causes)
    ]
    if diagnosis.structure is not None:
        causes.append(unnamed_record(diagnosis))
    gain, ramps = diagnosis.gain, diagnosis.ramps
    detectable = detectable_sizes(diagnosis, settings) if sizes else {}
    return DiagnosisDocument(
        joint=diagnosis.joint,
        verdict=diagnosis.verdict,
        causes=tuple(causes),
        visible=tuple(_visible_record(diagnosis, cause) for cause in diagnosis.visible),
        structure=structure_record(diagnosis),
        margin=diagnosis.margin,
        load_margin=diagnosis.load_margin,
        gain=None
        if gain is None
        else GainRecord(
            basis=gain.basis,
            rmse_before=gain.before,
            rmse_after=gain.after,
            reduction=gain.reduction,
            ci95=gain.interval,
            noise_floor=gain.floor,
            rmse_without_level=gain.without_level,
        ),
        empirical=empirical_record(diagnosis),
        discrepancy=discrepancy_record(diagnosis),
        remainder=remainder_record(diagnosis),
        detectable=detectable,
        undetectable=undetectable_reasons(diagnosis, settings, detectable),
        simulation=SimulationRecord(rmse=diagnosis.rmse, worst=diagnosis.worst),
        ramps=None if ramps is None else ramps_record(ramps, diagnosis.torque_unit),
        settling=diagnosis.settling,
        without_temperature=diagnosis.without_temperature,
        stuck_temperature=diagnosis.stuck_temperature,
        torque_unit=diagnosis.torque_unit,
        load_unit=TorqueUnits.of_diagnosis(diagnosis).load
        if diagnosis.base.has_load_channel
        else None,
        runs=diagnosis.runs,
        held_out=diagnosis.held_out,
        settings=settings,
    )


def extended_document(diagnosis: Diagnosis, model: FrictionModel) -> ExtendedDocument:
    """Return the base model with the causes found, all refitted, as a document.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    model : FrictionModel
        The joint's model.
    """
    stated = {field.name: getattr(model, field.name) for field in fields(model)}
    extension = _stated(diagnosis)
    if extension is None:
        return ExtendedDocument(**stated, effects=())
    base, form = diagnosis.base.parameters, diagnosis.base.gravity_form
    units = TorqueUnits.of_diagnosis(diagnosis)
    parameters = _base_parameters(extension, base, model.parameters)
    effects = [
        EffectRecord(
            name=one.effect.name,
            equation=one.effect.equation,
            channel=one.effect.channel,
            shape=one.shape,
            coefficients=extension_coefficients(extension, number, diagnosis.base, units),
        )
        for number, one in enumerate(extension.effects)
    ]
    # it was fitted to torques as they were logged: nothing is taken off beforehand
    notes = tuple(one.replace(FREED, _AS_LOGGED) for one in model.notes)
    return ExtendedDocument(
        **stated | {"parameters": parameters, "delay": None, "notes": notes},
        effects=tuple(effects),
        linear_about=FrictionParameters(
            **{name: float(getattr(base, name)) for name in PARAMETERS}
        ),
        gravity_about=gravity_document(diagnosis.base.gravity, form),
        gravity=gravity_document(extension.gravity, form),
        hidden_temperature=diagnosis.base.hidden or UNSET,
        empirical=UNSET
        if diagnosis.empirical is None
        else term_record(
            diagnosis.empirical,
            diagnosis.torque_unit,
            _base_parameters(diagnosis.empirical.beside, base, model.parameters),
        ),
        late_torque=diagnosis.base.late or UNSET,
    )


def _base_parameters(
    extension: Extension, about: FrictionParameters, known: Mapping[str, ParameterEstimate]
) -> dict[str, ParameterEstimate]:
    """Return the base's parameters of an extension with intervals; others as they are known."""
    found = dict(known)
    for name, change, error in zip(
        extension.names, extension.changes, extension.errors, strict=False
    ):
        value = getattr(about, name) + float(change)
        reach = Z95 * float(error)
        found[name] = replace(found[name], estimate=value, ci95=(value - reach, value + reach))
    return found


def _stated(diagnosis: Diagnosis) -> Extension | None:
    """Return the extension whose parameters are stated: what the empirical term is added to."""
    return diagnosis.extension if diagnosis.empirical is None else diagnosis.empirical.without


def _cause_record(diagnosis: Diagnosis, cause: Cause, number: int) -> CauseRecord:
    """Return a named cause; its parameters are those of the extended model."""
    effect, extension = cause.fit.effect, _stated(diagnosis)
    assert extension is not None  # there is one wherever there is a cause
    units = TorqueUnits.of_diagnosis(diagnosis)
    parameters = extension_parameters(extension, effect.name, diagnosis.base, units)
    record = _record(diagnosis, cause, parameters, f"diagnosis-{number}.svg")
    if diagnosis.thermal is None or effect.name != LAG:
        return record
    return record_of_lag(record, diagnosis.thermal, diagnosis.torque_unit)


def _visible_record(diagnosis: Diagnosis, cause: Cause) -> CauseRecord:
    """Return a cause that is not named; its parameters are those of its own fit."""
    units = TorqueUnits.of_diagnosis(diagnosis)
    parameters = fitted_parameters(cause.fit, diagnosis.base, units)
    return _record(diagnosis, cause, parameters, None)


def _record(
    diagnosis: Diagnosis, cause: Cause, parameters: dict[str, ParameterRecord], figure: str | None
) -> CauseRecord:
    effect = cause.fit.effect
    said = statement(effect, parameters, words_for(diagnosis, effect, parameters))
    if effect is drift.EFFECT:
        said += over_runs(diagnosis, parameters)
    timing = diagnosis.timing if effect.name == DELAY else None
    if timing is not None and cause.effects == (FILTER,):
        effect = torque_filter.EFFECT
        parameters = {"time_constant": _seconds(timing.estimates()[1])}
        said = statement(effect, parameters, torque_filter.BY_TIME_CONSTANT)
    elif timing is not None and cause.effects == (DELAY,) and timing.best == "both":
        delay, time_constant = map(_seconds, timing.estimates())
        parameters = {"delay": delay, "time_constant": time_constant}
        said = statement(effect, parameters, torque_delay.BESIDE_A_FILTER)
    elif timing is not None:
        # where a delay is not told from a filter, it stands for all that is late
        parameters = {"delay": _seconds(timing.shift)}
        said = statement(effect, parameters)
    return CauseRecord(
        kind=effect.kind,
        standing=cause.standing,
        holds_on_new_run=cause.holds_on_new_run,
        only_on_new_run=cause.only_on_new_run,
        reason=cause.reason,
        effects=cause.effects,
        probabilities=cause.probabilities,
        channel=cause.fit.effect.channel,
        statement=said,
        claim=effect.signature.claim,
        equation=effect.equation,
        when=when_there(diagnosis, cause),
        parameters=parameters,
        size=cause.size,
        size_ci95=_size_interval(cause),
        visible_size=cause.visible,
        visible_ci95=known_interval(cause.visible_interval),
        p_value=cause.test.p_value,
        seen_in=effect.signature.axis,
        figure=figure,
        experiment=effect.experiment,
    )


def _seconds(found: RampEstimate) -> ParameterRecord:
    """Return a time that starts of moves and pairs together tell."""
    return ParameterRecord(estimate=found.value, ci95=(found.low, found.high), unit="s")


def _size_interval(cause: Cause) -> tuple[float, float] | None:
    """Return the interval of a cause's size.

    The size of an effect with one coefficient is in proportion to it; that of others is what the
    base leaves of them.
    """
    if cause.size_interval is not None:
        return known_interval(cause.size_interval)
    if len(cause.fit.coefficients) != 1:
        return known_interval(cause.visible_interval)
    value = abs(float(cause.fit.coefficients[0]))
    reach = Z95 * float(np.sqrt(max(float(cause.fit.covariance[0, 0]), 0.0)))
    if value == 0.0:
        return None
    scale = cause.size / value
    return (scale * max(value - reach, 0.0), scale * (value + reach))
