"""Effects that are waves over the angle, for tests that need a catalogue of their own."""

import numpy as np

from frictioncli.effects.base import Basis, Effect, Signature
from frictioncli.effects.parameter import Parameter


def wave(order, phase=0.0):
    """Return a torque that repeats over the angle; orders differ enough to be nearly orthogonal."""
    return lambda rows: np.sin(order * np.radians(rows.position) + phase)


def effect(name, *waves, lower=-50.0, upper=50.0):
    """Return an effect of friction with one column, or several, that are sums of waves."""

    def basis(table):
        columns = np.column_stack([sum(a * one(table) for a, one in column) for column in waves])
        return Basis(columns, np.zeros_like(columns))

    coefficients = tuple(
        Parameter(
            name=f"c{i}", symbol="c", unit="torque", lower=lower, upper=upper, description="any"
        )
        for i in range(len(waves))
    )
    return Effect(
        name=name,
        summary="Any.",
        equation="c",
        source="test",
        channel="friction",
        shape=(),
        coefficients=coefficients,
        basis=basis,
        needs=("position",),
        signature=Signature(axis="position", claim="Any."),
        confounders=(),
        experiment="Any.",
    )


A, B, C = wave(19.0), wave(23.0, 0.4), wave(29.0, 1.0)
"""Waves shorter than those of the smooth discrepancy; a fine one may take a part of them."""

THREE = effect("a", [(1.0, A)]), effect("b", [(1.0, B)]), effect("c", [(1.0, C)])
