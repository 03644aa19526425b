"""A joint as it is deployed: its model, when to correct it, and what of the extension it has."""

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
    """A joint's friction for use outside this program.

    Attributes
    ----------
    model : FrictionModel
        Equation (16) with intervals, units and ranges.
    schedule : ScheduleSettings
        When to correct, unless told otherwise.
    correction_speed : float
        Speed of the pairs that corrections use. [deg/s]
    extension : DeployedExtension or None
        What is carried of the extended model, if that was asked for.
    origin : mapping of str to str
        File of the work folder -> SHA-256: what it was made from.
    version : str
        Version of the program that made it.
    """

    model: FrictionModel
    schedule: ScheduleSettings
    correction_speed: float
    extension: DeployedExtension | None
    origin: Mapping[str, str]
    version: str

    @property
    def base(self) -> FrictionParameters:
        """Parameters of (16) that corrections work on: the extension is linear about them."""
        return self.extension.about if self.extension else self.model.friction

    @property
    def load_unit(self) -> str:
        """Unit of the load: N·m where the log has a load of its own, else that of the torque."""
        own = "N·m" in self.model.parameters["alpha"].unit
        return "N·m" if own else self.model.torque_unit

    @property
    def can_correct(self) -> bool:
        """Whether friction tells a temperature, so that (18) has a meaning."""
        return self.base.gamma > 0 and self.base.delta > 0

    def friction(
        self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike
    ) -> NDArray[Any]:
        """Return the friction torque by (16), with the gear as warm as the motor. [torque unit].

        Parameters
        ----------
        load, speed, temperature : array_like
            Load torque, absolute velocity and temperature. [N·m], [deg/s], [°C]
        """
        torque = friction_torque(self.base, load=load, speed=speed, temperature=temperature)
        if self.extension:
            torque = torque + self.extension.beyond(
                load=load, speed=speed, temperature=temperature, excess=0.0
            )
        return torque

    def corrector(self) -> TemperatureCorrector | ExtendedCorrector:
        """Return a new corrector: Algorithm 3 for a robot at work.

        Raises
        ------
        NotEnoughData
            If the model does not know how friction falls with temperature.
        """
        if not self.can_correct:
            raise NotEnoughData(
                f"joint {self.model.joint}: no corrector, as {why_no_correction(self.model)}"
            )
        inner = TemperatureCorrector(
            self.base,
            k=self.schedule.k,
            tmax=self.schedule.tmax,
            reading=self.schedule.criterion,
        )
        if self.extension is None:
            return inner
        return ExtendedCorrector(inner, self.extension, self.model.temperature)

    def _repr_html_(self) -> str:
        """Return the model's table and the correction rule, for notebooks."""
        rule = (
            f"correction at about {self.correction_speed:.3g} deg/s, {self.schedule.describe('')}"
        )
        said = rule if self.can_correct else f"no correction: {why_no_correction(self.model)}"
        return f"{self.model._repr_html_()}<p>{escape(said)}</p>"


def why_no_correction(model: FrictionModel) -> str:
    """Return why a model gives no corrections, as half a sentence."""
    reason = model.parameters["delta"].reason or model.parameters["gamma"].reason
    return f"the model does not know how friction falls with temperature ({reason})"


def middle_speed(model: FrictionModel) -> float:
    """Return the speed at which to correct: two thirds of the highest in the data. [deg/s]."""
    limits = model.range.speed
    assert limits is not None  # no model without speeds
    return MIDDLE_SPEED * limits[1]
