"""Lack of fit along an axis of the experiment, as it is reported."""

from dataclasses import dataclass

from frictioncli.effects.base import Channel

SIGNIFICANT = 5e-3
"""Greatest p-value of structure that no effect explains."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """Lack of fit along one axis of the experiment.

    Attributes
    ----------
    axes : tuple of str
        The axis, or the two axes, along which it shows: ``position``, ``speed``, ``temperature``,
        ``time`` or ``load``.
    channel : {"friction", "load"}
        The channel.
    p_value : float
        Probability that noise explains as much, corrected for the number of axes (Bonferroni).
    statistic : float
        Twice the log likelihood ratio to base and accepted effects.
    size : float
        RMS of what base and effects leave of it. [N·m]
    interval : (float, float)
        95 % interval of that. [N·m]
    or_load : bool
        Whether structure along the angle is about as likely along the load, which differs from it.
    only_on : str
        The only run that has it, where that was kept out of the diagnosis; else empty.
    """

    axes: tuple[str, ...]
    channel: Channel
    p_value: float
    statistic: float
    size: float
    interval: tuple[float, float]
    or_load: bool = False
    only_on: str = ""

    @property
    def axis(self) -> str:
        """The axes in words."""
        return " and ".join(self.axes).replace("position", "angle")
