"""Friction zones: parts of the joint where torque is lost, each with its temperature and law.

The joint's friction is the sum over its zones. A zone may be any frozen object with a ``node`` and
a ``torque`` method, so that a further loss is another zone.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array

LAW_TEMPERATURE = 40.0
"""Temperature at which a zone's ``viscous`` coefficient is stated [°C]."""


class Zone(Protocol):
    """Interface of a friction zone."""

    @property
    def name(self) -> str:
        """Name of the zone."""

    @property
    def node(self) -> str:
        """Name of the thermal node whose temperature acts here."""

    def torque(self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike) -> Array:
        """Return the zone's friction torque [N·m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LubricatedZone:
    r"""A lubricated contact: Coulomb, load-dependent and viscous friction that falls when warm.

    Attributes
    ----------
    name : str
        Name of the zone.
    node : str
        Thermal node that has the zone's temperature.
    coulomb : float
        Torque at zero load and speed. [N·m]
    load_square : float
        Torque per square of the load torque. [1/(N·m)]
    viscous_floor : float
        Viscous coefficient at high temperature. [N·m/(deg/s)^p]
    viscous : float
        Viscous coefficient that decreases with temperature, at 40 °C. [N·m/(deg/s)^p]
    thinning : float
        Rate of this decrease. [1/K]
    speed_exponent : float
        Exponent p of the speed. [-]

    Notes
    -----
    .. math:: \tau_i = c + a L^2 + \left(b + g e^{-d (T_i - 40)}\right) |\dot\varphi|^p

    The exponent is 1 for a full film in a plain gap and approaches 0 for starved greased rolling
    contacts. The sum over zones is close to the measured square root down to the slowest
    speeds [1]_.

    References
    ----------
    .. [1] M. N. Nevmerzhitskiy et al., "Friction model of industrial robot joint with temperature
       correction by example of KUKA KR10," J. Robotics, 2019, doi:10.1155/2019/6931563.
    """

    name: str
    node: str
    coulomb: float
    load_square: float = 0.0
    viscous_floor: float
    viscous: float
    thinning: float
    speed_exponent: float

    def torque(self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike) -> Array:
        """Return the zone's friction torque, positive where it opposes the motion [N·m].

        Parameters
        ----------
        load : array_like
            Load torque at the joint. [N·m]
        speed : array_like
            Absolute joint velocity. [deg/s]
        temperature : array_like
            Temperature of the zone. [°C]
        """
        warmth = np.asarray(temperature, dtype=float) - LAW_TEMPERATURE
        coefficient = self.viscous_floor + self.viscous * np.exp(-self.thinning * warmth)
        return np.asarray(
            self.coulomb
            + self.load_square * np.square(np.asarray(load, dtype=float))
            + coefficient * np.power(np.asarray(speed, dtype=float), self.speed_exponent)
        )


def friction_torque(
    zones: Iterable[Zone],
    *,
    load: ArrayLike,
    speed: ArrayLike,
    temperatures: Mapping[str, ArrayLike],
) -> Array:
    """Return the friction torque of the joint: the sum over its zones.

    Parameters
    ----------
    zones : iterable of Zone
        The zones.
    load : array_like
        Load torque. [N·m]
    speed : array_like
        Absolute joint velocity. [deg/s]
    temperatures : mapping of str to array_like
        Temperature by node name. [°C]

    Returns
    -------
    ndarray
        Friction torque, positive where it opposes the motion. [N·m]
    """
    total = np.zeros(np.broadcast_shapes(np.shape(load), np.shape(speed)))
    for zone in zones:
        total = total + zone.torque(load=load, speed=speed, temperature=temperatures[zone.node])
    return np.asarray(total)
