r"""Gear temperature as a state that a controller updates from its measurements.

As in the effect ``thermal_lag`` (:mod:`frictioncli.effects.thermal_lag`), the temperature of the
gear lies

.. math:: E = a (F(T_m) - T) + b F(P/P_0) + h (T_h - T) + h_F (F(T_h) - T)

above the base model's temperature *T*; F is a first-order low-pass filter with time constant
:math:`\theta`. A housing that is not measured may be a second state that follows the motor. Between
samples temperatures are taken as linear and the friction power P as constant; for these the update
is exact at any sampling interval, but that a hidden housing counts as linear too.
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
        Coefficient a: share of the friction at a gear that follows the motor with lag. [1]
    friction_heating : float
        Coefficient b: gear warmer by this in equilibrium at the reference power. [°C]
    housing_share : float
        Coefficient h: share of the friction at the housing temperature. [1]
    housing_lag_share : float
        Coefficient hF: share of the friction at a gear that follows the housing with lag. [1]
    housing_time_constant : float or None
        Time constant of a housing that is not measured and follows the motor. [s]
    reference_power : float
        Reference power :math:`P_0`. [torque unit·deg/s]
    start_sd : float
        Standard deviation of the initial state, which is unknown: the RMS of what the filters add
        in the log. [°C]
    """

    time_constant: float
    time_constant_ci95: tuple[float, float] | None
    lag_share: float
    friction_heating: float
    housing_share: float
    housing_lag_share: float
    housing_time_constant: float | None
    reference_power: float
    start_sd: float


def _lagging(lag: float, ratio: float, rise: float) -> float:
    """Return a filter's output less its input after the input rose linearly.

    Parameters
    ----------
    lag : float
        The same before. [°C]
    ratio : float
        Duration over time constant. [-]
    rise : float
        Rise of the input. [°C]
    """
    return math.exp(-ratio) * lag - rise * (-math.expm1(-ratio) / ratio if ratio > 0 else 1.0)


@dataclass(slots=True)
class _Filters:
    """Filters of motor and housing, less their inputs [°C], and of relative friction power [1]."""

    time_constant: float
    motor: float = 0.0
    heat: float = 0.0
    housing: float = 0.0

    def step(self, duration: float, warming: float, power: float, housing_warming: float) -> None:
        """Advance by a duration [s] with rises of both temperatures [°C] and a power [1]."""
        ratio = max(duration, 0.0) / self.time_constant
        self.motor = _lagging(self.motor, ratio, warming)
        self.housing = _lagging(self.housing, ratio, housing_warming)
        self.heat = math.exp(-ratio) * self.heat - power * math.expm1(-ratio)


@dataclass(slots=True)
class GearTemperature:
    """Gear temperature above the motor temperature, updated sample by sample.

    The initial value is zero, because the history before is not known; :attr:`uncertainty` includes
    the resulting error.

    Parameters
    ----------
    parameters : GearLag
        Parameters of the gear temperature.
    temperature : {"motor", "housing", "mean"}
        Temperature of the base model.

    Examples
    --------
    >>> gear = GearTemperature(
    ...     GearLag(
    ...         time_constant=1500.0,
    ...         time_constant_ci95=None,
    ...         lag_share=0.8,
    ...         friction_heating=6.0,
    ...         housing_share=0.0,
    ...         housing_lag_share=0.0,
    ...         housing_time_constant=None,
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
    temperature: str = "motor"
    _filters: list[_Filters] = field(init=False)
    _start_time: float = field(default=math.nan, init=False)
    _time: float = field(default=math.nan, init=False)
    _motor: float = field(default=math.nan, init=False)
    _housing: float = field(default=math.nan, init=False)
    _hidden_lag: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        estimate = self.parameters.time_constant
        ends = self.parameters.time_constant_ci95 or (estimate, estimate)
        self._filters = [_Filters(value) for value in (estimate, *ends)]

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
            Housing temperature; where it is NaN, the latest one known, or else the motor's. [°C]
        power : float
            Mean friction power, torque times speed, since the previous sample.
            [torque unit·deg/s]
        """
        first = math.isnan(self._time)
        if first:
            self._start_time = self._time = time
            self._motor = motor_temperature
        duration, warming = time - self._time, motor_temperature - self._motor
        housing = self._housing_after(duration, motor_temperature, housing_temperature)
        rise = 0.0 if first else housing - self._housing
        if not first:
            relative_power = power / self.parameters.reference_power
            for one in self._filters:
                one.step(duration, warming, relative_power, rise)
        self._time, self._motor, self._housing = time, motor_temperature, housing

    def _housing_after(self, duration: float, motor: float, measured: float) -> float:
        """Return the temperature of the housing after a duration: measured or hidden [°C]."""
        slow = self.parameters.housing_time_constant
        if slow is not None:
            ratio = max(duration, 0.0) / slow
            self._hidden_lag = _lagging(self._hidden_lag, ratio, motor - self._motor)
            return motor + self._hidden_lag
        if not math.isnan(measured):
            return measured
        return motor if math.isnan(self._housing) else self._housing

    @property
    def excess(self) -> float:
        """Gear temperature above that of the base model, E [°C]."""
        if math.isnan(self._time):
            return 0.0
        p, motor, housing = self.parameters, self._motor, self._housing
        mean = (motor + housing) / 2
        base = {"motor": motor, "housing": housing, "mean": mean}[self.temperature]
        return (
            p.lag_share * (motor - base)
            + (p.housing_share + p.housing_lag_share) * (housing - base)
            + self._filtered_excess(self._filters[0])
        )

    @property
    def uncertainty(self) -> float:
        """Standard deviation of :attr:`excess` [°C].

        It includes the interval of the time constant, from the difference that its ends make, and
        the unknown initial state, which decays with the time constant; not the uncertainty of the
        coefficients.
        """
        _, low, high = (self._filtered_excess(one) for one in self._filters)
        age = 0.0 if math.isnan(self._time) else self._time - self._start_time
        start = self.parameters.start_sd * math.exp(-age / self.parameters.time_constant)
        return math.hypot((high - low) / (2 * _SIGMAS), start)

    def _filtered_excess(self, state: _Filters) -> float:
        p = self.parameters
        return (
            p.lag_share * state.motor
            + p.friction_heating * state.heat
            + p.housing_lag_share * state.housing
        )
