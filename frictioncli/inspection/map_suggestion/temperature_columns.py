"""Find temperature columns: they change slowly, in steps or smoothly, in a plausible range."""

from collections.abc import Collection

import numpy as np

from frictioncli.inspection.map_suggestion.columns import (
    LIKELY,
    MAX_ALTERNATIVES,
    SURE,
    ColumnGuess,
    LogColumns,
)
from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units

_RANGES = {"°C": (5.0, 110.0), "K": (278.0, 383.0)}
_MAX_CHANGING = 0.02
"""Largest share of rows at which a temperature in steps changes."""
_MAX_STEP = 0.02
"""Largest change from row to row of a smooth temperature, as a share of its range."""
_LEAST_NET_CHANGE = 0.1
"""Least range of a smooth temperature, as a share of its total variation."""


def find_temperatures(head: LogHead, excluded: Collection[int]) -> list[tuple[int, str, str]]:
    """Return the columns that behave like temperatures, best first.

    Parameters
    ----------
    head : LogHead
        The beginning of the log.
    excluded : collection of int
        Columns of other quantities.

    Returns
    -------
    list of (int, str, str)
        Column, unit, and the evidence for it.
    """
    ranked = []
    for column, values in head.values.items():
        if column in excluded:
            continue
        low, high = float(values.min()), float(values.max())
        unit = next((u for u, (a, b) in _RANGES.items() if a <= low and high <= b), None)
        if unit is None:
            continue
        steps = np.abs(np.diff(values))
        changing = float(np.mean(steps > 0))
        variation = float(steps.sum())
        if changing <= _MAX_CHANGING:
            levels = len(np.unique(values))
            ranked.append((-levels, column, unit, f"{levels} levels from {low:g} to {high:g}"))
        elif (
            steps.max() <= _MAX_STEP * (high - low) and high - low >= _LEAST_NET_CHANGE * variation
        ):
            ranked.append((0, column, unit, f"slow and smooth from {low:.4g} to {high:.4g}"))
    return [(column, unit, reason) for _, column, unit, reason in sorted(ranked)]


def guess_temperature(
    columns: LogColumns, joint: int, excluded: Collection[int]
) -> ColumnGuess | None:
    """Choose a joint's temperature by its name, else a column that behaves like one.

    Parameters
    ----------
    columns : LogColumns
        The columns of the log.
    joint : int
        The joint, from 1.
    excluded : collection of int
        Columns of other quantities.
    """
    similar = [
        (column, unit, reason)
        for column, unit, reason in find_temperatures(columns.head, excluded)
        if not columns.is_of_another(column, joint)
    ]
    named = [
        column
        for column in columns.recognised
        if columns.is_named(column, names.MOTOR_TEMPERATURE)
        and not columns.is_of_another(column, joint)
    ]
    for column in named:
        values = columns.head.values.get(
            column, np.array([columns.head.constants.get(column, 0.0)])
        )
        written = units.canonical(columns.recognised[column].unit, names.MOTOR_TEMPERATURE)
        conversion = units.infer_temperature_unit(values, written, None, names.MOTOR_TEMPERATURE)
        if conversion is not None:
            return ColumnGuess(column, "its name says so", SURE, conversion.unit)
    if not similar:
        return None
    column, unit, reason = similar[0]
    alternatives = tuple((other, why) for other, _, why in similar[1 : 1 + MAX_ALTERNATIVES])
    return ColumnGuess(column, f"{reason}, like a temperature", LIKELY, unit, alternatives)
