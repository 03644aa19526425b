"""Operating conditions at which a simplified form is fitted, and the ranges of the data."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.settings import ExportSettings
from frictioncli.errors import OptionError

Range = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingConditions:
    """Conditions of the fit, and the ranges of the data.

    Attributes
    ----------
    speeds : (float, float)
        Range of speeds of the fit. [deg/s]
    load : float
        Load torque of the fit. [N·m]
    temperature : float
        Temperature of the fit. [°C]
    loads : (float, float)
        Range of loads in the data. [N·m]
    temperatures : (float, float)
        Range of temperatures in the data. [°C]
    remarks : tuple of str
        Conditions that the data do not cover.
    """

    speeds: Range
    load: float
    temperature: float
    loads: Range
    temperatures: Range
    remarks: tuple[str, ...]

    def describe(self, load_unit: str) -> str:
        """Return the conditions of the fit as text, with the unit of the load."""
        low, high = self.speeds
        return (
            f"{low:.4g} to {high:.4g} deg/s, {self.temperature:.4g} °C, load {self.load:.4g}"
            f" {load_unit}"
        )


def operating_conditions(joint: DeployedModel, settings: ExportSettings) -> OperatingConditions:
    """Return the conditions of the fit by the settings, or else by the ranges of the data.

    The default load is the root mean square over the range of the data, because friction depends on
    its square; the default temperature is the middle of the range.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    settings : ExportSettings
        Settings of the export.

    Returns
    -------
    OperatingConditions
        The conditions.

    Raises
    ------
    OptionError
        If the range of speeds is empty.
    """
    measured = joint.model.range
    speeds = measured.speed or (0.0, 0.0)
    loads, temperatures = measured.load or (0.0, 0.0), measured.temperature or (0.0, 0.0)
    conditions = OperatingConditions(
        speeds=(
            speeds[0] if settings.lowest is None else settings.lowest,
            speeds[1] if settings.highest is None else settings.highest,
        ),
        load=_root_mean_square(*loads) if settings.load is None else settings.load,
        temperature=(
            sum(temperatures) / 2 if settings.temperature is None else settings.temperature
        ),
        loads=loads,
        temperatures=temperatures,
        remarks=(),
    )
    low, high = conditions.speeds
    if not low < high:
        raise OptionError(
            f"--lowest, --highest: {low:.4g} to {high:.4g} deg/s is no range"
            f" of speeds; the data have {speeds[0]:.4g} to {speeds[1]:.4g}"
        )
    outside = [
        f"{name} {value:.4g} {unit} is outside the range of the data, {low:.4g} to {high:.4g}"
        for name, value, unit, (low, high) in (
            ("speed", conditions.speeds[0], "deg/s", speeds),
            ("speed", conditions.speeds[1], "deg/s", speeds),
            ("temperature", conditions.temperature, "°C", temperatures),
            ("load", abs(conditions.load), joint.load_unit, (0.0, max(map(abs, loads)))),
        )
        if not low <= value <= high
    ]
    return replace(conditions, remarks=tuple(outside))


def _root_mean_square(low: float, high: float) -> float:
    """Return the root mean square of a uniform distribution over a range."""
    return float(np.sqrt((low**2 + low * high + high**2) / 3))
