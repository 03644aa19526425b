r"""Friction decreases with the distance travelled, as surfaces and grease run in.

.. math:: \Delta\tau = A\, e^{-s/s_0}

Surfaces stay run in, so that the distance *s* includes that of earlier runs. An excess that returns
on every cold start is no running-in, but an effect of temperature or of rest.
"""

from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.effects.base import Basis, Effect, EffectTable, Signature, friction_only
from frictioncli.effects.pair_series import pair_heads, starts
from frictioncli.effects.parameter import Parameter


def basis(table: EffectTable, *, distance: float) -> Basis:
    """Return the remaining share of the running-in, shape (rows, 1). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float
        Distance after which 37 % remain. [deg]
    """
    return friction_only(np.exp(-_over_runs(table, table.travel) / distance))


def basis_of_logged(table: EffectTable, *, distance: float) -> Basis:
    """Return the same if the joint has moved in its recordings only, shape (rows, 1). [-].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    distance : float
        Distance after which 37 % remain. [deg]
    """
    return friction_only(np.exp(-_over_runs(table, table.once(logged_travel)) / distance))


def logged_travel(table: EffectTable) -> Array:
    """Return the distance of the pairs before each one in its run, shape (rows,) [deg].

    Parameters
    ----------
    table : EffectTable
        Pairs and angle bins.
    """
    heads = pair_heads(table)
    strokes = 2 * (heads.maximum(table.position) - heads.minimum(table.position))
    before = heads.spread(np.cumsum(strokes) - strokes)
    begins = starts(table.run)
    return before - before[begins][np.cumsum(begins) - 1]


def _over_runs(table: EffectTable, travel: Array) -> Array:
    """Return the distance of the earlier runs added to that in each run, shape (rows,) [deg]."""
    begins = starts(table.run)
    run = np.cumsum(begins) - 1
    covered = np.maximum.reduceat(travel, np.flatnonzero(begins))
    before = np.cumsum(covered) - covered
    return np.asarray(travel + before[run])


EFFECT = Effect(
    name="run_in",
    summary="Friction falls with the distance travelled and then levels off.",
    equation="dtau = A*exp(-s/s0), s: way of all runs",
    source="Exponential running-in of lubricated contacts; size is an engineering estimate",
    channel="friction",
    shape=(
        Parameter(
            name="distance",
            symbol="s0",
            unit="deg",
            lower=3_600.0,
            upper=3_600_000.0,
            description="Distance after which 37 % of the running-in remain",
            search="logarithmic",
        ),
    ),
    coefficients=(
        Parameter(
            name="initial_excess",
            symbol="A",
            unit="torque",
            lower=0.0,
            upper=30.0,
            description="Friction above its settled value at the start",
        ),
    ),
    basis=basis,
    needs=("travel",),
    signature=Signature(
        axis="travel",
        claim="Friction starts above the model and falls with the distance travelled, not with"
        " time.",
    ),
    statement=(
        "Friction was {initial_excess} above its settled value at the start and falls with"
        " the distance travelled."
    ),
    confounders=("drift", "thermal_lag", "rest_recovery"),
    experiment=(
        "Compare two stretches of equal duration, one with much motion and one at rest:"
        " running-in continues only with motion, and does not return on the next day."
    ),
)

OF_LOGGED = replace(EFFECT, basis=basis_of_logged)
"""The same of a joint whose motor is heated between recordings without motion, as by a load that it
holds or by another joint. It is no cause of its own, but a rival of others."""
