"""``diagnosis.json`` and ``extended-model.json``, and the verdict in plain words."""

from dataclasses import asdict
from typing import Any

import numpy as np

from frictioncli.diagnosis.data.gravity import gravity_document
from frictioncli.diagnosis.diagnose import Diagnosis
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.search.cause_search import Cause
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects.base import Parameter
from frictioncli.model.document import PARAMETERS, FrictionModel
from frictioncli.quantities import TORQUE

_Z95 = 1.96


def diagnosis_document(diagnosis: Diagnosis, settings: DiagnosisSettings) -> dict[str, Any]:
    """Return one joint's diagnosis as plain values, in the form of the contract."""
    causes = [
        _cause_document(diagnosis, cause, number + 1)
        for number, cause in enumerate(diagnosis.causes)
    ]
    if diagnosis.structure is not None:
        causes.append(_unnamed_document(diagnosis))
    gain = diagnosis.gain
    return {
        "joint": diagnosis.joint,
        "verdict": diagnosis.verdict,
        "causes": causes,
        "visible": [
            {"effects": list(cause.effects), "size": cause.size, "p_value": cause.judged.p_value}
            for cause in diagnosis.visible
        ],
        "gain": None
        if gain is None
        else {
            "basis": gain.basis,
            "rmse_before": gain.before,
            "rmse_after": gain.after,
            "reduction": gain.reduction,
            "ci95": list(gain.interval),
            "noise_floor": gain.floor,
        },
        "detectable": diagnosis.detectable,
        "simulation": {
            "rmse": diagnosis.rmse,
            "worst": [asdict(place) for place in diagnosis.worst],
        },
        "ramps": _ramps_document(diagnosis),
        "torque_unit": diagnosis.torque_unit,
        "runs": list(diagnosis.runs),
        "held_out": diagnosis.held_out,
        "settings": asdict(settings),
    }


def _ramps_document(diagnosis: Diagnosis) -> dict[str, Any] | None:
    """Return what was measured outside the constant-velocity parts, if the log tells."""
    said = diagnosis.ramps
    if said is None:
        return None
    return {
        "inertia": {
            "estimate": said.inertia.value,
            "ci95": [said.inertia.low, said.inertia.high],
            "unit": f"{diagnosis.torque_unit}/(deg/s²)",
        },
        "rmse_before": said.rms_before,
        "rmse_after": said.rms_after,
        "log_odds_reversal_transient": said.log_odds,
        "moves": said.moves,
    }


def extended_document(diagnosis: Diagnosis, model: FrictionModel) -> dict[str, Any]:
    """Return the base model with the causes found, refitted, as plain values."""
    document = asdict(model)
    document["effects"] = []
    extension = diagnosis.extension
    if extension is None:
        return document
    base = diagnosis.base.parameters
    document["linear_about"] = {name: float(getattr(base, name)) for name in PARAMETERS}
    for name, change, error in zip(
        extension.names, extension.changes, extension.errors, strict=False
    ):
        value = getattr(base, name) + float(change)
        document["parameters"][name] |= {
            "estimate": value,
            "ci95": [value - _Z95 * float(error), value + _Z95 * float(error)],
        }
    document["gravity_about"] = gravity_document(diagnosis.base.gravity)
    document["gravity"] = gravity_document(extension.gravity)
    document["effects"] = [
        {
            "name": one.effect.name,
            "equation": one.effect.equation,
            "channel": one.effect.channel,
            "shape": one.shape,
            "coefficients": _coefficients(extension, number, diagnosis.torque_unit),
        }
        for number, one in enumerate(extension.effects)
    ]
    return document


def verdict_text(diagnosis: Diagnosis) -> str:
    """Return what is wrong, where, why we think so, what it is worth, what to measure next."""
    unit = diagnosis.torque_unit
    lines = [
        f"joint {diagnosis.joint}: {diagnosis.verdict}; the simulated torque misses the measured"
        f" one by {diagnosis.rmse:.3g} {unit} (RMS)"
    ]
    for cause in diagnosis.causes:
        effect = cause.score.effect
        shares = ", ".join(
            f"{name} {cause.probabilities.get(name, 0.0):.0%}" for name in cause.effects
        )
        lines.append(
            f"  {' or '.join(cause.effects)} ({shares}): {effect.summary} {cause.size:.2g} {unit}"
            f" RMS in the {effect.channel}, chance {cause.judged.p_value:.1g}"
        )
        lines.append(f"    seen: {effect.signature.claim}")
        lines.append(f"    next: {effect.experiment}")
    if diagnosis.structure is not None:
        left = diagnosis.structure
        lines.append(
            f"  structure that no effect of the catalogue explains: along {left.axis}, in the"
            f" {left.channel}, {left.size:.2g} {unit} RMS, chance {left.p_value:.1g}"
        )
    for cause in diagnosis.visible:
        lines.append(
            f"  {' or '.join(cause.effects)}: stands out of the noise ({cause.size:.2g} {unit} RMS,"
            f" chance {cause.judged.p_value:.1g}), but is not worth modelling"
        )
    if not diagnosis.causes and diagnosis.structure is None:
        lines.append(f"  no cause found; {_silence(diagnosis)}")
    if diagnosis.gain is not None:
        lines.append(f"  {_gain_text(diagnosis)}")
    return "\n".join(lines)


