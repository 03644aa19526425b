"""Which column is a torque or a current: it changes its sign with the direction of motion."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.inspection.map_suggestion.columns import OTHERS, LogColumns
from frictioncli.inspection.map_suggestion.guess import (
    GUESS,
    LIKELY,
    SURE,
    Guess,
    is_command,
    is_derived,
)
from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import units

_MOVES = 0.1
_FEWEST = 20
_SEEN = 0.05
"""Share of what gravity leaves that the direction must explain."""

_GRAVITY = 0.5
_SURE_SHARE = 0.5
_CURRENT_WORDS = ("curr", "strom", "amp", "i_")


@dataclass(frozen=True, slots=True)
class Opposition:
    """How a column follows the direction of motion.

    Attributes
    ----------
    column : int
        Index in the file.
    explained : float
        Share of what gravity leaves that goes with the direction of motion. [-]
    jump : float
        Half the difference between the directions. [its unit]
    by_angle : float
        Share of all its variance that goes with the angle alone. [-]
    """

    column: int
    explained: float
    jump: float
    by_angle: float

    @property
    def opposes(self) -> bool:
        """Whether direction shows at all."""
        return self.explained > _SEEN

    @property
    def loads(self) -> bool:
        """Whether it is a load: it goes with the angle, not with the direction."""
        return not self.opposes and self.by_angle > _GRAVITY


def oppositions(
    found: Probe, position: Array, velocity: Array, apart: Collection[int]
) -> list[Opposition]:
    """Return how far each column goes with the direction of motion, the most so first.

    Parameters
    ----------
    found : Probe
        The beginning of the log.
    position, velocity : ndarray, shape (n,)
        The joint's motion. [deg], [deg/s]
    apart : collection of int
        Columns that cannot be a torque: times, positions, velocities.
    """
    speed = np.abs(velocity)
    moving = speed > _MOVES * float(np.max(speed, initial=0.0))
    if np.count_nonzero(moving) < _FEWEST:
        return []
    angle = np.radians(position[moving])
    ones = np.ones(len(angle))
    gravity = np.stack([ones, np.sin(angle), np.cos(angle)], axis=1)
    direction = np.stack([np.sign(velocity[moving]), velocity[moving]], axis=1)
    both = np.concatenate([gravity, direction], axis=1)
    judged = []
    for column, values in found.values.items():
        if column in apart:
            continue
        own = values[moving]
        left, rest = _left(gravity, own), _left(both, own)
        spread = float(np.var(own))
        if spread <= 0 or left <= 0:
            continue
        signed = np.column_stack([gravity, direction[:, 0]])
        jump = float(np.linalg.lstsq(signed, own, rcond=None)[0][-1])
        judged.append(Opposition(column, 1 - rest / left, jump, max(1 - left / spread, 0.0)))
    return sorted(judged, key=lambda one: -one.explained)


def _left(columns: Array, values: Array) -> float:
    """Return the mean square that a linear fit leaves."""
    found = np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(np.mean((values - columns @ found) ** 2))


def torque_guess(columns: LogColumns, judged: Sequence[Opposition], joint: int) -> Guess | None:
    """Choose the column that opposes the motion, of the joint where names tell."""
    usable = [one for one in judged if not columns.is_of_another(one.column, joint)]
    opposing = [one for one in usable if one.opposes]
    named = [one for one in usable if columns.says(one.column, names.TORQUE)]
    ranked = sorted(
        opposing,
        key=lambda one: (
            is_command(columns.found.names[one.column])
            or is_derived(columns.found.names[one.column]),
            not columns.says(one.column, names.TORQUE),
            -one.explained,
        ),
    )
    if not ranked and not named:
        return None
    best = ranked[0] if ranked else named[0]
    why = (
        f"differs by twice {best.jump:.3g} between the directions, which explains"
        f" {100 * best.explained:.0f} % of what the angle does not"
        if ranked
        else "its name says so, but it does not change with the direction of motion"
    )
    sure = GUESS
    if ranked:
        sure = SURE if best.explained > _SURE_SHARE else LIKELY
    others = [one for one in (ranked or named) if one.column != best.column]
    told = tuple((o.column, f"opposes motion too, by {o.jump:.3g}") for o in others[:OTHERS])
    return Guess(best.column, why, sure, _torque_unit(columns, best.column), told)


def load_guess(
    columns: LogColumns, judged: Sequence[Opposition], joint: int, torque: int
) -> Guess | None:
    """Choose a torque by its name that goes with the angle and not with the direction."""
    for one in judged:
        says = columns.says(one.column, names.TORQUE) or columns.says(one.column, names.LOAD)
        commanded = is_command(columns.found.names[one.column])
        if one.column == torque or not says or commanded or not one.loads:
            continue
        if (
            not columns.is_of_another(one.column, joint)
            and _torque_unit(columns, one.column) == "N·m"
        ):
            why = (
                f"goes with the angle ({100 * one.by_angle:.0f} %), not with the direction: a"
                " load freed of friction"
            )
            return Guess(one.column, why, LIKELY, "N·m")
    return None


def _torque_unit(columns: LogColumns, column: int) -> str:
    channel = columns.known.get(column)
    name = columns.found.names[column].lower()
    written = "" if channel is None else channel.unit or channel.meaning.unit
    unit = units.canonical(written, names.TORQUE) if written else None
    if unit in units.FACTORS[names.TORQUE]:
        return str(unit)
    return "A" if any(word in name for word in _CURRENT_WORDS) else "N·m"
