"""Temperatures of a run, integrated over intervals of one motion."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import OdeSolution, solve_ivp

from frictioncli.arrays import Array
from frictioncli.simulator.joint import MeanPower, RoundTripMotion, SimulatedJoint
from frictioncli.simulator.thermal_network import Ambient

MOTOR = "motor sensor"
HOUSING = "housing"
"""Thermal nodes with the two temperature sensors."""

LONGEST_WAIT = 24 * 3600.0
"""Longest time to wait for a temperature [s]."""


@dataclass(frozen=True, slots=True)
class MotionInterval:
    """An interval of one motion.

    Attributes
    ----------
    start, end : float
        Start and end. [s]
    power : MeanPower or None
        Dissipated power; none at rest.
    """

    start: float
    end: float
    power: MeanPower | None

    @property
    def turned(self) -> float:
        """Angle turned in it [deg]."""
        if self.power is None:
            return 0.0
        return float(np.degrees(self.power.turning)) * (self.end - self.start)


class History(ABC):
    """Temperatures of a joint, from ambient temperature on; each call continues the history."""

    def __init__(self, joint: SimulatedJoint, ambient: Ambient) -> None:
        self.ambient = ambient
        self._capacities = joint.network.capacities()
        self._conductance = joint.network.conductance_matrix()
        self._to_ambient = joint.network.to_ambient()
        self._motor = joint.network.names.index(MOTOR)
        self._intervals: list[MotionInterval] = []
        self.time = 0.0
        self.state = np.full(len(joint.network.nodes), float(ambient.at(0.0)))
        self.use(joint, {})

    def use(self, joint: SimulatedJoint, powers: dict[RoundTripMotion, MeanPower]) -> None:
        """Continue with another payload or entry of heat; ``powers`` caches dissipated powers."""
        self._joint = joint
        self._shares, self._copper_shares = joint.heat_shares(), joint.copper_shares()
        self._powers = powers

    def continue_for(self, duration: float, motion: RoundTripMotion | None = None) -> None:
        """Continue for a duration [s], at rest or with round trips."""
        self._continue(self.time + duration, motion, None)

    def continue_until(self, temperature: float, motion: RoundTripMotion | None = None) -> bool:
        """Continue until the motor reaches ``temperature`` [°C]; False if it never does."""
        return self._continue(max(self.time, LONGEST_WAIT), motion, temperature)

    def intervals(self) -> tuple[MotionInterval, ...]:
        """Return the intervals of motion and rest, in order of time."""
        return tuple(self._intervals)

    def heat_per_node(self, power: MeanPower, temperatures: Mapping[str, float]) -> Array:
        """Return the heat that enters at each node, at node temperatures in °C [W]."""
        if self._copper_shares is None:
            return np.asarray(self._shares * power(temperatures))
        copper, friction = power.parts(temperatures)
        return np.asarray(self._copper_shares * copper + self._shares * friction)

    @abstractmethod
    def at(self, time: ArrayLike) -> dict[str, Array]:
        """Return the temperatures at times [s] within the history, by node name [°C]."""

    def heat(self, times: Array) -> Array:
        """Return the power dissipated at times in s [W]."""
        starts = np.array([interval.start for interval in self._intervals])
        owner = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        temperatures = self.at(times)
        powers = {id(interval.power): interval.power for interval in self._intervals}
        power_ids = np.array([id(interval.power) for interval in self._intervals])[owner]
        found = np.zeros(times.shape)
        for key, power in powers.items():
            if power is not None:
                inside = power_ids == key
                found[inside] = power.at(
                    {name: value[inside] for name, value in temperatures.items()}
                )
        return found

    @abstractmethod
    def _integrate(self, end: float, power: MeanPower | None, temperature: float | None) -> bool:
        """Continue until ``end`` or until the motor's temperature is reached; False if never."""

    def _continue(
        self, end: float, motion: RoundTripMotion | None, temperature: float | None
    ) -> bool:
        power = None if motion is None else self._power(motion)
        start = self.time
        reached = self._integrate(end, power, temperature)
        if reached:
            self._intervals.append(MotionInterval(start, self.time, power))
        return reached

    def _power(self, motion: RoundTripMotion) -> MeanPower:
        if motion not in self._powers:
            self._powers[motion] = MeanPower(self._joint, motion)
        return self._powers[motion]


@dataclass(frozen=True, slots=True)
class _Solution:
    start: float
    solution: OdeSolution


class ThermalHistory(History):
    """History integrated with error control and dense output."""

    def __init__(self, joint: SimulatedJoint, ambient: Ambient) -> None:
        super().__init__(joint, ambient)
        self._solutions: list[_Solution] = []

    def at(self, time: ArrayLike) -> dict[str, Array]:
        """Return the temperatures at times [s] within the history, by node name [°C]."""
        times = np.asarray(time, dtype=float)
        found = np.empty((len(self.state), *times.shape))
        starts = np.array([solution.start for solution in self._solutions])
        owner = np.searchsorted(starts, times, side="right") - 1
        for number in np.unique(owner):
            inside = owner == number
            found[:, inside] = self._solutions[number].solution(times[inside])
        return dict(zip(self._joint.network.names, found, strict=True))

    def _integrate(self, end: float, power: MeanPower | None, temperature: float | None) -> bool:
        solved = solve_ivp(
            self._derivative(power),
            (self.time, end),
            self.state,
            events=None if temperature is None else self._crossing(temperature),
            dense_output=True,
            rtol=1e-7,
            atol=1e-7,
        )
        assert solved.sol is not None
        reached = solved.status == 1
        if temperature is not None and not reached:
            return False
        self._solutions.append(_Solution(self.time, solved.sol))
        self.time = float(solved.t[-1])
        self.state = np.asarray(solved.y[:, -1])
        return True

    def _derivative(self, power: MeanPower | None) -> Callable[[float, Array], Array]:
        names = self._joint.network.names

        def derivative(time: float, state: Array) -> Array:
            heat = self._to_ambient * self.ambient.at(time) - self._conductance @ state
            if power is not None:
                now = dict(zip(names, state.tolist(), strict=True))
                heat += self.heat_per_node(power, now)
            return np.asarray(heat / self._capacities)

        return derivative

    def _crossing(self, temperature: float) -> Callable[[float, Array], float]:
        def distance(_: float, state: Array) -> float:
            return float(state[self._motor] - temperature)

        distance.terminal = True  # type: ignore[attr-defined]
        rising = temperature > self.state[self._motor]
        distance.direction = 1.0 if rising else -1.0  # type: ignore[attr-defined]
        return distance
