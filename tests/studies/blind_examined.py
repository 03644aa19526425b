"""One world of the blind study: simulated, diagnosed, and compared with what is true of it."""

import json
import time
from typing import Any

import numpy as np

from frictioncli.diagnosis.diagnose import Diagnosis, diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.errors import OptionError
from frictioncli.model.document import PARAMETERS
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.studies.blind_truth import TEMPERATURE, Truth, truth_of
from tests.studies.blind_worlds import KEY, World

Z95 = 1.96
NOT_PLANTED = "not planted"
"""Verdict where the protocol cannot show the effect in that size."""

FAILED = "failed"
"""Verdict where the program broke down."""

FRICTION = tuple(f"{name}{end}" for name in PARAMETERS for end in ("", "_low", "_high"))

COLUMNS = (
    *KEY,
    "sources",
    "verdict",
    "sets",  # causes by ; strongest first, effects of a set by | most probable first
    "p_values",
    "truth_probability",  # of each hidden effect, by ;
    "visible_sets",
    "structure",
    "before",
    "after",
    "reduction",
    "reduction_low",
    "reduction_high",
    "floor",
    "oracle",
    "raw",
    "visible",
    "slight",  # what the base must leave of an effect for the diagnosis to ask about it
    "parameters",  # "extended", or "base" where nothing was found
    *FRICTION,
    "coefficient",
    "coefficient_truth",
    "coefficient_estimate",
    "coefficient_low",
    "coefficient_high",
    "detectable",
    "note",
    "seconds",
)


def examined(world: World, digest: str) -> dict[str, object]:
    """Simulate one world, diagnose it and return its row."""
    began = time.perf_counter()
    row: dict[str, object] = dict(zip(KEY, world.key, strict=True))
    row["sources"] = digest
    try:
        truth = truth_of(world)
        diagnosis = diagnose_joint(truth.torques, TEMPERATURE, "N·m", DiagnosisSettings())
        row |= _said(diagnosis, world) | _gained(diagnosis, truth)
        row |= _parameters(diagnosis, truth) | _coefficient(diagnosis, world, truth)
    except OptionError as error:
        row |= {"verdict": NOT_PLANTED, "note": str(error)}
    except Exception as error:  # one world that breaks down is a result, too
        row |= {"verdict": FAILED, "note": f"{type(error).__name__}: {error}"}
    row["seconds"] = f"{time.perf_counter() - began:.1f}"
    return row


def _said(diagnosis: Diagnosis, world: World) -> dict[str, object]:
    causes = diagnosis.causes
    probability = [
        max((cause.probabilities.get(name, 0.0) for cause in causes), default=0.0)
        for name in world.names
    ]
    left = diagnosis.structure
    return {
        "verdict": diagnosis.verdict,
        "sets": ";".join("|".join(cause.effects) for cause in causes),
        "p_values": ";".join(f"{cause.test.p_value:.3g}" for cause in causes),
        "truth_probability": ";".join(f"{value:.4g}" for value in probability),
        "visible_sets": ";".join("|".join(cause.effects) for cause in diagnosis.visible),
        "structure": "" if left is None else f"{left.channel} {left.axis} {left.p_value:.3g}",
        "detectable": "" if world.names else _detectable(diagnosis),
    }


def _detectable(diagnosis: Diagnosis) -> str:
    found = {name: float(f"{size:.4g}") for name, size in diagnosis.detectable.items() if size}
    return json.dumps(found)


def _gained(diagnosis: Diagnosis, truth: Truth) -> dict[str, object]:
    gain = diagnosis.gain
    slight = 1e-3 * float(np.mean(np.abs(diagnosis.base.friction)))
    row: dict[str, object] = {
        "before": f"{truth.before:.5g}",
        "oracle": f"{truth.oracle:.5g}",
        "raw": f"{truth.raw:.4g}",
        "visible": f"{truth.visible:.4g}",
        "slight": f"{slight:.4g}",
    }
    if gain is not None:
        row |= {
            "after": f"{gain.after:.5g}",
            "reduction": f"{gain.reduction:.5f}",
            "reduction_low": f"{gain.interval[0]:.5f}",
            "reduction_high": f"{gain.interval[1]:.5f}",
            "floor": f"{gain.floor:.4g}",
        }
    return row


def _parameters(diagnosis: Diagnosis, truth: Truth) -> dict[str, object]:
    """Return the friction parameters that the program hands out, with their intervals."""
    found: dict[str, tuple[float, float, float]] = {}
    extension = diagnosis.extension
    if extension is None:
        model = fit_joint(truth.torques, {}, FitSettings(temperature=TEMPERATURE))
        for name, one in model.parameters.items():
            if one.ci95 is not None:
                found[name] = (one.estimate, *one.ci95)
    else:
        size = len(extension.names)
        for name, change, error in zip(
            extension.names, extension.changes, extension.errors[:size], strict=True
        ):
            value = getattr(diagnosis.base.parameters, name) + float(change)
            found[name] = (value, value - Z95 * float(error), value + Z95 * float(error))
    row: dict[str, object] = {"parameters": "base" if extension is None else "extended"}
    for name, values in found.items():
        for end, value in zip(("", "_low", "_high"), values, strict=True):
            row[f"{name}{end}"] = f"{value:.6g}"
    return row


def _coefficient(diagnosis: Diagnosis, world: World, truth: Truth) -> dict[str, object]:
    """Return the coefficient that has a planted counterpart, where its effect was found."""
    if not truth.coefficient:
        return {}
    row: dict[str, object] = {
        "coefficient": truth.coefficient,
        "coefficient_truth": f"{truth.value:.6g}",
    }
    extension = diagnosis.extension
    if extension is None:
        return row
    start = len(extension.names) + len(extension.gravity)
    for one in extension.effects:
        names = [parameter.name for parameter in one.effect.coefficients]
        if one.effect.name == world.hidden:
            place = names.index(truth.coefficient)
            row |= _interval(float(one.coefficients[place]), float(extension.errors[start + place]))
        start += len(names)
    return row


def _interval(value: float, error: float) -> dict[str, Any]:
    return {
        "coefficient_estimate": f"{value:.6g}",
        "coefficient_low": f"{value - Z95 * error:.6g}",
        "coefficient_high": f"{value + Z95 * error:.6g}",
    }
