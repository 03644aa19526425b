"""Enriched experiment: it separates effects that one thermal cycle cannot."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from frictioncli.errors import OptionError
from frictioncli.simulator.joint import MeanPower, RoundTripMotion, SimulatedJoint
from frictioncli.simulator.paper_protocol import MeasuringSeries, PaperProgram, measure
from frictioncli.simulator.thermal_history import MOTOR, History
from frictioncli.simulator.thermal_network import Ambient

SPEEDS = (2.3, 4.5, 8.2, 13.0, 21.0, 33.0, 50.0, 72.0, 101.2, 200.0)
"""Speeds of each series, in random order [deg/s]."""

PAYLOADS = (0.0, 2.0, 4.0)
"""Payloads added to that of the settings; each series has one of them at random [kg]."""

OTHER_HEAT_SHARE = (0.3, 0.9)
"""Shares of heat at the motor for the second cycle; the one further from the first is taken [-]."""

LEVEL_STEP = 5
"""Step of the motor temperature between series [K]."""

PAUSES = (120.0, 900.0)
"""Shortest and longest pause before a series [s]."""

PAUSE_SHARE = 0.4
"""Share of the series that follow a pause [-]."""


def run_enriched(
    joints: tuple[SimulatedJoint, ...],
    program: PaperProgram,
    ambient: Ambient,
    generator: np.random.Generator,
    history_type: type[History],
) -> tuple[History, tuple[MeasuringSeries, ...]]:
    """Run two thermal cycles, the second with another entry of heat.

    Parameters
    ----------
    joints : tuple of SimulatedJoint
        The joint with each payload.
    program : PaperProgram
        Moves and temperatures; its speeds are those of every series.
    ambient : Ambient
        Ambient temperature.
    generator : numpy.random.Generator
        Source of speed orders, payloads and pauses.
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
        If the joint cannot reach the program's temperatures.
    """
    experiment = _Experiment(joints, program, ambient, generator, history_type)
    experiment.series_at("sweep")
    for cycle in range(2):
        experiment.set_heat_entry(cycle)
        levels = [*range(program.lowest, program.highest, LEVEL_STEP), program.highest]
        for level in levels:
            experiment.heat_to(level)
            experiment.series_at("heat-up" if level < levels[-1] else "cool-down")
        for level in reversed(levels[1:-1]):
            experiment.cool_to(level)
            experiment.series_at("cool-down")
    return experiment.history, tuple(experiment.series)


def second_shares(shares: Mapping[str, float]) -> dict[str, float]:
    """Return the shares of heat per node in the second cycle from those in the first [-]."""
    motor = "motor" if "motor" in shares else MOTOR
    rest = 1.0 - shares[motor]
    other = max(OTHER_HEAT_SHARE, key=lambda value: abs(value - shares[motor]))
    return {
        name: other
        if name == motor
        else (1.0 - other) * (share / rest if rest > 0.0 else 1.0 / (len(shares) - 1))
        for name, share in shares.items()
    }


class _Experiment:
    """State of the experiment while it runs."""

    def __init__(
        self,
        joints: tuple[SimulatedJoint, ...],
        program: PaperProgram,
        ambient: Ambient,
        generator: np.random.Generator,
        history_type: type[History],
    ) -> None:
        self.history = history_type(joints[0], ambient)
        self.series: list[MeasuringSeries] = []
        self._joints = joints
        self._program = program
        self._generator = generator
        self._sensor = joints[0].network.names.index(MOTOR)
        self._powers: list[dict[RoundTripMotion, MeanPower]] = [{} for _ in joints]
        self._payload_order: list[int] = []
        self._payload = 0

    def set_heat_entry(self, cycle: int) -> None:
        """Set where heat enters: in the second cycle elsewhere than in the first."""
        if cycle == 0:
            return
        shares = second_shares(self._joints[0].heat.shares)
        self._joints = tuple(
            replace(joint, heat=replace(joint.heat, shares=shares)) for joint in self._joints
        )
        self._set_payload(self._payload)

    def heat_to(self, level: int) -> None:
        """Move until the motor is registered at ``level`` [°C]."""
        if self.history.state[self._sensor] >= level - 0.5:
            return
        heating = self._program.trips(self._program.heating_speed)
        if not self.history.continue_until(level - 0.5, heating):
            raise OptionError(
                f"the motor does not reach {level} °C at {self._program.heating_speed} deg/s; "
                "choose a lower highest temperature"
            )

    def cool_to(self, level: int) -> None:
        """Stand until the motor is registered at ``level`` [°C]."""
        if self.history.state[self._sensor] <= level + 0.5:
            return
        if not self.history.continue_until(level + 0.5):
            raise OptionError(
                f"the motor does not cool to {level} °C; choose a lower ambient temperature"
            )

    def series_at(self, phase: str) -> None:
        """Measure all speeds in random order with a random payload, at random after a pause."""
        paused = self._generator.random() < PAUSE_SHARE
        pause = float(self._generator.uniform(*PAUSES)) if paused else self._program.pause
        self.history.continue_for(pause)
        if not self._payload_order:
            self._payload_order = self._generator.permutation(len(self._joints)).tolist()
        self._set_payload(self._payload_order.pop())
        speeds = tuple(self._generator.permutation(self._program.cycle_speeds).tolist())
        joint = self._joints[self._payload]
        series = measure(joint, self._program, self.history, phase, speeds)
        self.series.append(replace(series, payload_index=self._payload))

    def _set_payload(self, index: int) -> None:
        self._payload = index
        self.history.use(self._joints[index], self._powers[index])
