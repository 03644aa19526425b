"""The corrector of a joint with an extended model: the gear's temperature goes along as a state."""

import math
from dataclasses import dataclass, field

from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.deployment.extension import DeployedExtension
from frictioncli.deployment.gear_temperature import GearTemperature


@dataclass(slots=True)
class ExtendedCorrector:
    """As :class:`TemperatureCorrector`, with the friction that the extension adds.

    What is corrected is the base model's temperature: a measured pair is freed of the extension's
    friction first, and the prediction gets it back.

    Parameters
    ----------
    inner : TemperatureCorrector
        A new one, on the parameters about which the extension is linear.
    extension : DeployedExtension
        What the extended model adds.
    temperature : {"motor", "housing", "mean"}
        Temperature that the base is given in the extension.
    """

    inner: TemperatureCorrector
    extension: DeployedExtension
    temperature: str = "motor"
    gear: GearTemperature | None = field(init=False)
    _housing: float = field(default=math.nan, init=False)

    def __post_init__(self) -> None:
        lag = self.extension.gear
        self.gear = None if lag is None else GearTemperature(lag)

    def update(
        self,
        time: float,
        motor_temperature: float,
        registered: float | None = None,
        *,
        housing_temperature: float = math.nan,
        power: float = 0.0,
    ) -> None:
        """Take in a sample.

        Parameters
        ----------
        time, motor_temperature, registered
            As :meth:`TemperatureCorrector.update`.
        housing_temperature : float
            Temperature of the housing; NaN where it is not known. [°C]
        power : float
            Mean of friction torque times speed since the sample before: what warms the gear.
            [torque unit·deg/s]
        """
        self.inner.update(time, motor_temperature, registered)
        self._housing = housing_temperature
        if self.gear is not None:
            self.gear.update(time, motor_temperature, housing_temperature, power)

    @property
    def is_due(self) -> bool:
        """Whether criterion (20) asks for a correction."""
        return self.inner.is_due

    @property
    def correction(self) -> float:
        """Temperature correction in force. [°C]."""
        return self.inner.correction

    @property
    def motor_temperature(self) -> float:
        """The latest one. [°C]."""
        return self.inner.motor_temperature

    def correct(
        self,
        friction: float,
        load: float,
        speed: float,
        motor_temperature: float | None = None,
    ) -> bool:
        """Correct the temperature by a measured pair; as :meth:`TemperatureCorrector.correct`."""
        bare = friction - self.beyond(load, speed)
        return self.inner.correct(bare, load, speed, motor_temperature)

    def friction(self, load: float, speed: float) -> float:
        """Return the friction torque at a load [N·m] and a speed [deg/s]. [torque unit]."""
        return self.inner.friction(load, speed) + self.beyond(load, speed)

    def beyond(self, load: float, speed: float) -> float:
        """Return what the extension adds at a load [N·m] and a speed [deg/s]. [torque unit]."""
        excess = self.gear.excess if self.gear is not None else 0.0
        added = self.extension.beyond(
            load=load, speed=speed, temperature=self._given(), excess=excess
        )
        return float(added)

    def _given(self) -> float:
        """Return the temperature that the base is given. [°C]."""
        motor, housing = self.motor_temperature, self._housing
        return {"motor": motor, "housing": housing, "mean": (motor + housing) / 2}[self.temperature]
