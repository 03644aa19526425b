r"""How the motor warms and cools, from the run's own temperatures.

.. math:: \dot T = q\,P - b\,(T - T_a)

with the friction power :math:`P = \tau v`. :math:`b` is scanned, :math:`q` follows by least squares
from the steps of temperature between pairs, and :math:`T_a` is the coldest start of a run.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.motion_history import moved_throughout

_TIMES = np.geomspace(1200.0, 28_800.0, 25)
"""Time constants that are tried; a joint takes tens of minutes to hours. [s]"""

_USUAL_TIME = 6000.0
_USUAL_SPREAD = 0.7
"""A usual time constant, and the standard deviation of its logarithm. [s], [-]"""

_ERROR = 0.1
"""Error of a rise of temperature between two moments. [°C]"""

_USUAL_HEATING = 0.01
"""Warming by moves at the highest speed where the data do not show it. [°C/s]"""

_SPAN = 120.0
"""Steps of temperature are taken over at least this time. [s]"""

_LEAST_DUTY = 0.5
"""With less recorded motion than this share of the time, a motor that warms was moved unrecorded.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalModel:
    """A motor that heats with the friction power and cools to ambient.

    Attributes
    ----------
    ambient : float
        Temperature to which it cools, and of a cold start. [°C]
    time_constant : float
        Time in which it closes 63 % of its distance to ambient. [s]
    heating : float
        Warming by friction power. [°C/s per N·m·deg/s]
    housing_share : float
        Rise of the housing per rise of the motor above ambient. [-]
    """

    ambient: float
    time_constant: float
    heating: float
    housing_share: float

    def after(self, temperature: float, seconds: float, power: float = 0.0) -> float:
        """Return the motor temperature after a time at constant power [°C].

        Parameters
        ----------
        temperature : float
            Before. [°C]
        seconds : float
            The time. [s]
        power : float
            Friction power. [N·m·deg/s]
        """
        end = self.ambient + self.heating * power * self.time_constant
        kept = float(np.exp(-seconds / self.time_constant))
        return end + (temperature - end) * kept

    def housing(self, temperature: float) -> float:
        """Return the housing temperature beside a motor temperature [°C]."""
        return self.ambient + self.housing_share * (temperature - self.ambient)


def thermal_model_of(torques: pd.DataFrame) -> ThermalModel | None:
    """Return how the motor of one joint warms; None where its temperature is not known.

    Where the log shows a warming motor without motion between its pairs, the joint was moved
    unrecorded; it is taken to have moved at the highest speed recorded. If it was faster, heating
    moves of a plan will take longer than predicted.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
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
    strongest = float((pairs["friction"] * pairs["speed"])[fastest].mean())
    rise, warm, power, seconds = _steps(pairs, strongest)
    usual = _USUAL_HEATING / strongest
    time_constant, heating = _fitted(rise, warm - ambient, power * seconds, seconds, usual)
    housing = (pairs["housing"] - ambient).to_numpy(float)
    motor = (pairs["motor"] - ambient).to_numpy(float)
    share = float(housing @ motor / max(motor @ motor, 1e-9)) if np.isfinite(housing).all() else 1.0
    return ThermalModel(
        ambient=ambient,
        time_constant=time_constant,
        heating=heating,
        housing_share=min(max(share, 0.0), 1.0),
    )


def _steps(pairs: pd.DataFrame, strongest: float) -> tuple[Array, Array, Array, Array]:
    """Return rises of temperature, mean temperature, power and duration of stretches.

    ``strongest`` is the friction power at the highest speed: that of moves not recorded.
    """
    found: list[tuple[float, float, float, float, bool]] = []
    for _, run in pairs.groupby("run", observed=True):
        time, motor = run["time"].to_numpy(float), run["motor"].to_numpy(float)
        stroke = 2 * (run["high"] - run["low"]).to_numpy(float)
        speed, friction = run["speed"].to_numpy(float), run["friction"].to_numpy(float)
        begin = 0
        for end in range(1, len(run)):
            span = time[end] - time[begin]
            if span < _SPAN:
                continue
            rise = motor[end] - motor[begin]
            between = slice(begin, end)
            hidden = float(np.sum(stroke[between] / speed[between])) < _LEAST_DUTY * span
            hidden = hidden and rise > 0
            power = strongest if hidden else float(np.sum((stroke * friction)[between])) / span
            found.append((rise, (motor[end] + motor[begin]) / 2, power, span, hidden))
            begin = end
    rises, warm, powers, spans, flags = np.array(found, dtype=float).reshape(-1, 5).T
    kept = (flags == 0) | moved_throughout(rises, spans, flags > 0)
    return rises[kept], warm[kept], powers[kept], spans[kept]


def _fitted(
    rise: Array, above: Array, heat: Array, seconds: Array, usual: float
) -> tuple[float, float]:
    """Return the time constant and the heating that suit rises of temperature best.

    Parameters
    ----------
    rise, above : ndarray, shape (stretches,)
        Rise, and mean temperature above ambient. [°C]
    heat, seconds : ndarray, shape (stretches,)
        Friction power times duration, and duration. [N·m·deg], [s]
    usual : float
        Heating where the data do not show any. [°C/s per N·m·deg/s]
    """
    best = (np.inf, _USUAL_TIME, usual)
    prior = 1e-2 * max(float(heat @ heat), 1.0)
    for time in _TIMES:
        wanted = rise + above * seconds / time
        heating = max(float((heat @ wanted + prior * usual) / (heat @ heat + prior)), 0.0)
        misfit = float(np.sum(np.square((wanted - heating * heat) / _ERROR)))
        cost = misfit + (float(np.log(time / _USUAL_TIME)) / _USUAL_SPREAD) ** 2
        if cost < best[0]:
            best = (cost, float(time), heating)
    return best[1], best[2]
