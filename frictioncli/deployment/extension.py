r"""Deployable part of an extended model, and the friction that it adds.

The extended model is linear about its base
(:mod:`frictioncli.diagnosis.documents.extended_model`) at the temperature of the gear, T + E. With
changes of the parameters it adds to (16)

.. math::

    \Delta\tau_c + \Delta\alpha L^2 + \left(\Delta\beta
    + e^{-\delta (T + E)} (\gamma + \Delta\gamma - \gamma\,\Delta\delta\,(T + E))
    - \gamma e^{-\delta T} \right) \sqrt{v}

and the terms of effects that depend only on load, speed and temperature.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.deployment.empirical import empirical_torque
from frictioncli.deployment.gear_temperature import GearLag
from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import stated_gravity
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.documents.extended_model import ExtendedModel, FittedEffect
from frictioncli.diagnosis.empirical.term import EmpiricalTerm
from frictioncli.effects.base import Basis, EffectTable
from frictioncli.model.friction import FrictionParameters, friction_torque

LAG = "thermal_lag"
"""Name of the effect that a gear temperature describes."""

MEMORYLESS = (
    "stribeck",
    "linear_viscous",
    "quadratic_drag",
    "coulomb_temperature",
    "load_linear",
    "load_velocity",
    "load_temperature",
)
"""Effects that depend only on present load, speed and temperature."""

_REASONS = {
    "velocity_exponent": "depends on the mean speed of the log",
    "drift": "depends on the time since the first log",
    "run_in": "depends on the hours since the first log",
    "rest_recovery": "depends on the rests between the log's series",
    "step_change": "was present during parts of the log only",
    "torque_scale": "scales friction and load, and was present during parts of the log only",
    "reversal_transient": "depends on the angle since the last reversal",
    "position_ripple": "depends on the angle",
    "inertia": "depends on acceleration, and is not friction",
}
_MEASUREMENT_REASON = "is a property of the log, not of the joint"
_LOAD_REASON = "shows in the load, not in friction"


@dataclass(frozen=True, slots=True, kw_only=True)
class DeployedExtension:
    """Deployable part of an extended model.

    Attributes
    ----------
    about, parameters : FrictionParameters
        Parameters of the base model about which the extension is linear, and refitted ones.
    gear : GearLag or None
        Thermal lag of the gear, if it is part of the model.
    terms : tuple of FittedEffect
        Effects without memory.
    left_out : mapping of str to str
        Reason for each effect that cannot be deployed.
    empirical : EmpiricalTerm or None
        Torque without a known cause. It goes with the angle, so that it is evaluated by itself.
    """

    about: FrictionParameters
    parameters: FrictionParameters
    gear: GearLag | None
    terms: tuple[FittedEffect, ...]
    left_out: Mapping[str, str]
    empirical: EmpiricalTerm | None = None

    def empirical_torque(
        self, *, position: ArrayLike, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike
    ) -> Basis:
        """Return the friction and load torque without a known cause; zeros where none is modelled.

        Parameters
        ----------
        position : array_like, shape (rows,)
            Joint angle. [deg]
        load : array_like, shape (rows,)
            Load torque. [N·m]
        speed : array_like, shape (rows,)
            Absolute velocity. [deg/s]
        temperature : array_like, shape (rows,)
            Temperature of the gear. [°C]

        Returns
        -------
        Basis
            Friction and load torque, shape (rows,) each. [torque unit]
        """
        if self.empirical is None:
            rows = np.atleast_1d(np.broadcast_arrays(position, load, speed, temperature)[0])
            return Basis(np.zeros(rows.shape), np.zeros(rows.shape))
        return empirical_torque(
            self.empirical,
            self.about,
            instants,
            position=position,
            load=load,
            speed=speed,
            temperature=temperature,
        )

    def added_friction(
        self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike, excess: ArrayLike
    ) -> Array:
        """Return the friction torque that the extension adds to the base model.

        Parameters
        ----------
        load : array_like, shape (rows,) or ()
            Load torque. [N·m]
        speed : array_like, shape (rows,) or ()
            Absolute velocity. [deg/s]
        temperature : array_like, shape (rows,) or ()
            Uncorrected temperature of the base model. [°C]
        excess : array_like, shape (rows,) or ()
            Temperature of the gear above it. [°C]

        Returns
        -------
        ndarray, shape (rows,) or ()
            Added friction torque. [torque unit]
        """
        inputs = (load, speed, temperature, excess)
        load, speed, temperature, excess = np.broadcast_arrays(*inputs, subok=False)
        p, q = self.about, self.parameters
        warm = temperature + excess
        falling = q.gamma - p.gamma * (q.delta - p.delta) * warm
        viscous = (q.beta - p.beta) + np.exp(-p.delta * warm) * falling
        viscous = viscous - p.gamma * np.exp(-p.delta * temperature)
        added = (q.tau_c - p.tau_c) + (q.alpha - p.alpha) * np.square(load)
        added = added + viscous * np.sqrt(speed)
        if not self.terms:
            return np.asarray(added)
        table = instants(p, load.ravel(), speed.ravel(), warm.ravel())
        terms = sum(
            term.effect.evaluate(table, term.shape).friction @ term.coefficients
            for term in self.terms
        )
        return np.asarray(added + np.reshape(terms, added.shape))


def deployable_extension(
    torques: pd.DataFrame,
    model: ExtendedModel,
    time_constant_ci95: tuple[float, float] | None,
) -> DeployedExtension | None:
    """Return the deployable part of an extended model; None if it has no effects.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint, to which the model was fitted.
    model : ExtendedModel
        The extended model.
    time_constant_ci95 : (float, float) or None
        95 % interval of the gear's time constant, from the diagnosis. [s]

    Returns
    -------
    DeployedExtension or None
        Gear temperature, effects without memory, the empirical term, and what is left out.
    """
    if model.adds_nothing:
        return None
    effects = {fitted.effect.name: fitted for fitted in model.effects}
    lag = effects.get(LAG)
    return DeployedExtension(
        about=model.about,
        parameters=model.parameters,
        gear=_gear_lag(torques, model, lag, time_constant_ci95) if lag else None,
        terms=tuple(fitted for name, fitted in effects.items() if name in MEMORYLESS),
        left_out={
            name: _MEASUREMENT_REASON
            if fitted.effect.measurement
            else _REASONS.get(name, _LOAD_REASON)
            for name, fitted in effects.items()
            if name != LAG and name not in MEMORYLESS
        },
        empirical=model.empirical,
    )


def _gear_lag(
    torques: pd.DataFrame,
    model: ExtendedModel,
    fitted: FittedEffect,
    time_constant_ci95: tuple[float, float] | None,
) -> GearLag:
    """Return the thermal lag of the gear with its usual size in the log."""
    gravity = stated_gravity(model.gravity_about)
    _, problem = simulated(
        torques, model.temperature, model.about, gravity, model.hidden, model.gravity_about.form
    )
    hidden = model.hidden or HiddenTemperature.of(
        fitted.shape["time_constant"], fitted.coefficients, problem.reference_power
    )
    inputs = hidden.inputs(problem.table)
    # what a filter adds to its input is what is unknown at a start
    lagging = inputs.excess(hidden.time_constant) - inputs.inputs_themselves()
    shares = {one.name: float(getattr(hidden, one.name)) for one in fitted.effect.coefficients}
    return GearLag(
        time_constant=hidden.time_constant,
        time_constant_ci95=time_constant_ci95,
        housing_time_constant=hidden.housing_time_constant,
        reference_power=hidden.reference_power,
        start_sd=float(np.sqrt(np.mean(np.square(lagging @ hidden.coefficients)))),
        **shares,
    )


def instants(
    about: FrictionParameters,
    load: Array,
    speed: Array,
    temperature: Array,
    position: Array | None = None,
) -> EffectTable:
    """Return instants without history as an effect table.

    Parameters
    ----------
    about : FrictionParameters
        Parameters of the base model.
    load, speed, temperature : ndarray, shape (rows,)
        Load torque [N·m], speed [deg/s] and temperature of the gear [°C].
    position : ndarray, shape (rows,), optional
        Joint angle. [deg]
    """
    rows = np.arange(len(load))
    decay = np.exp(-about.delta * temperature)
    unknown = np.full(len(load), np.nan)
    return EffectTable(
        run=np.zeros_like(rows),
        pair=rows,
        time=unknown,
        clock=unknown,
        speed=speed,
        position=unknown if position is None else position,
        angle=unknown if position is None else position,
        load=load,
        load_gradient=unknown,
        load_curvature=unknown,
        temperature=temperature,
        measured_temperature=temperature,
        motor_temperature=unknown,
        housing_temperature=unknown,
        friction=friction_torque(about, load=load, speed=speed, temperature=temperature),
        viscous=about.beta + about.gamma * decay,
        temperature_slope=-about.delta * about.gamma * decay * np.sqrt(speed),
        load_slope=2 * about.alpha * load,
        friction_power=unknown,
        moved=unknown,
        warmed_to=unknown,
        travel=unknown,
        rest=unknown,
        order=unknown,
    )
