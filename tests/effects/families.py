"""Effects that stay indistinguishable until a better experiment has been made."""

from dataclasses import dataclass
from typing import Literal

Condition = Literal["always", "one_run", "one_thermal_cycle", "no_load_evidence"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Effects of which data of a kind can only say that one of them is at work.

    Attributes
    ----------
    name : str
        What they have in common.
    members : tuple of str
        Names of the effects.
    condition : {"always", "one_run", "one_thermal_cycle", "no_load_evidence"}
        For which data this holds: for all, for a single run, for one heating and one cooling, or
        where the load channel says nothing because the load is small or not fitted.
    reason : str
        Why they look alike.
    experiment : str
        What to measure to tell them apart.
    """

    name: str
    members: tuple[str, ...]
    condition: Condition
    reason: str
    experiment: str


FAMILIES: tuple[Family, ...] = (
    Family(
        name="velocity law",
        members=("velocity_exponent", "linear_viscous", "quadratic_drag"),
        condition="always",
        reason=(
            "Beside a fitted square root of speed all three are one bow over speed, which a few"
            " speeds cannot tell apart."
        ),
        experiment=(
            "Ten or more speeds, three of them in the upper half, at two temperatures held"
            " constant: the bow of an exponent shrinks with heat, that of the others does not."
        ),
    ),
    Family(
        name="slow change",
        members=("drift", "run_in", "step_change"),
        condition="one_run",
        reason=(
            "Within one run way travelled grows with time, and a slow change has the shape of"
            " slow noise."
        ),
        experiment=(
            "Equal durations with and without motion, a return to the start temperature, and the"
            " same pairs on the next day."
        ),
    ),
    Family(
        name="temperature in friction only",
        members=("coulomb_temperature", "torque_constant"),
        condition="no_load_evidence",
        reason=(
            "Both add friction in proportion to temperature; only the load torque, which the"
            " motor's torque constant scales and Coulomb friction does not, decides."
        ),
        experiment="A known payload, held still or swept slowly, cold and hot.",
    ),
    Family(
        name="one thermal cycle",
        members=("thermal_lag", "drift", "run_in"),
        condition="one_thermal_cycle",
        reason=(
            "With one heating and one cooling, heating always comes first: whatever changes with"
            " time or way splits the two branches as a lag does."
        ),
        experiment=(
            "A second cycle with another split of heat between motor and gear, and pauses with"
            " measured pairs during cooling."
        ),
    ),
)
"""Families in the order of reports."""


def families_of(effect: str) -> tuple[Family, ...]:
    """Return the families that an effect belongs to."""
    return tuple(family for family in FAMILIES if effect in family.members)
