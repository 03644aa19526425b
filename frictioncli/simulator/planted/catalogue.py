"""All effects that can be planted, by name, and how they are asked for."""

import math
from dataclasses import dataclass

from frictioncli.errors import OptionError
from frictioncli.simulator.planted.cooling_fan import CoolingFan
from frictioncli.simulator.planted.coulomb_temperature import CoulombTemperature
from frictioncli.simulator.planted.direction_asymmetry import DirectionAsymmetry
from frictioncli.simulator.planted.dress_pack import DressPack
from frictioncli.simulator.planted.drift import Drift
from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.planted.inertia import Inertia
from frictioncli.simulator.planted.lifting_loss import LiftingLoss
from frictioncli.simulator.planted.linear_viscous import LinearViscous
from frictioncli.simulator.planted.load_linear import LoadLinear
from frictioncli.simulator.planted.load_temperature import LoadTemperature
from frictioncli.simulator.planted.load_velocity import LoadVelocity
from frictioncli.simulator.planted.payload_change import PayloadChange
from frictioncli.simulator.planted.position_ripple import PositionRipple
from frictioncli.simulator.planted.position_temperature import PositionTemperature
from frictioncli.simulator.planted.quadratic_drag import QuadraticDrag
from frictioncli.simulator.planted.rest_recovery import RestRecovery
from frictioncli.simulator.planted.reversal_transient import ReversalTransient
from frictioncli.simulator.planted.run_in import RunIn
from frictioncli.simulator.planted.speed_resonance import SpeedResonance
from frictioncli.simulator.planted.step_change import StepChange
from frictioncli.simulator.planted.stribeck import Stribeck
from frictioncli.simulator.planted.stroke_bump import StrokeBump
from frictioncli.simulator.planted.thermal_lag import ThermalLag
from frictioncli.simulator.planted.torque_constant import TorqueConstant
from frictioncli.simulator.planted.velocity_exponent import VelocityExponent

_KINDS: tuple[type[PlantedEffect], ...] = (
    Stribeck,
    VelocityExponent,
    LinearViscous,
    QuadraticDrag,
    CoulombTemperature,
    LoadLinear,
    LoadVelocity,
    LoadTemperature,
    ThermalLag,
    Drift,
    RunIn,
    RestRecovery,
    StepChange,
    DirectionAsymmetry,
    TorqueConstant,
    PayloadChange,
    DressPack,
    PositionRipple,
    Inertia,
    ReversalTransient,
    SpeedResonance,
    StrokeBump,
    CoolingFan,
    PositionTemperature,
    LiftingLoss,
)

EFFECTS: dict[str, type[PlantedEffect]] = {kind.name: kind for kind in _KINDS}
"""Effects by name; those that no catalogue lists stand at the end."""


@dataclass(frozen=True, slots=True)
class Asked:
    """An effect that is to be planted.

    Attributes
    ----------
    name : str
        Its name.
    size : float or None
        Its root mean square in the torque; drawn where none is given. [N·m]
    """

    name: str
    size: float | None


def asked(texts: tuple[str, ...]) -> tuple[Asked, ...]:
    """Return the effects that ``NAME`` or ``NAME:SIZE`` ask for.

    Raises
    ------
    OptionError
        If a name is unknown or comes twice, or a size is no positive number.
    """
    found = tuple(_asked(text) for text in texts)
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise OptionError(f"effect {name} is asked for {names.count(name)} times, expected one")
    return found


def _asked(text: str) -> Asked:
    name, colon, size = text.strip().partition(":")
    if name not in EFFECTS:
        raise OptionError(f"effect {name!r} is unknown, expected one of {', '.join(EFFECTS)}")
    if not colon:
        return Asked(name, None)
    try:
        number = float(size)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and number > 0.0):
        raise OptionError(
            f"effect {text}: size is {size!r}, expected N·m above 0, as in {name}:1.5"
        )
    return Asked(name, number)
