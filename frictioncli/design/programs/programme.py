"""What a robot program is written from."""

from collections.abc import Iterator
from dataclasses import dataclass

from frictioncli.design.blocks import Block
from frictioncli.design.limits import Limits

APPROACH = 20.0
"""Speed on the way to where a series begins. [deg/s]"""

MARGIN = 10.0
"""Above the temperature at which heating ends, by so much, all motion waits. [°C]"""

REDUCED = "Try it at reduced speed first, with nobody in reach and a free way for the axis."


@dataclass(frozen=True, slots=True, kw_only=True)
class Programme:
    """A programme with a name, for one axis.

    Attributes
    ----------
    name : str
        Name of the files, in letters, digits and underscores.
    axis : int
        Number of the axis, from 1.
    blocks : tuple of Block
        What it does.
    limits : Limits
        Within which it stays.
    seconds : float
        How long it is expected to take. [s]
    """

    name: str
    axis: int
    blocks: tuple[Block, ...]
    limits: Limits
    seconds: float

    @property
    def approach(self) -> float:
        """Speed on the way to where a series begins [deg/s]."""
        return self.limits.speed(min(APPROACH, self.limits.fastest))

    def told(self) -> Iterator[str]:
        """Yield what stands at the top of every program."""
        limits = self.limits
        yield f"Measures the friction of axis {self.axis}; about {self.seconds / 60:.0f} min."
        yield f"Moves axis {self.axis} only, from {limits.low:g} to {limits.high:g} deg, up to"
        yield f"{limits.fastest:.4g} deg/s. All other axes stay where they are at the start."
        yield REDUCED
        yield "Check before: the way is free over the whole range in this posture of the other"
        yield "axes, the payload is fixed and its data are set, the robot has stood for the night."
        for text in limits.beyond:
            yield f"Beyond what was measured, as asked: {text}."


def plain_text(text: str) -> str:
    """Return text that any controller can show: printable ASCII only."""
    swapped = text.replace("°C", "degC").replace("N·m", "Nm")
    return "".join(letter if " " <= letter <= "~" else "?" for letter in swapped)
