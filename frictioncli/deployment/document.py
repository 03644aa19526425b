"""The JSON document of a deployed joint: all that another program needs."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import msgspec

from frictioncli import documents
from frictioncli.correction.settings import ScheduleSettings
from frictioncli.deployment.deployed_model import DeployedModel, default_correction_speed
from frictioncli.deployment.extension import DeployedExtension
from frictioncli.deployment.gear_temperature import GearLag
from frictioncli.diagnosis.documents.extended_model import FittedEffect
from frictioncli.diagnosis.empirical.term import EmpiricalTerm
from frictioncli.errors import FrictionError, TableError
from frictioncli.files import is_there
from frictioncli.model.document import FrictionModel
from frictioncli.model.friction import FrictionParameters

SCHEMA = "frictioncli-deployed/1"
"""Name of the form of the document; the number grows when keys change their meaning."""


class CorrectionRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The rule that says when to correct.

    Attributes
    ----------
    criterion : str
        One of :data:`frictioncli.correction.settings.CRITERIA`.
    k : float
        Scale of criterion (20). [1]
    tmax : float
        Time that forces a correction. [s]
    tmax_unit : str
        ``s``.
    speed : float
        Speed of the moves that corrections use. [deg/s]
    speed_unit : str
        ``deg/s``.
    """

    criterion: str
    k: float
    tmax: float
    tmax_unit: str = "s"
    speed: float
    speed_unit: str = "deg/s"


class CoefficientRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A coefficient of an effect.

    Attributes
    ----------
    estimate : float
        Its value. [unit]
    unit : str
        Its unit.
    """

    estimate: float
    unit: str


class DeployedEffectRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An effect without memory.

    Attributes
    ----------
    name, equation : str
        Its name in the catalogue, and its equation.
    shape : mapping of str to float
        Its shape parameters, in the units of the catalogue.
    coefficients : mapping of str to CoefficientRecord
        Its coefficients.
    """

    name: str
    equation: str
    shape: Mapping[str, float]
    coefficients: Mapping[str, CoefficientRecord]


class ExtensionRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The part of the extended model that a controller can carry.

    Attributes
    ----------
    linear_about, parameters : FrictionParameters
        Parameters of the base about which it is linear, and as refitted.
    thermal_lag : GearLag or None
        Temperature of the gear; none where it was not found to differ.
    effects : tuple of DeployedEffectRecord
        Effects without memory.
    left_out : mapping of str to str
        Effects that cannot be carried, and why.
    empirical : EmpiricalTerm or None
        Torque without a known cause, linear about the same base.
    """

    linear_about: FrictionParameters
    parameters: FrictionParameters
    thermal_lag: GearLag | None
    effects: tuple[DeployedEffectRecord, ...]
    left_out: Mapping[str, str]
    empirical: EmpiricalTerm | None = None


class ProgramRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The program that made a document.

    Attributes
    ----------
    program, version : str
        Its name and version.
    """

    program: str = "frictioncli"
    version: str


@dataclass(frozen=True, kw_only=True)
class SchemaHeader:
    """The first key of the document.

    Attributes
    ----------
    schema : str
        :data:`SCHEMA`.
    """

    schema: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DeployedDocument(FrictionModel, SchemaHeader):
    """A deployed joint: the keys of ``model.json`` for one joint, and more.

    Attributes
    ----------
    correction : CorrectionRecord or None
        When to correct; none where the model does not determine the temperature.
    extension : ExtensionRecord or None
        Part of the extended model.
    made_by : ProgramRecord
        The program.
    made_from : mapping of str to str
        Name of each input -> its SHA-256.
    """

    correction: CorrectionRecord | None
    extension: ExtensionRecord | None
    made_by: ProgramRecord
    made_from: Mapping[str, str]


def deployed_document(joint: DeployedModel) -> DeployedDocument:
    """Return a deployed joint as a document.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    """
    rule = joint.schedule
    correction = CorrectionRecord(
        criterion=rule.criterion, k=rule.k, tmax=rule.tmax, speed=joint.correction_speed
    )
    return DeployedDocument(
        schema=SCHEMA,
        **_model_fields(joint.model),
        correction=correction if joint.can_correct else None,
        extension=None if joint.extension is None else _extension_record(joint.extension),
        made_by=ProgramRecord(version=joint.version),
        made_from=joint.origin,
    )


def load_deployed(path: Path) -> DeployedModel:
    """Return the joint that ``frictioncli export --to json`` wrote.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    TableError
        If the file is missing, of another kind or damaged.
    """
    if not is_there(path):
        raise TableError(f"{path} is missing; make it with 'frictioncli export --to json'")
    try:
        content = path.read_bytes()
        found = documents.decode(content, _AnySchema).schema
        if found != SCHEMA:
            raise TableError(f"schema {found!r}, expected {SCHEMA!r}")
        return _deployed(documents.decode(content, DeployedDocument))
    except FrictionError as error:
        raise TableError(
            f"{path}: is not what 'frictioncli export --to json' writes ({error}); make it again"
        ) from error


class _AnySchema(msgspec.Struct):
    schema: str | None = None


def _model_fields(model: FrictionModel) -> dict[str, Any]:
    return {field.name: getattr(model, field.name) for field in fields(FrictionModel)}


def _deployed(document: DeployedDocument) -> DeployedModel:
    model = FrictionModel(**_model_fields(document))
    rule, extension = document.correction, document.extension
    schedule = ScheduleSettings()
    if rule is not None:
        schedule = ScheduleSettings(criterion=rule.criterion, k=rule.k, tmax=rule.tmax)
    return DeployedModel(
        model=model,
        schedule=schedule,
        correction_speed=rule.speed if rule else default_correction_speed(model),
        extension=None if extension is None else _extension(extension),
        origin=document.made_from,
        version=document.made_by.version,
    )


def _extension_record(extension: DeployedExtension) -> ExtensionRecord:
    effects = [
        DeployedEffectRecord(
            name=term.effect.name,
            equation=term.effect.equation,
            shape=term.shape,
            coefficients={
                parameter.name: CoefficientRecord(estimate=float(value), unit=parameter.unit)
                for parameter, value in zip(
                    term.effect.coefficients, term.coefficients, strict=True
                )
            },
        )
        for term in extension.terms
    ]
    return ExtensionRecord(
        linear_about=extension.about,
        parameters=extension.parameters,
        thermal_lag=extension.gear,
        effects=tuple(effects),
        left_out=extension.left_out,
        empirical=extension.empirical,
    )


def _extension(record: ExtensionRecord) -> DeployedExtension:
    if record.empirical is not None:
        record.empirical.check()
    return DeployedExtension(
        about=record.linear_about,
        parameters=record.parameters,
        gear=record.thermal_lag,
        terms=tuple(_fitted(effect) for effect in record.effects),
        left_out=record.left_out,
        empirical=record.empirical,
    )


def _fitted(record: DeployedEffectRecord) -> FittedEffect:
    estimates = {name: one.estimate for name, one in record.coefficients.items()}
    return FittedEffect.of(record.name, record.shape, estimates)
