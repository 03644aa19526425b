"""The catalogue of effects, one module each.

Friction and load that the friction model (16) lacks, and properties of the measurement that look
like them.
"""

from collections.abc import Mapping
from types import MappingProxyType

from frictioncli.effects import (
    backlash,
    coulomb_temperature,
    direction_asymmetry,
    dress_pack,
    drift,
    inertia,
    linear_viscous,
    load_linear,
    load_offset,
    load_temperature,
    load_velocity,
    payload_change,
    position_offset,
    position_ripple,
    quadratic_drag,
    rest_recovery,
    reversal_transient,
    run_in,
    sensor_lag,
    step_change,
    stribeck,
    thermal_lag,
    torque_constant,
    torque_delay,
    torque_filter,
    torque_scale,
    velocity_exponent,
)
from frictioncli.effects.base import Effect

EFFECTS: tuple[Effect, ...] = (
    stribeck.EFFECT,
    velocity_exponent.EFFECT,
    linear_viscous.EFFECT,
    quadratic_drag.EFFECT,
    coulomb_temperature.EFFECT,
    load_linear.EFFECT,
    load_velocity.EFFECT,
    load_temperature.EFFECT,
    thermal_lag.EFFECT,
    drift.EFFECT,
    run_in.EFFECT,
    rest_recovery.EFFECT,
    step_change.EFFECT,
    direction_asymmetry.EFFECT,
    torque_constant.EFFECT,
    payload_change.EFFECT,
    dress_pack.EFFECT,
    position_ripple.EFFECT,
    inertia.EFFECT,
    reversal_transient.EFFECT,
)
"""Effects of friction and load, in the order of reports."""

MEASUREMENT_EFFECTS: tuple[Effect, ...] = (
    load_offset.EFFECT,
    torque_delay.EFFECT,
    torque_filter.EFFECT,
    backlash.EFFECT,
    sensor_lag.EFFECT,
)
"""Effects of kind ``measurement``, in the order of reports.

They stand beside the base model from the start, so that no other effect explains what they do. A
lag of the sensor has the opposite sign of a gear that follows the motor, and takes nothing of it; a
gear that friction warms more than the motor looks much like it."""

RIVALS: tuple[Effect, ...] = (torque_scale.EFFECT, position_offset.EFFECT)
"""Effects that are not searched for: each looks like another one, and is told from it afterwards.

A change of the scale of the torque is told from one of the payload by the friction, one of the zero
of the position by the form of its load."""

BY_NAME: Mapping[str, Effect] = MappingProxyType(
    {effect.name: effect for effect in (*EFFECTS, *MEASUREMENT_EFFECTS, *RIVALS)}
)
"""All by name."""

NEEDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {effect.name: effect.needs for effect in BY_NAME.values()}
)
"""Columns that must be known and vary, by effect."""
