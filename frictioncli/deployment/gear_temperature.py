r"""Gear temperature as a state that a controller updates from its measurements.

As in the effect ``thermal_lag`` (:mod:`frictioncli.effects.thermal_lag`), the temperature of the
gear lies

.. math:: E = a (F(T_m) - T_m) + b F(P/P_0) + h (T_c - T_m)

above that of the motor; F is a first-order low-pass filter with time constant :math:`\theta`.
Between samples the motor temperature is taken as linear and the friction power P as constant; for
these the update is exact at any sampling interval.
"""

import math
from dataclasses import dataclass, field

_SIGMAS = 1.959963984540054
"""Half-width of a 95 % interval in standard deviations."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GearLag:
    """Parameters of the gear temperature.

    Attributes
    ----------
    time_constant : float
        Time constant. [s]
    time_constant_ci95 : (float, float) or None
        95 % interval of the time constant. [s]
    lag_share : float
        Coefficient a: share of the motor temperature that the gear follows with lag. [1]
    friction_heating : float
        Coefficient b: gear above motor in equilibrium at the reference power. [°C]
    housing_share : float
        Coefficient h: share of the way from motor to housing temperature. [1]
    reference_power : float
        Reference power :math:`P_0`. [torque unit·deg/s]
    start_sd : float
        Standard deviation of the initial state, which is unknown: the RMS of E in the log. [°C]
    """

    time_constant: float
    time_constant_ci95: tuple[float, float] | None
    lag_share: float
    friction_heating: float
    housing_share: float
    reference_power: float
    start_sd: float


@dataclass(slots=True)
class _FirstOrderFilter:
    """State of the filters of motor temperature [°C] and of relative friction power [1]."""

    time_constant: float
    lag: float = 0.0
    heat: float = 0.0

    def step(self, duration: float, warming: float, power: float) -> None:
        """Advance by a duration [s] with a rise of motor temperature [°C] and a power [1]."""
        ratio = max(duration, 0.0) / self.time_constant
        decay, closed = math.exp(-ratio), -math.expm1(-ratio)
        self.lag = decay * self.lag - warming * (closed / ratio if ratio > 0 else 1.0)
        self.heat = decay * self.heat + power * closed


@dataclass(slots=True)
class GearTemperature:
    """Gear temperature above the motor temperature, updated sample by sample.

    The initial value is zero, because the history before is not known; :attr:`uncertainty` includes
    the resulting error.

    Parameters
    ----------
    parameters : GearLag
        Parameters of the gear temperature.

    Examples
    --------
    >>> gear = GearTemperature(
    ...     GearLag(
    ...         time_constant=1500.0,
    ...         time_constant_ci95=None,
    ...         lag_share=0.8,
    ...         friction_heating=6.0,
    ...         housing_share=0.0,
    ...         reference_power=5000.0,
    ...         start_sd=3.0,
    ...     )
    ... )
    >>> gear.update(time=0.0, motor_temperature=30.0)
    >>> gear.update(time=1500.0, motor_temperature=30.0, power=5000.0)
    >>> round(gear.excess, 3)
    3.793
    """

    parameters: GearLag
    _filters: list[_FirstOrderFilter] = field(init=False)
    _start_time: float = field(default=math.nan, init=False)
    _time: float = field(default=math.nan, init=False)
    _motor: float = field(default=math.nan, init=False)
    _housing_difference: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        estimate = self.parameters.time_constant
        ends = self.parameters.time_constant_ci95 or (estimate, estimate)
        self._filters = [_FirstOrderFilter(value) for value in (estimate, *ends)]

    def update(
        self,
        time: float,
        motor_temperature: float,
        housing_temperature: float = math.nan,
        power: float = 0.0,
    ) -> None:
        """Process a sample.

        Parameters
        ----------
        time : float
            Time of the sample, not before that of the latest one. [s]
        motor_temperature : float
            Motor temperature. [°C]
        housing_temperature : float
            Housing temperature; where it is NaN, that of the motor is taken. [°C]
        power : float
            Mean friction power, torque times speed, since the previous sample.
            [torque unit·deg/s]
        """
        if math.isnan(self._time):
            self._start_time = time
        else:
            warming = motor_temperature - self._motor
            relative_power = power / self.parameters.reference_power
            for one in self._filters:
                one.step(time - self._time, warming, relative_power)
        self._time, self._motor = time, motor_temperature
        difference = housing_temperature - motor_temperature
        self._housing_difference = 0.0 if math.isnan(difference) else difference

    @property
    def excess(self) -> float:
        """Gear temperature above the motor temperature, E [°C]."""
        return (
            self._filtered_excess(self._filters[0])
            + self.parameters.housing_share * self._housing_difference
        )

    @property
    def uncertainty(self) -> float:
        """Standard deviation of :attr:`excess` [°C].

        It includes the interval of the time constant, from the difference that its ends make, and
        the unknown initial state, which decays with the time constant; not the uncertainty of the
        three coefficients.
        """
        _, low, high = (self._filtered_excess(one) for one in self._filters)
        age = 0.0 if math.isnan(self._time) else self._time - self._start_time
        start = self.parameters.start_sd * math.exp(-age / self.parameters.time_constant)
        return math.hypot((high - low) / (2 * _SIGMAS), start)

    def _filtered_excess(self, state: _FirstOrderFilter) -> float:
        p = self.parameters
        return p.lag_share * state.lag + p.friction_heating * state.heat
