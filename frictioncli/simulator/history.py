"""The temperatures of a run, integrated block by block of equal motion."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import OdeSolution, solve_ivp

from frictioncli.simulator.joint import Joint, MeanPower, RoundTrips
from frictioncli.simulator.thermal import Ambient

MOTOR = "motor sensor"
HOUSING = "housing"
"""Nodes that carry the joint's two sensors."""

LONGEST_RUN = 24 * 3600.0
"""A temperature that is not reached within a run of a day is out of reach [s]."""


@dataclass(frozen=True, slots=True)
class _Block:
    start: float
    end: float
    solution: OdeSolution


class ThermalHistory:
    """Temperatures from a start at ``ambient`` on; each call continues where the last one ended."""

    def __init__(self, joint: Joint, ambient: Ambient) -> None:
        self._joint = joint
        self._ambient = ambient
        self._capacities = joint.network.capacities()
        self._conductance = joint.network.conductance_matrix()
        self._to_ambient = joint.network.to_ambient()
        self._shares = joint.heat_shares()
        self._motor = joint.network.names.index(MOTOR)
        self._blocks: list[_Block] = []
        self._powers: dict[RoundTrips, MeanPower] = {}
        self.time = 0.0
        self.state = np.full(len(joint.network.nodes), float(ambient.at(0.0)))

    def spend(self, duration: float, motion: RoundTrips | None = None) -> None:
        """Continue for ``duration`` [s], standing or with round trips."""
        self._integrate(self.time + duration, motion, None)

    def until_motor(self, temperature: float, motion: RoundTrips | None = None) -> bool:
        """Continue until the motor reaches ``temperature`` [°C]; False if it never does."""
        rising = temperature > self.state[self._motor]

        def distance(_: float, state: NDArray[np.float64]) -> float:
            return float(state[self._motor] - temperature)

        distance.terminal = True  # type: ignore[attr-defined]
        distance.direction = 1.0 if rising else -1.0  # type: ignore[attr-defined]
        return self._integrate(max(self.time, LONGEST_RUN), motion, distance)

    def at(self, time: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """Return the temperatures at times [s] within the history, by node name [°C]."""
        times = np.asarray(time, dtype=float)
        found = np.empty((len(self.state), *times.shape))
        starts = np.array([block.start for block in self._blocks])
        owner = np.searchsorted(starts, times, side="right") - 1
        for number in np.unique(owner):
            own = owner == number
            found[:, own] = self._blocks[number].solution(times[own])
        return dict(zip(self._joint.network.names, found, strict=True))

    def _integrate(
        self,
        end: float,
        motion: RoundTrips | None,
        event: Callable[[float, NDArray[np.float64]], float] | None,
    ) -> bool:
        solved = solve_ivp(
            self._slope(motion),
            (self.time, end),
            self.state,
            events=event,
            dense_output=True,
            rtol=1e-7,
            atol=1e-7,
        )
        assert solved.sol is not None
        reached = solved.status == 1
        if event is not None and not reached:
            return False
        self._blocks.append(_Block(self.time, float(solved.t[-1]), solved.sol))
        self.time = float(solved.t[-1])
        self.state = np.asarray(solved.y[:, -1])
        return True

    def _slope(
        self, motion: RoundTrips | None
    ) -> Callable[[float, NDArray[np.float64]], NDArray[np.float64]]:
        names = self._joint.network.names
        power = None if motion is None else self._power(motion)

        def slope(time: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
            heat = self._to_ambient * self._ambient.at(time) - self._conductance @ state
            if power is not None:
                heat += self._shares * power(dict(zip(names, state.tolist(), strict=True)))
            return np.asarray(heat / self._capacities)

        return slope

    def _power(self, motion: RoundTrips) -> MeanPower:
        if motion not in self._powers:
            self._powers[motion] = MeanPower(self._joint, motion)
        return self._powers[motion]
