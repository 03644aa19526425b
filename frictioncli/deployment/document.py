"""The JSON document of a deployed joint: all that a program needs that knows nothing of this."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from frictioncli.correction.settings import ScheduleSettings
from frictioncli.deployment.deployed_model import DeployedModel, default_correction_speed
from frictioncli.deployment.extension import LAG, DeployedExtension
from frictioncli.deployment.gear_temperature import GearLag
from frictioncli.diagnosis.documents.extended_model import FittedEffect
from frictioncli.errors import FrictionError, TableError
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.model.friction import FrictionParameters

SCHEMA = "frictioncli-deployed/1"
"""What the JSON document calls itself; the number grows when keys change their meaning."""


def deployed_document(joint: DeployedModel) -> dict[str, Any]:
    """Return a deployed joint as plain values: ``model.json`` of one joint, and more."""
    rule = joint.schedule
    correction = {
        "criterion": rule.criterion,
        "k": rule.k,
        "tmax": rule.tmax,
        "tmax_unit": "s",
        "speed": joint.correction_speed,
        "speed_unit": "deg/s",
    }
    return (
        {"schema": SCHEMA}
        | asdict(joint.model)
        | {
            "correction": correction if joint.can_correct else None,
            "extension": None if joint.extension is None else _extension_document(joint.extension),
            "made_by": {"program": "frictioncli", "version": joint.version},
            "made_from": dict(joint.origin),
        }
    )


def load_deployed(path: Path) -> DeployedModel:
    """Return the joint that ``frictioncli export --to json`` wrote.

    Raises
    ------
    TableError
        If the file is missing, of another kind or damaged.
    """
    if not path.exists():
        raise TableError(f"{path} is missing; make it with 'frictioncli export --to json'")
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
        found = whole.get("schema")
        if found != SCHEMA:
            raise TableError(f"schema {found!r}, expected {SCHEMA!r}")
        # it holds all that model.json does
        (model,) = read_models(path)
        return _deployed(whole, model)
    except (FrictionError, ValueError, LookupError, TypeError, AttributeError) as error:
        told = str(error) if isinstance(error, FrictionError) else repr(error)
        raise TableError(
            f"{path}: is not what 'frictioncli export --to json' writes ({told}); make it again"
        ) from error


def _deployed(whole: Mapping[str, Any], model: FrictionModel) -> DeployedModel:
    rule, extension = whole["correction"], whole["extension"]
    schedule = ScheduleSettings()
    if rule is not None:
        schedule = ScheduleSettings(
            criterion=rule["criterion"], k=float(rule["k"]), tmax=float(rule["tmax"])
        )
    return DeployedModel(
        model=model,
        schedule=schedule,
        correction_speed=float(rule["speed"]) if rule else default_correction_speed(model),
        extension=None if extension is None else _extension(extension),
        origin=dict(whole["made_from"]),
        version=str(whole["made_by"]["version"]),
    )


def _extension_document(extension: DeployedExtension) -> dict[str, Any]:
    effects = [
        {
            "name": term.effect.name,
            "equation": term.effect.equation,
            "shape": dict(term.shape),
            "coefficients": {
                parameter.name: {"estimate": float(value), "unit": parameter.unit}
                for parameter, value in zip(
                    term.effect.coefficients, term.coefficients, strict=True
                )
            },
        }
        for term in extension.terms
    ]
    return {
        "linear_about": asdict(extension.about),
        "parameters": asdict(extension.parameters),
        LAG: None if extension.gear is None else extension.gear.as_dict(),
        "effects": effects,
        "left_out": dict(extension.left_out),
    }


def _extension(document: Mapping[str, Any]) -> DeployedExtension:
    gear = document[LAG]
    return DeployedExtension(
        about=FrictionParameters(**document["linear_about"]),
        parameters=FrictionParameters(**document["parameters"]),
        gear=None if gear is None else GearLag.of(gear),
        terms=tuple(_fitted(entry) for entry in document["effects"]),
        left_out=dict(document["left_out"]),
    )


def _fitted(entry: Mapping[str, Any]) -> FittedEffect:
    shape = {name: float(value) for name, value in entry["shape"].items()}
    estimates = {name: float(one["estimate"]) for name, one in entry["coefficients"].items()}
    return FittedEffect.of(entry["name"], shape, estimates)
