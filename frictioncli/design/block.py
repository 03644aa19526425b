"""A block of a programme: some steps that belong together, and why one would take them."""

from collections.abc import Callable
from dataclasses import dataclass

from frictioncli.design.limits import Limits
from frictioncli.design.steps import SeriesStep, Step, duration


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Steps that belong together.

    Attributes
    ----------
    name : str
        What it is.
    reason : str
        What it shows that other blocks do not, in a sentence.
    steps : tuple of Step
        Its steps.
    """

    name: str
    reason: str
    steps: tuple[Step, ...]

    @property
    def seconds(self) -> float:
        """Its duration, changes of payload apart [s]."""
        return duration(self.steps)

    @property
    def payload(self) -> float | None:
        """Payload that it needs; None: any [kg]."""
        return next((s.payload for s in self.steps if isinstance(s, SeriesStep)), None)


Variants = Callable[[Limits, int], tuple[Block, ...]]
"""What a kind of block offers within limits, and with a seed for what is random."""


def short_series(limits: Limits, payload: float | None = None) -> SeriesStep:
    """Return the series that follows something that was done to the joint: four speeds."""
    return SeriesStep(
        speeds=limits.speeds(4, slowest=limits.stroke / 20),
        low=limits.low,
        high=limits.high,
        payload=payload,
    )
