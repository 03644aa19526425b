"""A robot program, independent of the controller's language."""

from collections.abc import Iterator
from dataclasses import dataclass

from frictioncli.design.blocks import Block
from frictioncli.design.limits import Limits

APPROACH_SPEED = 20.0
"""Speed of unrecorded moves to the start of a series. [deg/s]"""

SAFETY_NOTE = (
    "Try it at reduced speed first, with nobody within reach and a clear path for the axis."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotProgram:
    """A robot program for one axis.

    Attributes
    ----------
    name : str
        Name of the files: letters, digits and underscores.
    axis : int
        Number of the axis, from 1.
    blocks : tuple of Block
        Blocks in sequence.
    limits : Limits
        Limits of the motion.
    seconds : float
        Expected duration. [s]
    """

    name: str
    axis: int
    blocks: tuple[Block, ...]
    limits: Limits
    seconds: float

    @property
    def approach(self) -> float:
        """Speed of unrecorded moves to the start of a series [deg/s]."""
        return self.limits.speed(min(APPROACH_SPEED, self.limits.fastest))

    def header_lines(self) -> Iterator[str]:
        """Yield the lines at the top of every program."""
        limits = self.limits
        yield f"Measures the friction of axis {self.axis}; about {self.seconds / 60:.0f} min."
        yield f"Moves axis {self.axis} only, from {limits.low:g} to {limits.high:g} deg, up to"
        yield f"{limits.fastest:.4g} deg/s. All other axes stay where they are at the start."
        yield SAFETY_NOTE
        yield "Check before: the path is clear over the whole range in this pose of the other"
        yield "axes, the payload is fixed and its data are set, the robot has been idle overnight."
        for text in limits.beyond:
            yield f"Beyond the measured range, as requested: {text}."


def to_ascii(text: str) -> str:
    """Return text in printable ASCII, which every controller can show."""
    replaced = text.replace("°C", "degC").replace("N·m", "Nm")
    return "".join(letter if " " <= letter <= "~" else "?" for letter in replaced)
