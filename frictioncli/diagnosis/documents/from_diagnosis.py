"""``diagnosis.json`` and ``extended-model.json`` of a diagnosis."""

from dataclasses import fields, replace

import numpy as np

from frictioncli.diagnosis.data.gravity import gravity_document
from frictioncli.diagnosis.diagnose import Diagnosis
from frictioncli.diagnosis.documents.document import (
    CauseRecord,
    DiagnosisDocument,
    GainRecord,
    RampsRecord,
    SimulationRecord,
    VisibleRecord,
)
from frictioncli.diagnosis.documents.extended_model import (
    EffectRecord,
    ExtendedDocument,
    ParameterRecord,
)
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.search.cause_search import Cause
from frictioncli.diagnosis.search.lack_of_fit import Structure
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects.base import Parameter
from frictioncli.model.document import PARAMETERS, FrictionModel
from frictioncli.model.friction import FrictionParameters
from frictioncli.quantities import TORQUE

_Z95 = 1.96


def diagnosis_document(diagnosis: Diagnosis, settings: DiagnosisSettings) -> DiagnosisDocument:
    """Return one joint's diagnosis as a document.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis.
    settings : DiagnosisSettings
        Its settings.
    """
    causes = [
        _cause_record(diagnosis, cause, number + 1) for number, cause in enumerate(diagnosis.causes)
    ]
    if diagnosis.structure is not None:
        causes.append(_unnamed_record(diagnosis.structure))
    gain = diagnosis.gain
    return DiagnosisDocument(
        joint=diagnosis.joint,
        verdict=diagnosis.verdict,
        causes=tuple(causes),
        visible=tuple(
            VisibleRecord(effects=cause.effects, size=cause.size, p_value=cause.test.p_value)
            for cause in diagnosis.visible
        ),
        gain=None
        if gain is None
        else GainRecord(
            basis=gain.basis,
            rmse_before=gain.before,
            rmse_after=gain.after,
            reduction=gain.reduction,
            ci95=gain.interval,
            noise_floor=gain.floor,
        ),
        detectable=diagnosis.detectable,
        simulation=SimulationRecord(rmse=diagnosis.rmse, worst=diagnosis.worst),
        ramps=_ramps_record(diagnosis),
        torque_unit=diagnosis.torque_unit,
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
    extension = diagnosis.extension
    if extension is None:
        return ExtendedDocument(**stated, effects=())
    base = diagnosis.base.parameters
    parameters = dict(model.parameters)
    for name, change, error in zip(
        extension.names, extension.changes, extension.errors, strict=False
    ):
        value = getattr(base, name) + float(change)
        parameters[name] = replace(
            parameters[name],
            estimate=value,
            ci95=(value - _Z95 * float(error), value + _Z95 * float(error)),
        )
    effects = [
        EffectRecord(
            name=one.effect.name,
            equation=one.effect.equation,
            channel=one.effect.channel,
            shape=one.shape,
            coefficients=_coefficients(extension, number, diagnosis.torque_unit),
        )
        for number, one in enumerate(extension.effects)
    ]
    return ExtendedDocument(
        **stated | {"parameters": parameters},
        effects=tuple(effects),
        linear_about=FrictionParameters(
            **{name: float(getattr(base, name)) for name in PARAMETERS}
        ),
        gravity_about=gravity_document(diagnosis.base.gravity),
        gravity=gravity_document(extension.gravity),
    )


def _ramps_record(diagnosis: Diagnosis) -> RampsRecord | None:
    ramps = diagnosis.ramps
    if ramps is None:
        return None
    return RampsRecord(
        inertia=ParameterRecord(
            estimate=ramps.inertia.value,
            ci95=(ramps.inertia.low, ramps.inertia.high),
            unit=f"{diagnosis.torque_unit}/(deg/s²)",
        ),
        rmse_before=ramps.rms_before,
        rmse_after=ramps.rms_after,
        log_odds_reversal_transient=ramps.log_odds,
        moves=ramps.moves,
    )


def _cause_record(diagnosis: Diagnosis, cause: Cause, number: int) -> CauseRecord:
    effect = cause.fit.effect
    extension = diagnosis.extension
    assert extension is not None  # there is one wherever there is a cause
    return CauseRecord(
        effects=cause.effects,
        probabilities=cause.probabilities,
        channel=effect.channel,
        claim=effect.signature.claim,
        equation=effect.equation,
        parameters=_shapes(extension, number - 1)
        | _coefficients(extension, number - 1, diagnosis.torque_unit),
        size=cause.size,
        p_value=cause.test.p_value,
        seen_in=effect.signature.axis,
        figure=f"diagnosis-{number}.svg",
        experiment=effect.experiment,
    )


def _unnamed_record(structure: Structure) -> CauseRecord:
    channel, axis = structure.channel, structure.axis
    return CauseRecord(
        effects=(),
        probabilities={},
        channel=channel,
        claim=f"Residuals of the {channel} have structure along {axis}.",
        equation="",
        parameters={},
        size=structure.size,
        p_value=structure.p_value,
        seen_in=axis,
        figure=None,
        experiment=f"Measure more values of {axis}, in random order, on another day.",
    )


def _coefficients(extension: Extension, number: int, unit: str) -> dict[str, ParameterRecord]:
    start = len(extension.names) + len(extension.gravity)
    start += sum(len(one.effect.coefficients) for one in extension.effects[:number])
    one = extension.effects[number]
    errors = extension.errors[start : start + len(one.coefficients)]
    return {
        parameter.name: _coefficient(parameter, value, error, unit)
        for parameter, value, error in zip(
            one.effect.coefficients, one.coefficients, errors, strict=True
        )
    }


def _coefficient(parameter: Parameter, value: float, error: float, unit: str) -> ParameterRecord:
    return ParameterRecord(
        estimate=float(value),
        ci95=(float(value - _Z95 * error), float(value + _Z95 * error)),
        unit=parameter.unit.replace(TORQUE, unit),
    )


def _shapes(extension: Extension, number: int) -> dict[str, ParameterRecord]:
    """Return an effect's shape parameters; what the data cannot tell spans its whole range."""
    start = sum(len(one.effect.shape) for one in extension.effects[:number])
    found = {}
    for axis, error in zip(
        extension.effects[number].effect.shape, extension.shape_errors[start:], strict=False
    ):
        value = extension.effects[number].shape[axis.name]
        reach = _Z95 * float(error) if error > 0 else np.inf
        interval = (max(value - reach, axis.lower), min(value + reach, axis.upper))
        found[axis.name] = ParameterRecord(estimate=value, ci95=interval, unit=axis.unit)
    return found
