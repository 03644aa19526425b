r"""What of an extended model can be carried by a controller, and what it then adds to friction.

The extended model is linear about its base
(:mod:`frictioncli.diagnosis.documents.extended_model`). With changes of the parameters and a
temperature of friction that is E above the one measured, it adds to (16)

.. math::

    \Delta\tau_c + \Delta\alpha L^2 + \left(\Delta\beta
    + e^{-\delta T} (\Delta\gamma - \gamma\,\Delta\delta\,T - \delta \gamma E) \right) \sqrt{v}

and the terms of effects that need nothing but load, speed and temperature.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.deployment.gear_temperature import GearLag
from frictioncli.diagnosis.data.gravity import stated_gravity
from frictioncli.diagnosis.data.problem import simulated
from frictioncli.diagnosis.documents.extended_model import ExtendedModel, FittedEffect
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import pair_heads
from frictioncli.model.friction import FrictionParameters, friction_torque

LAG = "thermal_lag"

MEMORYLESS = (
    "stribeck",
    "linear_viscous",
    "quadratic_drag",
    "coulomb_temperature",
    "load_linear",
    "load_velocity",
    "load_temperature",
)
"""Effects that need nothing but load, speed and temperature at the moment."""

_WHY_NOT = {
    "velocity_exponent": "refers to the mean speed of the log",
    "drift": "goes with the time since the first log",
    "run_in": "goes with the hours since the first log",
    "rest_recovery": "goes with the rests between the log's series",
    "step_change": "happened at one moment of the log",
    "reversal_transient": "goes with the angle since the joint turned",
    "position_ripple": "goes with the angle",
    "inertia": "goes with acceleration, and is no friction",
}
_NO_FRICTION = "shows in the load, not in friction"


@dataclass(frozen=True, slots=True, kw_only=True)
class DeployedExtension:
    """The part of an extended model that goes along.

    Attributes
    ----------
    about, parameters : FrictionParameters
        Parameters of the base about which the model is linear, and as refitted.
    gear : GearLag or None
        The gear's own temperature, where it was found.
    terms : tuple of FittedEffect
        Effects without memory.
    left_out : mapping of str to str
        Effects that cannot be carried, and why.
    """

    about: FrictionParameters
    parameters: FrictionParameters
    gear: GearLag | None
    terms: tuple[FittedEffect, ...]
    left_out: Mapping[str, str]

    def beyond(
        self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike, excess: ArrayLike
    ) -> Array:
        """Return the friction torque beyond the base. [torque unit].

        Parameters
        ----------
        load, speed, temperature : array_like, shape (rows,) or ()
            Load torque, absolute velocity, and the temperature that the base is given, without
            correction. [N·m], [deg/s], [°C]
        excess : array_like, shape (rows,) or ()
            How much warmer than that the place of friction is, by the gear's state. [°C]
        """
        wanted = (load, speed, temperature, excess)
        load, speed, temperature, excess = np.broadcast_arrays(*wanted, subok=False)
        p, q = self.about, self.parameters
        fall = (q.gamma - p.gamma) - p.gamma * (q.delta - p.delta) * temperature
        viscous = (q.beta - p.beta) + np.exp(-p.delta * temperature) * (
            fall - p.delta * p.gamma * excess
        )
        added = (q.tau_c - p.tau_c) + (q.alpha - p.alpha) * np.square(load)
        added = added + viscous * np.sqrt(speed)
        if not self.terms:
            return np.asarray(added)
        table = _table(p, load.ravel(), speed.ravel(), temperature.ravel())
        terms = sum(
            term.effect.evaluate(table, term.shape).friction @ term.coefficients
            for term in self.terms
        )
        return np.asarray(added + np.reshape(terms, added.shape))


def carried(
    torques: pd.DataFrame,
    model: ExtendedModel,
    time_constant_ci95: tuple[float, float] | None,
) -> DeployedExtension | None:
    """Return what of an extended model can be carried; none if it has no effects.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint: what the gear's state refers to.
    model : ExtendedModel
        The extended model.
    time_constant_ci95 : (float, float) or None
        95 % interval of the gear's time constant, as the diagnosis says. [s]
    """
    if not model.effects:
        return None
    own = {fitted.effect.name: fitted for fitted in model.effects}
    lag = own.get(LAG)
    return DeployedExtension(
        about=model.about,
        parameters=model.parameters,
        gear=_gear(torques, model, lag, time_constant_ci95) if lag else None,
        terms=tuple(fitted for name, fitted in own.items() if name in MEMORYLESS),
        left_out={
            name: _WHY_NOT.get(name, _NO_FRICTION)
            for name in own
            if name != LAG and name not in MEMORYLESS
        },
    )


def _gear(
    torques: pd.DataFrame,
    model: ExtendedModel,
    fitted: FittedEffect,
    time_constant_ci95: tuple[float, float] | None,
) -> GearLag:
    gravity = stated_gravity(model.gravity_about)
    _, problem = simulated(torques, model.temperature, model.about, gravity)
    table = problem.table
    first = pair_heads(table).first
    columns = fitted.effect.evaluate(table, fitted.shape).friction[first, :2]
    slope = np.where(table.temperature_slope[first] < 0, table.temperature_slope[first], -np.inf)
    usual = columns @ fitted.coefficients[:2] / slope
    lag_share, friction_heating, housing_share = (float(value) for value in fitted.coefficients)
    return GearLag(
        time_constant=float(fitted.shape["time_constant"]),
        time_constant_ci95=time_constant_ci95,
        lag_share=lag_share,
        friction_heating=friction_heating,
        housing_share=housing_share,
        reference_power=100.0 * float(np.mean(np.abs(table.friction))),
        start_sd=float(np.sqrt(np.mean(np.square(usual)))),
    )


def _table(about: FrictionParameters, load: Array, speed: Array, temperature: Array) -> EffectTable:
    """Return moments that have no past as a table of effects."""
    rows = np.arange(len(load))
    decay = np.exp(-about.delta * temperature)
    unknown = np.full(len(load), np.nan)
    return EffectTable(
        run=np.zeros_like(rows),
        pair=rows,
        time=unknown,
        clock=unknown,
        speed=speed,
        position=unknown,
        load=load,
        temperature=temperature,
        motor_temperature=unknown,
        housing_temperature=unknown,
        friction=friction_torque(about, load=load, speed=speed, temperature=temperature),
        viscous=about.beta + about.gamma * decay,
        temperature_slope=-about.delta * about.gamma * decay * np.sqrt(speed),
        load_slope=2 * about.alpha * load,
        travel=unknown,
        rest=unknown,
        order=unknown,
    )
