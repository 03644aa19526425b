r"""Algorithm 3 of the paper [1]_ as it runs in a controller, sample by sample.

:mod:`frictioncli.correction.schedule` processes a whole log and many schedules at once; this is one
schedule that uses only past samples. Both make the same corrections, which a test verifies.
``simulate`` uses this one, so that the simulated correction is the deployed one.

References
----------
.. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of industrial
   robot joint with temperature correction by example of KUKA KR10," J. Robotics, 2019,
   doi:10.1155/2019/6931563.
"""

import math
from dataclasses import dataclass, field

from frictioncli.correction.degree_crossings import DEGREE
from frictioncli.correction.settings import READINGS
from frictioncli.model.friction import (
    FrictionParameters,
    friction_torque,
    temperature_from_friction,
)


@dataclass(slots=True)
class TemperatureCorrector:
    r"""Friction model of a joint in operation, whose temperature is corrected when due.

    Call :meth:`update` with every sample of the motor temperature. Whenever :attr:`is_due`, move a
    pair at the correction speed as soon as the task allows, separate its friction and load torque
    by equation (8), and pass both to :meth:`correct`. :meth:`friction` is the estimate at any time.

    Parameters
    ----------
    parameters : FrictionParameters
        Parameters of (16); gamma and delta must be positive.
    k : float
        Scale of criterion (20).
    tmax : float
        Time after which a correction is forced. [s]
    reading : {"first_degree", "latest_degree"}
        Which change by 1 °C counts as :math:`\Delta t`.

    Attributes
    ----------
    correction : float
        Temperature correction in force, :math:`\Delta T` of (19); 0 before the first. [°C]
    motor_temperature : float
        Latest motor temperature; NaN before the first update. [°C]

    Examples
    --------
    A gear that is warmer than the motor: friction at 67.5 deg/s is that of (16) at 40 °C.

    >>> from frictioncli.model.friction import PUBLISHED
    >>> corrector = TemperatureCorrector(PUBLISHED, k=5, tmax=3600)
    >>> corrector.update(time=0.0, motor_temperature=30.0)
    >>> corrector.is_due
    True
    >>> measured = friction_torque(PUBLISHED, load=0.0, speed=67.5, temperature=40.0)
    >>> corrector.correct(friction=float(measured), load=0.0, speed=67.5)
    True
    >>> round(corrector.correction, 6)
    10.0
    """

    parameters: FrictionParameters
    k: float = 5.0
    tmax: float = 3600.0
    reading: str = "first_degree"
    correction: float = field(default=0.0, init=False)
    motor_temperature: float = field(default=math.nan, init=False)
    # of the latest sample
    _time: float = field(default=math.nan, init=False)
    _registered: float = field(default=math.nan, init=False)
    # of the last correction, and of the start of the current change by a degree
    _corrected_at: float = field(default=math.nan, init=False)
    _from_time: float = field(default=math.nan, init=False)
    _from_registered: float = field(default=math.nan, init=False)
    _degree_time: float = field(default=math.inf, init=False)

    def __post_init__(self) -> None:
        if self.reading not in READINGS:
            raise ValueError(f"reading {self.reading!r}: expected one of {', '.join(READINGS)}")

    def update(
        self, time: float, motor_temperature: float, registered: float | None = None
    ) -> None:
        """Process a sample of the motor temperature.

        Parameters
        ----------
        time : float
            Time of the sample, not before that of the latest one. [s]
        motor_temperature : float
            Motor temperature. [°C]
        registered : float, optional
            Motor temperature for the criterion, in whole degrees, where ``motor_temperature`` is
            known more precisely. [°C]
        """
        self._time, self.motor_temperature = time, motor_temperature
        self._registered = motor_temperature if registered is None else registered
        waiting = math.isinf(self._degree_time) or self.reading == "latest_degree"
        if waiting and abs(self._registered - self._from_registered) >= DEGREE:
            self._degree_time = time - self._from_time
            if self.reading == "latest_degree":
                self._from_time, self._from_registered = time, self._registered

    @property
    def is_due(self) -> bool:
        """Whether a correction is due by criterion (20); it is at the first sample."""
        if math.isnan(self._corrected_at):
            return not math.isnan(self._time)
        return self._time - self._corrected_at > min(self.k * self._degree_time, self.tmax)

    def correct(
        self,
        friction: float,
        load: float,
        speed: float,
        motor_temperature: float | None = None,
    ) -> bool:
        """Correct the temperature by a measured pair with equations (18) and (19).

        Parameters
        ----------
        friction, load : float
            Friction torque [torque unit] and load torque [N·m] of the pair, by (8).
        speed : float
            Speed of the pair, > 0. [deg/s]
        motor_temperature : float, optional
            Motor temperature of the pair; by default the latest one. [°C]

        Returns
        -------
        bool
            False where (18) has no solution: the last correction then stays in force. The criterion
            starts again in either case.
        """
        motor = self.motor_temperature if motor_temperature is None else motor_temperature
        effective = float(
            temperature_from_friction(self.parameters, friction=friction, load=load, speed=speed)
        )
        self._corrected_at = self._from_time = self._time
        self._from_registered, self._degree_time = self._registered, math.inf
        if math.isnan(effective):
            return False
        self.correction = effective - motor
        return True

    def friction(self, load: float, speed: float) -> float:
        """Return the friction torque by (16) at the corrected temperature (17).

        Parameters
        ----------
        load : float
            Load torque. [N·m]
        speed : float
            Absolute joint velocity. [deg/s]

        Returns
        -------
        float
            Friction torque. [torque unit]
        """
        temperature = self.motor_temperature + self.correction
        torque = friction_torque(self.parameters, load=load, speed=speed, temperature=temperature)
        return float(torque)
