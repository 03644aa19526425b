r"""First-order thermal model of the motor, fitted to its recorded temperatures.

.. math:: \dot T = q\,P - \frac{T - T_a}{\theta}

with the friction power :math:`P = \tau v`. The time constant :math:`\theta` is scanned;
:math:`q` follows by least squares from the rises of temperature between pairs; :math:`T_a` is the
coldest start of a run.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags

_TIME_CONSTANTS = np.geomspace(1200.0, 28_800.0, 25)
"""Time constants that are tried; a joint takes tens of minutes to hours. [s]"""

_USUAL_TIME_CONSTANT = 6000.0
_TIME_CONSTANT_SPREAD = 0.7
"""Prior: median of the time constant [s] and standard deviation of its logarithm."""

_RISE_ERROR = 0.1
"""Standard error of a rise of temperature. [°C]"""

_USUAL_WARMING = 0.01
"""Rate of warming at the highest speed where the data do not show it. [°C/s]"""

_LEAST_INTERVAL = 120.0
"""Rises of temperature are taken over at least this time. [s]"""

_LEAST_DUTY = 0.5
"""Least share of recorded motion; below it, a warming motor indicates unrecorded motion."""

_LEAST_RATE = 0.4
"""Least rate of warming of a pause that counts as motion, relative to the median of the pauses that
warmed the motor."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalModel:
    """First-order model of a motor that is heated by friction power and cools to ambient.

    Attributes
    ----------
    ambient : float
        Ambient temperature, also that of a cold start. [°C]
    time_constant : float
        Thermal time constant. [s]
    heating : float
        Rate of warming per friction power. [°C/s per N·m·deg/s]
    housing_share : float
        Rise of the housing above ambient per rise of the motor. [-]
    """

    ambient: float
    time_constant: float
    heating: float
    housing_share: float

    def after(self, temperature: float, seconds: float, power: float = 0.0) -> float:
        """Return the motor temperature after a time at constant power.

        Parameters
        ----------
        temperature : float
            Motor temperature at the start. [°C]
        seconds : float
            Duration. [s]
        power : float
            Friction power. [N·m·deg/s]

        Returns
        -------
        float
            Motor temperature. [°C]

        Examples
        --------
        >>> model = ThermalModel(
        ...     ambient=20.0, time_constant=4000.0, heating=1e-6, housing_share=0.6
        ... )
        >>> round(model.after(60.0, 4000.0), 2)
        34.72
        """
        equilibrium = self.ambient + self.heating * power * self.time_constant
        decay = float(np.exp(-seconds / self.time_constant))
        return equilibrium + (temperature - equilibrium) * decay

    def seconds_to(self, temperature: float, cooler: float) -> float:
        """Return how long a motor at rest takes to cool [s].

        Parameters
        ----------
        temperature, cooler : float
            Motor temperature at the start and at the end, above ambient. [°C]
        """
        above, left = temperature - self.ambient, cooler - self.ambient
        return self.time_constant * float(np.log(above / left))

    def housing(self, motor: Array) -> Array:
        """Return the housing temperature that belongs to motor temperatures.

        Parameters
        ----------
        motor : ndarray
            Motor temperature. [°C]

        Returns
        -------
        ndarray
            Housing temperature. [°C]
        """
        return self.ambient + self.housing_share * (motor - self.ambient)


def thermal_model_of(torques: pd.DataFrame) -> ThermalModel | None:
    """Return the thermal model of one joint's motor; None where its temperature is not known.

    A motor that warms without motion between its pairs was moved unrecorded; it is taken to have
    moved at the highest recorded speed. If it was faster, the heating moves of a plan will take
    longer than predicted.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.

    Returns
    -------
    ThermalModel or None
        The fitted model.
    """
    pairs = torques.groupby(["run", "pair"], observed=True, sort=False).agg(
        time=("time", "first"),
        speed=("speed", "first"),
        motor=("motor_temperature", "first"),
        housing=("housing_temperature", "first"),
        friction=("friction_torque", "mean"),
        low=("position", "min"),
        high=("position", "max"),
    )
    pairs = pairs.reset_index().sort_values(["run", "time"])
    if pairs["motor"].isna().any():
        return None
    starts = pairs.groupby("run", observed=True)["motor"].first()
    ambient = float(min(starts.min(), pairs["motor"].min()))
    fastest = pairs["speed"] == pairs["speed"].max()
    highest_power = float((pairs["friction"] * pairs["speed"])[fastest].mean())
    rise, temperature, power, seconds = _rises(pairs, highest_power)
    time_constant, heating = _fit(
        rise, temperature - ambient, power * seconds, seconds, _USUAL_WARMING / highest_power
    )
    housing = (pairs["housing"] - ambient).to_numpy(float)
    motor = (pairs["motor"] - ambient).to_numpy(float)
    share = float(housing @ motor / max(motor @ motor, 1e-9)) if np.isfinite(housing).all() else 1.0
    return ThermalModel(
        ambient=ambient,
        time_constant=time_constant,
        heating=heating,
        housing_share=min(max(share, 0.0), 1.0),
    )


