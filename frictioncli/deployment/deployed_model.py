"""Deployed joint: friction model, correction schedule and extension."""

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from numpy.typing import ArrayLike, NDArray

from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.correction.settings import MIDDLE_SPEED, ScheduleSettings
from frictioncli.deployment.extended_corrector import ExtendedCorrector
from frictioncli.deployment.extension import DeployedExtension
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import FrictionModel
from frictioncli.model.friction import FrictionParameters, friction_torque


@dataclass(frozen=True, slots=True, kw_only=True)
class DeployedModel:
    """Friction of one joint for use outside this program.

    Attributes
    ----------
    model : FrictionModel
        Equation (16) with intervals, units and ranges.
    schedule : ScheduleSettings
        Default schedule of corrections.
    correction_speed : float
        Speed of the pairs that corrections use. [deg/s]
    extension : DeployedExtension or None
        Deployable part of the extended model, if it is exported.
    origin : mapping of str to str
        SHA-256 of each file that the joint was made from, by name.
    version : str
        Version of frictioncli that made it.
    """

    model: FrictionModel
    schedule: ScheduleSettings
    correction_speed: float
    extension: DeployedExtension | None
    origin: Mapping[str, str]
    version: str

    @property
    def base(self) -> FrictionParameters:
        """Parameters of (16) that corrections use; the extension is linear about them."""
        return self.extension.about if self.extension else self.model.friction

    @property
    def load_unit(self) -> str:
        """Unit of the load: N·m where the log has a load channel, else that of the torque."""
        own = "N·m" in self.model.parameters["alpha"].unit
        return "N·m" if own else self.model.torque_unit

    @property
    def can_correct(self) -> bool:
        """Whether friction depends on temperature, so that (18) can be solved."""
        return self.base.gamma > 0 and self.base.delta > 0

    def friction(
        self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike
    ) -> NDArray[Any]:
        """Return the friction torque by (16) and the extension, with the gear as warm as the motor.

        Parameters
        ----------
        load : array_like
            Load torque. [N·m]
        speed : array_like
            Absolute velocity. [deg/s]
        temperature : array_like
            Temperature. [°C]

        Returns
        -------
        ndarray
            Friction torque. [torque unit]
        """
        torque = friction_torque(self.base, load=load, speed=speed, temperature=temperature)
        if self.extension:
            torque = torque + self.extension.added_friction(
                load=load, speed=speed, temperature=temperature, excess=0.0
            )
        return torque

    def corrector(self) -> TemperatureCorrector | ExtendedCorrector:
        """Return a new corrector: Algorithm 3 for a controller.

        Raises
        ------
        NotEnoughData
            If the model does not depend on temperature.
        """
        if not self.can_correct:
            raise NotEnoughData(
                f"joint {self.model.joint}: no corrector, as {no_correction_reason(self.model)}"
            )
        corrector = TemperatureCorrector(
            self.base,
            k=self.schedule.k,
            tmax=self.schedule.tmax,
            reading=self.schedule.criterion,
        )
        if self.extension is None:
            return corrector
        return ExtendedCorrector(corrector, self.extension, self.model.temperature)

    def _repr_html_(self) -> str:
        """Return the model's table and the correction rule, for notebooks."""
        rule = (
            f"correction at about {self.correction_speed:.3g} deg/s, {self.schedule.describe('')}"
        )
        text = rule if self.can_correct else f"no correction: {no_correction_reason(self.model)}"
        return f"{self.model._repr_html_()}<p>{escape(text)}</p>"


def no_correction_reason(model: FrictionModel) -> str:
    """Return why a model allows no corrections, as a clause."""
    reason = model.parameters["delta"].reason or model.parameters["gamma"].reason
    return f"the model has no dependence of friction on temperature ({reason})"


def default_correction_speed(model: FrictionModel) -> float:
    """Return the default speed of corrections: two thirds of the highest in the data [deg/s]."""
    limits = model.range.speed
    assert limits is not None  # every model has speeds
    return MIDDLE_SPEED * limits[1]
