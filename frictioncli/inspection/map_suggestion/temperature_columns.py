"""Which columns are temperatures: slow, in steps or smooth, and where temperatures lie."""

from collections.abc import Collection

import numpy as np

from frictioncli.inspection.map_suggestion.columns import OTHERS, LogColumns
from frictioncli.inspection.map_suggestion.guess import LIKELY, SURE, Guess
from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels import units

_RANGES = {"°C": (5.0, 110.0), "K": (278.0, 383.0)}
_SLOW = 0.02
"""Share of the rows at which a temperature in steps changes, at most."""

_SMOOTH = 0.02
"""Change from row to row of a temperature without steps, as a share of its span, at most."""

_ONE_WAY = 0.1
"""Least net change as a share of the way there and back, for what is not in steps."""


def temperatures(found: Probe, apart: Collection[int]) -> list[tuple[int, str, str]]:
    """Return columns that behave like temperatures: column, unit, and what speaks for it.

    Parameters
    ----------
    found : Probe
        The beginning of the log.
    apart : collection of int
        Columns that are something else.
    """
    ranked = []
    for column, values in found.values.items():
        if column in apart:
            continue
        low, high = float(values.min()), float(values.max())
        unit = next((u for u, (a, b) in _RANGES.items() if a <= low and high <= b), None)
        if unit is None:
            continue
        steps = np.abs(np.diff(values))
        changing = float(np.mean(steps > 0))
        way = float(steps.sum())
        if changing <= _SLOW:
            levels = len(np.unique(values))
            ranked.append((-levels, column, unit, f"{levels} levels from {low:g} to {high:g}"))
        elif steps.max() <= _SMOOTH * (high - low) and high - low >= _ONE_WAY * way:
            ranked.append((0, column, unit, f"slow and smooth from {low:.4g} to {high:.4g}"))
    return [(column, unit, why) for _, column, unit, why in sorted(ranked)]


def temperature_guess(columns: LogColumns, joint: int, apart: Collection[int]) -> Guess | None:
    """Choose the joint's temperature by its name, else a column that behaves like one."""
    behaving = [
        (column, unit, why)
        for column, unit, why in temperatures(columns.found, apart)
        if not columns.is_of_another(column, joint)
    ]
    named = [
        column
        for column in columns.known
        if columns.says(column, names.MOTOR_TEMPERATURE)
        and not columns.is_of_another(column, joint)
    ]
    for column in named:
        values = columns.found.values.get(
            column, np.array([columns.found.constants.get(column, 0.0)])
        )
        written = units.canonical(columns.known[column].unit, names.MOTOR_TEMPERATURE)
        conversion = units.infer_temperature_unit(values, written, None, names.MOTOR_TEMPERATURE)
        if conversion is not None:
            return Guess(column, "its name says so", SURE, conversion.unit)
    if not behaving:
        return None
    column, unit, why = behaving[0]
    others = tuple((other, told) for other, _, told in behaving[1 : 1 + OTHERS])
    return Guess(column, f"{why}, like a temperature", LIKELY, unit, others)
