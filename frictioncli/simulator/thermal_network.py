"""Thermal network of the joint: heat capacities, conductances and ambient temperature."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalNode:
    """A part of the joint with one temperature.

    Attributes
    ----------
    name : str
        Name of the node.
    capacity : float
        Heat capacity. [J/K]
    to_ambient : float
        Conductance to ambient. [W/K]
    """

    name: str
    capacity: float
    to_ambient: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalLink:
    """A conductance between two nodes [W/K]."""

    first: str
    second: str
    conductance: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalNetwork:
    r"""Thermal nodes and the links between them.

    Notes
    -----
    .. math:: C_i \dot T_i = P_i - \sum_j G_{ij} (T_i - T_j) - G_{ia} (T_i - T_a)
    """

    nodes: tuple[ThermalNode, ...]
    links: tuple[ThermalLink, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the nodes, in the order of all vectors."""
        return tuple(node.name for node in self.nodes)

    def capacities(self) -> Array:
        """Return heat capacities [J/K]."""
        return np.array([node.capacity for node in self.nodes])

    def to_ambient(self) -> Array:
        """Return conductances to ambient [W/K]."""
        return np.array([node.to_ambient for node in self.nodes])

    def conductance_matrix(self) -> Array:
        """Return G, with ``G @ T - to_ambient * ambient`` the heat leaving the nodes [W/K]."""
        matrix = np.diag(self.to_ambient())
        index = {name: i for i, name in enumerate(self.names)}
        for link in self.links:
            i, j = index[link.first], index[link.second]
            matrix[i, i] += link.conductance
            matrix[j, j] += link.conductance
            matrix[i, j] -= link.conductance
            matrix[j, i] -= link.conductance
        return matrix

    def steady_state(self, *, power: ArrayLike, ambient: float) -> Array:
        """Return the steady-state temperatures for constant heat input.

        Parameters
        ----------
        power : array_like
            Heat input per node. [W]
        ambient : float
            Ambient temperature. [°C]

        Returns
        -------
        ndarray, shape (nodes,)
            Temperatures. [°C]

        Examples
        --------
        >>> motor = ThermalNode(name="motor", capacity=100.0, to_ambient=2.0)
        >>> ThermalNetwork(nodes=(motor,), links=()).steady_state(power=[40.0], ambient=20.0)
        array([40.])
        """
        inflow = np.asarray(power, dtype=float) + self.to_ambient() * ambient
        return np.asarray(np.linalg.solve(self.conductance_matrix(), inflow))


@dataclass(frozen=True, slots=True, kw_only=True)
class Ambient:
    """Ambient temperature over a run.

    Attributes
    ----------
    start : float
        Temperature at the first sample of the run. [°C]
    drift : float
        Rate of change. [K/h]
    """

    start: float
    drift: float = 0.0

    def at(self, time: ArrayLike) -> Array:
        """Return the ambient temperature at a time in s [°C]."""
        return np.asarray(self.start + self.drift * np.asarray(time, dtype=float) / 3600.0)
