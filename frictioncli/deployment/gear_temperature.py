r"""The gear's own temperature as a state that follows what a controller measures.

The same equation as the effect ``thermal_lag`` (:mod:`frictioncli.effects.thermal_lag`): friction
arises at a temperature

.. math:: E = a (F(T_m) - T_m) + b F(P/P_0) + h (T_c - T_m)

above the motor's, F being a first-order filter of time constant :math:`\theta`. Between samples the
motor's temperature is linear and the friction power P constant, for which the step is exact
however unevenly samples come.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Self

_SIGMAS = 1.959963984540054
"""Half the width of a 95 % interval, in standard deviations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GearLag:
    """How the temperature of friction departs from the motor's.

    Attributes
    ----------
    time_constant : float
        Time in which the gear closes 63 % of its lag. [s]
    time_constant_ci95 : (float, float) or None
        Its 95 % interval. [s]
    lag_share : float
        Share of the motor's course that the gear follows with delay. [1]
    friction_heating : float
        Gear above motor after long motion at the reference power. [°C]
    housing_share : float
        How far the temperature of friction lies from motor towards housing. [1]
    reference_power : float
        Friction power that counts as 1. [torque unit·deg/s]
    start_sd : float
        Standard deviation of the state at the start, when the past is not known: its root mean
        square in the log. [°C]
    """

    time_constant: float
    time_constant_ci95: tuple[float, float] | None
    lag_share: float
    friction_heating: float
    housing_share: float
    reference_power: float
    start_sd: float

    def as_dict(self) -> dict[str, Any]:
        """Return plain values, ready for JSON."""
        return asdict(self)

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Return the lag that plain values tell.

        Raises
        ------
        KeyError, TypeError, ValueError
            If one is missing or no number.
        """
        interval = values["time_constant_ci95"]
        numbers = {
            name: float(values[name]) for name in cls.__slots__ if name != "time_constant_ci95"
        }
        low_high = None if interval is None else (float(interval[0]), float(interval[1]))
        return cls(time_constant_ci95=low_high, **numbers)


@dataclass(slots=True)
class _FirstOrderLag:
    """One filter of the motor's temperature and of the friction power."""

    time_constant: float
    lag: float = 0.0
    heat: float = 0.0

    def step(self, duration: float, warming: float, power: float) -> None:
        """Go on by a time [s], in which the motor warms [°C] and friction gives off power [1]."""
        ratio = max(duration, 0.0) / self.time_constant
        decay, closed = math.exp(-ratio), -math.expm1(-ratio)
        self.lag = decay * self.lag - warming * (closed / ratio if ratio > 0 else 1.0)
        self.heat = decay * self.heat + power * closed


@dataclass(slots=True)
class GearTemperature:
    """The state: told the motor's temperature sample by sample, it knows the gear's.

    It starts as warm as the motor: what the gear has been through before is not known, and
    :attr:`uncertainty` says what that may amount to.

    Parameters
    ----------
    parameters : GearLag
        The gear's.
    """

    parameters: GearLag
    _followers: list[_FirstOrderLag] = field(init=False)
    _started: float = field(default=math.nan, init=False)
    _time: float = field(default=math.nan, init=False)
    _motor: float = field(default=math.nan, init=False)
    _towards_housing: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        middle = self.parameters.time_constant
        ends = self.parameters.time_constant_ci95 or (middle, middle)
        self._followers = [_FirstOrderLag(value) for value in (middle, *ends)]

    def update(
        self,
        time: float,
        motor_temperature: float,
        housing_temperature: float = math.nan,
        power: float = 0.0,
    ) -> None:
        """Take in a sample.

        Parameters
        ----------
        time : float
            Time of the sample, not before the one told last. [s]
        motor_temperature, housing_temperature : float
            Temperatures; the housing is taken to be as warm as the motor where it is NaN. [°C]
        power : float
            Mean of friction torque times speed since the sample before. [torque unit·deg/s]
        """
        if math.isnan(self._time):
            self._started = time
        else:
            warming = motor_temperature - self._motor
            share = power / self.parameters.reference_power
            for follower in self._followers:
                follower.step(time - self._time, warming, share)
        self._time, self._motor = time, motor_temperature
        distance = housing_temperature - motor_temperature
        self._towards_housing = 0.0 if math.isnan(distance) else distance

    @property
    def excess(self) -> float:
        """How much warmer than the motor the place of friction is. [°C]."""
        return (
            self._carried(self._followers[0])
            + self.parameters.housing_share * self._towards_housing
        )

    @property
    def uncertainty(self) -> float:
        """Standard deviation of :attr:`excess`. [°C].

        It holds the time constant's interval, as the difference that its ends make, and the unknown
        start, which fades with the time constant; not that the three shares are uncertain.
        """
        _, low, high = (self._carried(follower) for follower in self._followers)
        age = 0.0 if math.isnan(self._time) else self._time - self._started
        start = self.parameters.start_sd * math.exp(-age / self.parameters.time_constant)
        return math.hypot((high - low) / (2 * _SIGMAS), start)

    def _carried(self, follower: _FirstOrderLag) -> float:
        p = self.parameters
        return p.lag_share * follower.lag + p.friction_heating * follower.heat