def _gain_text(diagnosis: Diagnosis) -> str:
    gain, unit = diagnosis.gain, diagnosis.torque_unit
    assert gain is not None  # only asked where something was found
    where = (
        f"on run {diagnosis.held_out}, new to the extension"
        if gain.basis == "new_run"
        else "within the same run, which flatters"
    )
    return (
        f"extended model: {gain.before:.3g} -> {gain.after:.3g} {unit} {where}, a gain of"
        f" {gain.reduction:.0%} ({gain.interval[0]:.0%} to {gain.interval[1]:.0%}); noise floor"
        f" {gain.floor:.2g} {unit}"
    )


def _silence(diagnosis: Diagnosis) -> str:
    sizes = [(size, name) for name, size in diagnosis.detectable.items() if size is not None]
    if not sizes:
        return "the data can show none of the effects"
    least, most = min(sizes), max(sizes)
    return (
        f"an effect would have been found four times in five from {least[0]:.2g}"
        f" ({least[1]}) to {most[0]:.2g} {diagnosis.torque_unit} RMS ({most[1]})"
    )


def _cause_document(diagnosis: Diagnosis, cause: Cause, number: int) -> dict[str, Any]:
    found = cause.score
    effect = found.effect
    extension = diagnosis.extension
    assert extension is not None  # there is one wherever there is a cause
    return {
        "effects": list(cause.effects),
        "probabilities": cause.probabilities,
        "channel": effect.channel,
        "claim": effect.signature.claim,
        "equation": effect.equation,
        "parameters": _shapes(extension, number - 1)
        | _coefficients(extension, number - 1, diagnosis.torque_unit),
        "size": cause.size,
        "p_value": cause.judged.p_value,
        "seen_in": effect.signature.axis,
        "figure": f"diagnosis-{number}.svg",
        "experiment": effect.experiment,
    }


def _unnamed_document(diagnosis: Diagnosis) -> dict[str, Any]:
    left = diagnosis.structure
    assert left is not None  # only asked where structure is left
    return {
        "effects": [],
        "probabilities": {},
        "channel": left.channel,
        "claim": f"Residuals of the {left.channel} have structure along {left.axis}.",
        "equation": "",
        "parameters": {},
        "size": left.size,
        "p_value": left.p_value,
        "seen_in": left.axis,
        "figure": None,
        "experiment": f"Measure more values of {left.axis}, in random order, on another day.",
    }


def _coefficients(extension: Extension, number: int, unit: str) -> dict[str, dict[str, Any]]:
    start = len(extension.names) + len(extension.gravity)
    start += sum(len(one.effect.coefficients) for one in extension.effects[:number])
    one = extension.effects[number]
    errors = extension.errors[start : start + len(one.coefficients)]
    return {
        parameter.name: _entry(parameter, value, error, unit)
        for parameter, value, error in zip(
            one.effect.coefficients, one.coefficients, errors, strict=True
        )
    }


def _entry(parameter: Parameter, value: float, error: float, unit: str) -> dict[str, Any]:
    return {
        "estimate": float(value),
        "ci95": [float(value - _Z95 * error), float(value + _Z95 * error)],
        "unit": parameter.unit.replace(TORQUE, unit),
    }


def _shapes(extension: Extension, number: int) -> dict[str, dict[str, Any]]:
    """Return an effect's shape parameters; what the data cannot tell spans its whole range."""
    start = sum(len(one.effect.shape) for one in extension.effects[:number])
    found = {}
    for axis, error in zip(
        extension.effects[number].effect.shape, extension.shape_errors[start:], strict=False
    ):
        value = extension.effects[number].shape[axis.name]
        reach = _Z95 * float(error) if error > 0 else np.inf
        interval = [max(value - reach, axis.lower), min(value + reach, axis.upper)]
        found[axis.name] = {"estimate": value, "ci95": interval, "unit": axis.unit}
    return found
