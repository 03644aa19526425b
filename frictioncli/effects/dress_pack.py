"""Cables and hoses along the arm pull like a spring.

A spring acts alike in both directions of motion and so belongs to the load channel. The rest angle
cannot be told from a constant offset, so the angle counts from the middle of the angles measured.
"""

import numpy as np

from frictioncli.effects.base import Basis, Effect, EffectTable, Parameter, Signature, load_only


def basis(table: EffectTable) -> Basis:
    """Return the angle from the middle of the angles measured, in rad."""
    middle = (np.min(table.position) + np.max(table.position)) / 2
    return load_only(np.radians(table.position - middle))


EFFECT = Effect(
    name="dress_pack",
    summary="Cables and hoses pull the joint like a spring.",
    equation="dL = k*(q - q0), q0 = middle of the angles",
    source="Linear spring in parallel to the joint; size is an engineering estimate",
    channel="load",
    shape=(),
    coefficients=(
        Parameter(
            name="stiffness",
            symbol="k",
            unit="torque/rad",
            lower=-10.0,
            upper=10.0,
            description="Spring stiffness; its sign follows that of the logged torque",
        ),
    ),
    basis=basis,
    needs=("position",),
    signature=Signature(
        axis="position",
        claim="The load torque is not a sine of the angle: a straight line adds to it.",
    ),
    confounders=("payload_change", "direction_asymmetry", "inertia"),
    experiment=(
        "Sweep the whole angle range with two payloads: the spring stays, gravity scales."
        " Repeat with the cables loosened."
    ),
    mirror="Friction must not change with the angle, save through the load.",
)
