"""Which effects a table can be asked about at all."""

from collections.abc import Iterable

import numpy as np

from frictioncli.effects.base import Effect, EffectTable


def missing_columns(effect: Effect, table: EffectTable) -> tuple[str, ...]:
    """Return the columns for want of which an effect cannot be judged.

    Parameters
    ----------
    effect : Effect
        Entry of the catalogue.
    table : EffectTable
        Pairs and angle bins.

    Returns
    -------
    tuple of str
        Needed columns that are constant or not known in every row; empty where none is.
    """
    return tuple(name for name in effect.needs if not _varies(getattr(table, name)))


def judgeable(effects: Iterable[Effect], table: EffectTable) -> tuple[Effect, ...]:
    """Return the effects whose needed columns a table has, in the same order."""
    return tuple(effect for effect in effects if not missing_columns(effect, table))


def _varies(column: np.ndarray) -> bool:
    """Say whether a column is known in every row and not constant."""
    return bool(len(column) and np.all(np.isfinite(column)) and np.ptp(column) > 0)
