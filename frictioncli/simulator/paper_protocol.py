"""Motion program of the paper: the speed sweep and the thermal cycle."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.errors import OptionError
from frictioncli.simulator.joint import RoundTripMotion, SimulatedJoint
from frictioncli.simulator.motion_profile import Servo, move_duration
from frictioncli.simulator.thermal_history import MOTOR, History, ThermalHistory
from frictioncli.simulator.thermal_network import Ambient


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperProgram:
    """Motion program of an experiment.

    Attributes
    ----------
    sweep_speeds : tuple of float
        Speeds of the sweep, Algorithm 1 of the paper. [deg/s]
    cycle_speeds : tuple of float
        Speeds of a measuring series of the thermal cycle, Algorithm 2. [deg/s]
    heating_speed : float
        Speed of the moves that heat the joint between series. [deg/s]
    angles : tuple of float
        Angles between which the joint turns. [deg]
    lowest, highest : int
        Registered motor temperatures between which the cycle runs. [°C]
    dwell : float
        Standing time after each move. [s]
    pre_trigger : float
        Recorded time before the registered temperature changes. [s]
    lead : float
        Standing time at the start of a recording, the pre-trigger included. [s]
    pause : float
        Time between recordings of the sweep. [s]
    """

    sweep_speeds: tuple[float, ...]
    cycle_speeds: tuple[float, ...]
    heating_speed: float
    angles: tuple[float, float]
    lowest: int
    highest: int
    dwell: float
    pre_trigger: float
    lead: float
    pause: float

    def for_series(self, series: "MeasuringSeries") -> "PaperProgram":
        """Return the program with the angles of ``series``."""
        return self if series.angles is None else replace(self, angles=series.angles)

    def trips(self, speed: float) -> RoundTripMotion:
        """Return the continued round trips at one speed [deg/s]."""
        return RoundTripMotion(speed=speed, angles=self.angles, dwell=self.dwell)

    def trip_durations(self, servo: Servo, speeds: tuple[float, ...]) -> list[float]:
        """Return the duration of a round trip at each speed, dwells included [s]."""
        distance = abs(self.angles[1] - self.angles[0])
        return [
            2.0 * (move_duration(servo, distance=distance, speed=speed) + self.dwell)
            for speed in speeds
        ]

    def trip_begins(self, servo: Servo, speeds: tuple[float, ...]) -> Array:
        """Return the start of each round trip since the first sample of a recording [s]."""
        durations = self.trip_durations(servo, speeds)
        return np.asarray(self.lead + np.concatenate([[0.0], np.cumsum(durations)[:-1]]))

    def move_begins(self, servo: Servo, speeds: tuple[float, ...]) -> Array:
        """Return the start of each move since the first sample of a recording [s]."""
        halves = np.repeat(self.trip_durations(servo, speeds), 2) / 2.0
        return np.asarray(self.lead + np.concatenate([[0.0], np.cumsum(halves)[:-1]]))


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuringSeries:
    """A recording: its start and its round trips.

    Attributes
    ----------
    phase : str
        ``sweep``, ``heat-up`` or ``cool-down``.
    start : float
        Time of its first sample since the run's beginning, whole milliseconds. [s]
    speeds : tuple of float
        Speed of each round trip. [deg/s]
    payload_index : int
        Which of the run's payloads it is measured with.
    angles : tuple of float or None
        Angles between which it turns; None: the program's. [deg]
    """

    phase: str
    start: float
    speeds: tuple[float, ...]
    payload_index: int = 0
    angles: tuple[float, float] | None = None


def run_program(
    joint: SimulatedJoint,
    program: PaperProgram,
    ambient: Ambient,
    history_type: type[History] = ThermalHistory,
) -> tuple[History, tuple[MeasuringSeries, ...]]:
    """Run the sweep and then the thermal cycle from a joint at ambient temperature.

    The joint is heated from ``lowest`` while it is below ``highest``, then cools while it is above
    ``lowest``, with a measuring series at each change of the registered motor temperature.

    Parameters
    ----------
    joint : SimulatedJoint
        The joint.
    program : PaperProgram
        Speeds, angles and temperatures.
    ambient : Ambient
        Ambient temperature.
    history_type : type of History
        Integrator of the temperatures.

    Returns
    -------
    History
        Temperatures of the run.
    tuple of MeasuringSeries
        Its recordings, in order of time.

    Raises
    ------
    OptionError
        If the joint cannot reach the program's temperatures, or is above them from the start.
    """
    history = history_type(joint, ambient)
    series = [measure(joint, program, history, "sweep", (v,)) for v in program.sweep_speeds]
    sensor = joint.network.names.index(MOTOR)
    if history.state[sensor] >= program.lowest - 0.5:
        raise OptionError(
            f"the motor is at {history.state[sensor]:.1f} °C before the thermal cycle, which "
            f"begins at {program.lowest} °C; choose a lower ambient or a higher lowest temperature"
        )
    heating = program.trips(program.heating_speed)
    # The controller registers the nearest whole degree, so it changes at the half degrees.
    for level in range(program.lowest, program.highest + 1):
        passed = history.state[sensor] >= level - 0.5  # while the last series was measured
        if passed and level < program.highest:
            continue
        if not passed and not history.continue_until(level - 0.5, heating):
            raise OptionError(
                f"the motor does not reach {level} °C at {program.heating_speed} deg/s; "
                "choose a lower highest temperature"
            )
        # The highest temperature is measured once, as the beginning of cooling.
        phase = "heat-up" if level < program.highest else "cool-down"
        series.append(measure(joint, program, history, phase, program.cycle_speeds))
    for level in range(program.highest - 1, program.lowest, -1):
        if history.state[sensor] <= level + 0.5:
            continue
        if not history.continue_until(level + 0.5):
            raise OptionError(
                f"the motor does not cool to {level} °C at an ambient temperature of "
                f"{float(ambient.at(history.time)):.1f} °C; choose a lower ambient temperature"
            )
        series.append(measure(joint, program, history, "cool-down", program.cycle_speeds))
    return history, tuple(series)


def measure(
    joint: SimulatedJoint,
    program: PaperProgram,
    history: History,
    phase: str,
    speeds: tuple[float, ...],
) -> MeasuringSeries:
    """Continue the thermal history by one recording, and return the recording."""
    if phase == "sweep":
        history.continue_for(program.pause)
    start = round(history.time - program.pre_trigger, 3)
    history.continue_for(program.lead - program.pre_trigger)
    durations = program.trip_durations(joint.servo, speeds)
    for speed, duration in zip(speeds, durations, strict=True):
        history.continue_for(duration, program.trips(speed))
    return MeasuringSeries(phase=phase, start=start, speeds=speeds)
