"""Where a simpler form has to fit: speeds, a load and a temperature, and what the data know."""

from dataclasses import dataclass

import numpy as np

from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.settings import ExportSettings
from frictioncli.errors import OptionError

Limits = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """Where to fit, and where the data have been.

    Attributes
    ----------
    speeds : (float, float)
        Speeds between which to fit. [deg/s]
    load, temperature : float
        Load and temperature at which to fit. [N·m], [°C]
    loads, temperatures : (float, float)
        Ranges of the data. [N·m], [°C]
    remarks : tuple of str
        What of it the data do not cover.
    """

    speeds: Limits
    load: float
    temperature: float
    loads: Limits
    temperatures: Limits
    remarks: tuple[str, ...]

    def told(self, load_unit: str) -> str:
        """Return the point of the fit in words; the load has the given unit."""
        low, high = self.speeds
        return (
            f"{low:.4g} to {high:.4g} deg/s, {self.temperature:.4g} °C, load {self.load:.4g}"
            f" {load_unit}"
        )


def conditions(joint: DeployedModel, settings: ExportSettings) -> Conditions:
    """Return where to fit: what the settings say, else what the data's ranges suggest.

    The load is the root mean square over the range of the data's loads, as friction goes with its
    square; the temperature is in the middle.

    Raises
    ------
    OptionError
        If the range of speeds is empty.
    """
    known = joint.model.range
    speeds = known.speed or (0.0, 0.0)
    loads, temperatures = known.load or (0.0, 0.0), known.temperature or (0.0, 0.0)
    given = Conditions(
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
    if not given.speeds[0] < given.speeds[1]:
        raise OptionError(
            f"--lowest, --highest: {given.speeds[0]:.4g} to {given.speeds[1]:.4g} deg/s is no range"
            f" of speeds; the data have {speeds[0]:.4g} to {speeds[1]:.4g}"
        )
    outside = [
        f"{name} {value:.4g} {unit} lies outside the data's {low:.4g} to {high:.4g}"
        for name, value, unit, (low, high) in (
            ("speed", given.speeds[0], "deg/s", speeds),
            ("speed", given.speeds[1], "deg/s", speeds),
            ("temperature", given.temperature, "°C", temperatures),
            ("load", abs(given.load), joint.load_unit, (0.0, max(map(abs, loads)))),
        )
        if not low <= value <= high
    ]
    return Conditions(
        speeds=given.speeds,
        load=given.load,
        temperature=given.temperature,
        loads=loads,
        temperatures=temperatures,
        remarks=tuple(outside),
    )


def _root_mean_square(low: float, high: float) -> float:
    """Return the root mean square of a quantity spread evenly over a range."""
    return float(np.sqrt((low**2 + low * high + high**2) / 3))
