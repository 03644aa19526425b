"""The thermal history in fixed steps: within a few hundredths of a kelvin, many times faster."""

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.simulator.joint import MeanPower, SimulatedJoint
from frictioncli.simulator.thermal_history import History
from frictioncli.simulator.thermal_network import Ambient

STEP = 30.0
"""Longest step, in which the dissipated power is held [s]."""


class FastHistory(History):
    """The history in exact steps of a network whose dissipated power is held in each."""

    def __init__(self, joint: SimulatedJoint, ambient: Ambient) -> None:
        super().__init__(joint, ambient)
        self._names = joint.network.names
        self._times = [0.0]
        self._states = [self.state]
        # symmetric in the square roots of the capacities, so that its eigenvalues are real
        root = np.sqrt(self._capacities)
        rates, vectors = np.linalg.eigh(self._conductance / np.outer(root, root))
        self._rates = rates
        self._to_modes, self._from_modes = vectors.T * root, vectors / root[:, None]

    def at(self, time: ArrayLike) -> dict[str, Array]:
        """Return the temperatures at times [s] within the history, by node name [°C]."""
        times = np.asarray(time, dtype=float)
        known = np.array(self._times)
        states = np.array(self._states)
        return {
            name: np.asarray(np.interp(times, known, states[:, number]))
            for number, name in enumerate(self._names)
        }

    def _integrate(self, end: float, power: MeanPower | None, temperature: float | None) -> bool:
        way = 0.0
        if temperature is not None:
            way = 1.0 if temperature > self.state[self._motor] else -1.0
        while self.time < end - 1e-9:
            step = min(STEP, end - self.time)
            source = self._source(power, step)
            state = self._stepped(source, step)
            if temperature is not None and way * (state[self._motor] - temperature) >= 0.0:
                before = self.state[self._motor]
                step *= float((temperature - before) / (state[self._motor] - before))
                self._keep(step, self._stepped(source, step))
                return True
            self._keep(step, state)
        return temperature is None

    def _source(self, power: MeanPower | None, step: float) -> Array:
        """Return what warms the nodes apart from each other [K/s]."""
        heat = self._to_ambient * float(self.ambient.at(self.time + step / 2.0))
        if power is not None:
            now = dict(zip(self._names, self.state.tolist(), strict=True))
            heat = heat + self.heat_per_node(power, now)
        return np.asarray(heat / self._capacities)

    def _stepped(self, source: Array, step: float) -> Array:
        """Return the state after a step, exact for a constant source."""
        memory = np.exp(-self._rates * step)
        modes = memory * (self._to_modes @ self.state)
        modes = modes + (1.0 - memory) / self._rates * (self._to_modes @ source)
        return np.asarray(self._from_modes @ modes)

    def _keep(self, step: float, state: Array) -> None:
        self.time += step
        self.state = state
        self._times.append(self.time)
        self._states.append(state)
