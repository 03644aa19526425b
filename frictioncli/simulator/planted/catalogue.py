"""All effects that can be planted, by name, and the requests for them."""

import math
from dataclasses import dataclass

from frictioncli.errors import OptionError
from frictioncli.simulator.planted.effect import EffectDefinition
from frictioncli.simulator.planted.listed_direction_and_position import (
    DIRECTION_AND_POSITION_EFFECTS,
)
from frictioncli.simulator.planted.listed_speed_and_load import SPEED_AND_LOAD_EFFECTS
from frictioncli.simulator.planted.listed_time import TIME_EFFECTS
from frictioncli.simulator.planted.unlisted import UNLISTED_EFFECTS

EFFECTS: dict[str, EffectDefinition] = {
    effect.name: effect
    for effect in (
        *SPEED_AND_LOAD_EFFECTS,
        *TIME_EFFECTS,
        *DIRECTION_AND_POSITION_EFFECTS,
        *UNLISTED_EFFECTS,
    )
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
    history : str
        When a change is there; empty for its default.
    """

    name: str
    size: float | None
    history: str = ""


def requested_effects(texts: tuple[str, ...]) -> tuple[RequestedEffect, ...]:
    """Return the effects that are requested as ``NAME`` or ``NAME:SIZE``.

    The name of a change may be followed by ``@`` and its history, as in ``step_change@recurring``.

    Raises
    ------
    OptionError
        If a name is unknown or comes twice, a history is unknown, or a size is no positive number.

    Examples
    --------
    >>> requested_effects(("stribeck:1.5",))
    (RequestedEffect(name='stribeck', size=1.5, history=''),)
    """
    requests = tuple(_requested_effect(text) for text in texts)
    names = [one.name for one in requests]
    for name in names:
        if names.count(name) > 1:
            raise OptionError(f"effect {name} is asked for {names.count(name)} times, expected one")
    return requests


def _requested_effect(text: str) -> RequestedEffect:
    what, colon, size = text.strip().partition(":")
    name, at, history = what.partition("@")
    if name not in EFFECTS:
        raise OptionError(f"effect {name!r} is unknown, expected one of {', '.join(EFFECTS)}")
    histories = EFFECTS[name].histories
    if at and history not in histories:
        known = f"one of {', '.join(histories)}" if histories else "none, as it is no change"
        raise OptionError(f"effect {text}: history is {history!r}, expected {known}")
    if not colon:
        return RequestedEffect(name, None, history)
    try:
        number = float(size)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and number > 0.0):
        raise OptionError(
            f"effect {text}: size is {size!r}, expected N·m above 0, as in {name}:1.5"
        )
    return RequestedEffect(name, number, history)
