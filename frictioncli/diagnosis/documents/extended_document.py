"""``extended-model.json``: its records, and how the extended model is read from them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import msgspec
from msgspec import UNSET, UnsetType

from frictioncli import documents
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.data.late_torque import LateTorque
from frictioncli.diagnosis.documents.empirical_record import EmpiricalRecord
from frictioncli.diagnosis.documents.extended_model import ExtendedModel, FittedEffect
from frictioncli.errors import TableError
from frictioncli.model.document import FrictionModel
from frictioncli.model.friction import FrictionParameters

_NO_GRAVITY = GravityCoefficients(cosine=0.0, sine=0.0, offset=0.0)

_MAGNITUDES = 100.0
"""Ratio of the ends of an interval from which on it does not tell the order of magnitude."""


class ParameterRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A fitted parameter.

    Attributes
    ----------
    estimate : float
        Its value. [unit]
    ci95 : (float, float) or None
        95 % confidence interval. [unit]
    unit : str
        Its unit.
    """

    estimate: float
    ci95: tuple[float, float] | None
    unit: str

    @property
    def is_determined(self) -> bool:
        """Whether its interval tells its sign and its order of magnitude."""
        return self._excludes_zero and not self.has_only_a_sign

    @property
    def has_only_a_sign(self) -> bool:
        """Whether its interval tells its sign, but not its order of magnitude."""
        near, far = sorted(map(abs, self.ci95 or (0.0, 0.0)))
        return self._excludes_zero and far > _MAGNITUDES * near

    @property
    def _excludes_zero(self) -> bool:
        return self.ci95 is not None and self.ci95[0] * self.ci95[1] > 0


class EffectRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An effect of the extended model.

    Attributes
    ----------
    name, equation : str
        Its name in the catalogue, and its equation.
    channel : {"friction", "load"}
        The torque that it adds to.
    shape : mapping of str to float
        Its shape parameters, in the units of the catalogue.
    coefficients : mapping of str to ParameterRecord
        Its coefficients.
    """

    name: str
    equation: str
    channel: str
    shape: Mapping[str, float]
    coefficients: Mapping[str, ParameterRecord]

    def fitted(self) -> FittedEffect:
        """Return the effect of the catalogue with these parameters."""
        estimates = {name: one.estimate for name, one in self.coefficients.items()}
        return FittedEffect.of(self.name, self.shape, estimates)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtendedDocument(FrictionModel):
    """One joint of ``extended-model.json``: the model with the effects found, all refitted.

    Attributes
    ----------
    effects : tuple of EffectRecord
        The effects, in the order of the causes, then effects of the measurement that are corrected
        without a name. Without any the following fields are absent.
    linear_about : FrictionParameters
        Parameters of the base about which the extended model is linear.
    gravity_about, gravity : GravityCoefficients
        Gravity of the base, and as refitted.
    hidden_temperature : HiddenTemperature
        Temperature of the gear at which friction is evaluated; absent where that is the measured
        one.
    empirical : EmpiricalRecord
        Torque without a known cause; absent where a term for it is not worth using.
    late_torque : LateTorque
        Response behind which the torque was logged, and with it the effects; absent where it is not
        known to be late.
    """

    effects: tuple[EffectRecord, ...]
    linear_about: FrictionParameters | UnsetType = UNSET
    gravity_about: GravityCoefficients | UnsetType = UNSET
    gravity: GravityCoefficients | UnsetType = UNSET
    hidden_temperature: HiddenTemperature | UnsetType = UNSET
    empirical: EmpiricalRecord | UnsetType = UNSET
    late_torque: LateTorque | UnsetType = UNSET


def read_extended(path: Path) -> dict[int, ExtendedModel]:
    """Return the extended model of each joint, by number.

    Raises
    ------
    TableError
        If the file is missing, damaged, or names an effect that the catalogue does not have.
    """
    stated = documents.read_joints(path, ExtendedDocument, "diagnose")
    with documents.locate_faults(path, "diagnose"):
        return {one.joint: extended_model(one) for one in stated}


def extended_model(document: ExtendedDocument) -> ExtendedModel:
    """Return a joint's extended model from its document.

    Raises
    ------
    TableError
        If it names an effect that the catalogue does not have, or with other parameters, lacks
        what the effects are refitted with, or has an empirical term that is no function.
    """
    if not document.effects and not document.empirical:
        return ExtendedModel(
            temperature=document.temperature,
            parameters=document.friction,
            about=document.friction,
            gravity=_NO_GRAVITY,
            gravity_about=_NO_GRAVITY,
            effects=(),
        )
    if not (document.linear_about and document.gravity and document.gravity_about):
        raise TableError("expected linear_about, gravity and gravity_about as well")
    empirical = document.empirical or None
    if empirical is not None:
        empirical.check()
    return ExtendedModel(
        temperature=document.temperature,
        parameters=document.friction,
        about=document.linear_about,
        gravity=document.gravity,
        gravity_about=document.gravity_about,
        effects=tuple(one.fitted() for one in document.effects),
        hidden=document.hidden_temperature or None,
        empirical=empirical,
        late=document.late_torque or None,
    )