def _rises(pairs: pd.DataFrame, highest_power: float) -> tuple[Array, Array, Array, Array]:
    """Return rise, mean temperature, power and duration of intervals between pairs.

    Parameters
    ----------
    pairs : DataFrame
        One row per pair, in order of time within each run.
    highest_power : float
        Friction power at the highest speed, taken for unrecorded motion. [N·m·deg/s]
    """
    found: list[tuple[float, float, float, float, bool]] = []
    for _, run in pairs.groupby("run", observed=True):
        time, motor = run["time"].to_numpy(float), run["motor"].to_numpy(float)
        stroke = 2 * (run["high"] - run["low"]).to_numpy(float)
        speed, friction = run["speed"].to_numpy(float), run["friction"].to_numpy(float)
        begin = 0
        for end in range(1, len(run)):
            interval = time[end] - time[begin]
            if interval < _LEAST_INTERVAL:
                continue
            rise = motor[end] - motor[begin]
            between = slice(begin, end)
            moving = float(np.sum(stroke[between] / speed[between]))
            unrecorded = moving < _LEAST_DUTY * interval and rise > 0
            recorded_power = float(np.sum((stroke * friction)[between])) / interval
            power = highest_power if unrecorded else recorded_power
            found.append((rise, (motor[end] + motor[begin]) / 2, power, interval, unrecorded))
            begin = end
    rise, temperature, power, seconds, flags = np.array(found, dtype=float).reshape(-1, 5).T
    kept = (flags == 0) | _moved_throughout(rise, seconds, flags > 0)
    return rise[kept], temperature[kept], power[kept], seconds[kept]


def _moved_throughout(rise: Array, seconds: Array, warmed: Flags) -> Flags:
    """Return whether the joint moved throughout each pause that warmed the motor.

    Parameters
    ----------
    rise, seconds : ndarray, shape (pauses,)
        Rise of the motor's temperature, and duration. [°C], [s]
    warmed : ndarray of bool, shape (pauses,)
        Pauses that warmed it.

    Returns
    -------
    ndarray of bool, shape (pauses,)
        Pauses that warmed it at 0.4 times the median rate at least.

    Examples
    --------
    >>> import numpy as np
    >>> pauses = np.array([True, True, True])
    >>> _moved_throughout(np.array([6.0, 5.0, 1.0]), np.array([600.0, 500.0, 900.0]), pauses)
    array([ True,  True, False])
    """
    if not warmed.any():
        return warmed
    rate = np.divide(rise, seconds, out=np.zeros_like(rise), where=warmed)
    return warmed & (rate >= _LEAST_RATE * float(np.median(rate[warmed])))


def _fit(
    rise: Array, above: Array, heat: Array, seconds: Array, usual: float
) -> tuple[float, float]:
    """Return the time constant and the heating with the least cost.

    Parameters
    ----------
    rise, above : ndarray, shape (intervals,)
        Rise of temperature, and mean temperature above ambient. [°C]
    heat : ndarray, shape (intervals,)
        Friction power times duration. [N·m·deg]
    seconds : ndarray, shape (intervals,)
        Duration. [s]
    usual : float
        Heating where the data do not show any. [°C/s per N·m·deg/s]
    """
    best = (np.inf, _USUAL_TIME_CONSTANT, usual)
    prior = 1e-2 * max(float(heat @ heat), 1.0)
    for time_constant in _TIME_CONSTANTS:
        gain = rise + above * seconds / time_constant
        heating = max(float((heat @ gain + prior * usual) / (heat @ heat + prior)), 0.0)
        misfit = float(np.sum(np.square((gain - heating * heat) / _RISE_ERROR)))
        deviation = float(np.log(time_constant / _USUAL_TIME_CONSTANT)) / _TIME_CONSTANT_SPREAD
        cost = misfit + deviation**2
        if cost < best[0]:
            best = (cost, float(time_constant), heating)
    return best[1], best[2]
