"""All effects that can be planted, by name, and the requests for them."""

import math
from dataclasses import dataclass

from frictioncli.errors import OptionError
from frictioncli.simulator.planted.effect import EffectDefinition
from frictioncli.simulator.planted.listed_speed_and_load import SPEED_AND_LOAD_EFFECTS
from frictioncli.simulator.planted.listed_time_and_position import TIME_AND_POSITION_EFFECTS
from frictioncli.simulator.planted.unlisted import UNLISTED_EFFECTS

EFFECTS: dict[str, EffectDefinition] = {
    effect.name: effect
    for effect in (*SPEED_AND_LOAD_EFFECTS, *TIME_AND_POSITION_EFFECTS, *UNLISTED_EFFECTS)
}
"""Effects by name, unlisted ones last. The position of an effect is part of its random seed."""


@dataclass(frozen=True, slots=True)
class RequestedEffect:
    """An effect that is to be planted.

    Attributes
    ----------
    name : str
        Its name.
    size : float or None
        Root mean square of its torque; drawn at random where None. [N·m]
    """

    name: str
    size: float | None


def requested_effects(texts: tuple[str, ...]) -> tuple[RequestedEffect, ...]:
    """Return the effects that are requested as ``NAME`` or ``NAME:SIZE``.

    Raises
    ------
    OptionError
        If a name is unknown or comes twice, or a size is no positive number.

    Examples
    --------
    >>> requested_effects(("stribeck:1.5",))
    (RequestedEffect(name='stribeck', size=1.5),)
    """
    requests = tuple(_requested_effect(text) for text in texts)
    names = [one.name for one in requests]
    for name in names:
        if names.count(name) > 1:
            raise OptionError(f"effect {name} is asked for {names.count(name)} times, expected one")
    return requests


def _requested_effect(text: str) -> RequestedEffect:
    name, colon, size = text.strip().partition(":")
    if name not in EFFECTS:
        raise OptionError(f"effect {name!r} is unknown, expected one of {', '.join(EFFECTS)}")
    if not colon:
        return RequestedEffect(name, None)
    try:
        number = float(size)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and number > 0.0):
        raise OptionError(
            f"effect {text}: size is {size!r}, expected N·m above 0, as in {name}:1.5"
        )
    return RequestedEffect(name, number)
