"""How well rows spread over all inputs: for causes that nobody has thought of."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import EffectTable


def log_determinant(tables: Sequence[EffectTable]) -> list[float]:
    """Return how well rows spread over all inputs, in nats: for causes that have no name.

    Half the log determinant of a full quadratic in the rows' inputs, each scaled by the range that
    all tables have together (D-optimality for a response surface).

    Parameters
    ----------
    tables : sequence of EffectTable
        Rows to be compared.
    """
    inputs = [_inputs(table) for table in tables]
    whole = np.vstack(inputs)
    low, high = whole.min(axis=0), whole.max(axis=0)
    varies = high > low
    found = []
    for one in inputs:
        unit = 2 * (one[:, varies] - low[varies]) / (high - low)[varies] - 1
        rows, columns = np.triu_indices(unit.shape[1])
        full = np.column_stack([np.ones(len(unit)), unit, unit[:, rows] * unit[:, columns]])
        found.append(0.5 * float(np.linalg.slogdet(full.T @ full + np.eye(full.shape[1]))[1]))
    return found


def _inputs(table: EffectTable) -> Array:
    """Return the inputs of each row: root of speed, temperature, angle, load, way, time, rest."""
    columns = (
        np.sqrt(table.speed),
        table.temperature,
        table.position,
        table.load,
        np.sqrt(table.travel),
        np.sqrt(table.time),
        np.log1p(np.minimum(table.rest, 12 * 3600.0)),
    )
    return np.column_stack(columns)
