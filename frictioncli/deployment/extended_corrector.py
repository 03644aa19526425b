"""Temperature corrector with an extended model; the gear temperature is an additional state."""

import math
from dataclasses import dataclass, field

from frictioncli.correction.corrector import TemperatureCorrector
from frictioncli.deployment.extension import DeployedExtension
from frictioncli.deployment.gear_temperature import GearTemperature


@dataclass(slots=True)
class ExtendedCorrector:
    """Temperature corrector as :class:`TemperatureCorrector`, with the friction of the extension.

    The temperature of the base model is corrected: the friction of the extension is subtracted from
    a measured pair, and added to the prediction.

    Parameters
    ----------
    base : TemperatureCorrector
        New corrector with the parameters about which the extension is linear.
    extension : DeployedExtension
        Deployable part of the extended model.
    temperature : {"motor", "housing", "mean"}
        Temperature of the base model in the extension.
    """

    base: TemperatureCorrector
    extension: DeployedExtension
    temperature: str = "motor"
    gear: GearTemperature | None = field(init=False)
    _housing: float = field(default=math.nan, init=False)

    def __post_init__(self) -> None:
        lag = self.extension.gear
        self.gear = None if lag is None else GearTemperature(lag, self.temperature)

    def update(
        self,
        time: float,
        motor_temperature: float,
        registered: float | None = None,
        *,
        housing_temperature: float = math.nan,
        power: float = 0.0,
    ) -> None:
        """Process a sample.

        Parameters
        ----------
        time, motor_temperature, registered
            As for :meth:`TemperatureCorrector.update`.
        housing_temperature : float
            Temperature of the housing; where it is NaN, the latest one known, or else the motor's.
            [°C]
        power : float
            Mean friction power, torque times speed, since the previous sample.
            [torque unit·deg/s]
        """
        self.base.update(time, motor_temperature, registered)
        if not math.isnan(housing_temperature):
            self._housing = housing_temperature
        elif math.isnan(self._housing):
            self._housing = motor_temperature
        if self.gear is not None:
            self.gear.update(time, motor_temperature, housing_temperature, power)

    @property
    def is_due(self) -> bool:
        """Whether a correction is due by criterion (20)."""
        return self.base.is_due

    @property
    def correction(self) -> float:
        """Temperature correction in force [°C]."""
        return self.base.correction

    @property
    def motor_temperature(self) -> float:
        """Latest motor temperature [°C]."""
        return self.base.motor_temperature

    def correct(
        self,
        friction: float,
        load: float,
        speed: float,
        motor_temperature: float | None = None,
    ) -> bool:
        """Correct the temperature by a measured pair, as :meth:`TemperatureCorrector.correct`."""
        of_base = friction - self.added_friction(load, speed)
        return self.base.correct(of_base, load, speed, motor_temperature)

    def friction(self, load: float, speed: float) -> float:
        """Return the friction torque [torque unit] at a load [N·m] and a speed [deg/s]."""
        return self.base.friction(load, speed) + self.added_friction(load, speed)

    def added_friction(self, load: float, speed: float) -> float:
        """Return the torque of the extension [torque unit] at a load [N·m] and speed [deg/s]."""
        excess = self.gear.excess if self.gear is not None else 0.0
        added = self.extension.added_friction(
            load=load, speed=speed, temperature=self._base_temperature(), excess=excess
        )
        return float(added)

    def _base_temperature(self) -> float:
        """Return the uncorrected temperature of the base model [°C]."""
        motor, housing = self.motor_temperature, self._housing
        return {"motor": motor, "housing": housing, "mean": (motor + housing) / 2}[self.temperature]
