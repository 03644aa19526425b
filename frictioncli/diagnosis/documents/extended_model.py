"""The extended model: its effects, and what it adds to the torque of a problem's rows."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.build_problem import at_temperature
from frictioncli.diagnosis.data.gravity_document import GravityCoefficients, stated_gravity
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.data.late_torque import LateTorque
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.term import EmpiricalTerm
from frictioncli.effects import BY_NAME, thermal_lag
from frictioncli.effects.base import Basis, Effect
from frictioncli.errors import TableError
from frictioncli.model.friction import FrictionParameters, friction_torque


@dataclass(frozen=True, slots=True)
class Term:
    """What one effect of the extended model adds to both channels, shape (rows,) [N·m]."""

    effect: Effect
    friction: Array
    load: Array

    def of(self, channel: str) -> Array:
        """Return the term in ``friction`` or ``load``."""
        return self.friction if channel == "friction" else self.load


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedEffect:
    """One effect with its shape and the coefficients that were fitted."""

    effect: Effect
    shape: Mapping[str, float]
    coefficients: Array

    @classmethod
    def of(
        cls, name: str, shape: Mapping[str, float], coefficients: Mapping[str, float]
    ) -> "FittedEffect":
        """Return an effect of the catalogue with stated parameters.

        Parameters
        ----------
        name : str
            Name of the effect.
        shape : mapping of str to float
            Its shape parameters.
        coefficients : mapping of str to float
            Its coefficients.

        Raises
        ------
        TableError
            If the catalogue does not have it, or with other parameters, as of another version.
        """
        if name not in BY_NAME:
            raise TableError(f"unknown effects {name}")
        effect = BY_NAME[name]
        if not effect.has_shape(shape):
            known = sorted(axis.name for axis in effect.shape)
            raise TableError(f"{name} has the shape parameters {sorted(shape)}, expected {known}")
        missing = [one.name for one in effect.coefficients if one.name not in coefficients]
        if missing:
            raise TableError(f"{name} lacks the coefficients {missing}")
        values = np.array([coefficients[one.name] for one in effect.coefficients])
        return cls(effect=effect, shape=shape, coefficients=values)

    def at(self, problem: Problem) -> Term:
        """Return what it adds to a problem's rows."""
        basis = problem.basis(self.effect, self.shape)
        return Term(self.effect, basis.friction @ self.coefficients, basis.load @ self.coefficients)


@dataclass(frozen=True, slots=True, kw_only=True)
class Beyond:
    """What an extended model adds to the base, shape (rows,) each [N·m].

    Attributes
    ----------
    friction, load : ndarray, shape (rows,)
        All of it.
    terms : tuple of Term
        Its effects.
    empirical : Basis or None
        Its empirical term.
    """

    friction: Array
    load: Array
    terms: tuple[Term, ...]
    empirical: Basis | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtendedModel:
    """Base model of one joint with effects, all refitted together; linear about the base.

    Attributes
    ----------
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    parameters : FrictionParameters
        Parameters of friction as refitted.
    about : FrictionParameters
        The base's, about which it is linear.
    gravity, gravity_about : GravityCoefficients
        Gravity as refitted, and the base's; not used without effects.
    effects : tuple of FittedEffect
        The effects, in the order of the causes, then those that are corrected without a name;
        without any, and without an empirical term, it adds nothing to its base.
    hidden : HiddenTemperature or None
        Temperature of the gear about which it is linear; none for the measured one.
    empirical : EmpiricalTerm or None
        Torque without a known cause.
    late : LateTorque or None
        Response behind which the torque was logged.
    """

    temperature: str
    parameters: FrictionParameters
    about: FrictionParameters
    gravity: GravityCoefficients
    gravity_about: GravityCoefficients
    effects: tuple[FittedEffect, ...]
    hidden: HiddenTemperature | None = None
    empirical: EmpiricalTerm | None = None
    late: LateTorque | None = None

    @property
    def adds_nothing(self) -> bool:
        """Whether it is its base."""
        return not self.effects and self.empirical is None

    def beyond(self, problem: Problem) -> Beyond:
        """Return what it adds to the simulated torque of a problem's rows.

        Parameters
        ----------
        problem : Problem
            Rows with the base model that the extension started from.
        """
        friction, load = np.zeros_like(problem.friction), np.zeros_like(problem.load)
        if self.adds_nothing:
            return Beyond(friction=friction, load=load, terms=())
        # about the base that the extension started from, at the temperature of the gear
        base = replace(problem, late=self.late)
        if self.hidden is not None:
            base = at_temperature(base, self.about, self.hidden)
        terms = tuple(self._term(effect, base) for effect in self.effects)
        changes = [
            getattr(self.parameters, name) - getattr(base.parameters, name) for name in base.names
        ]
        gravity = stated_gravity(self.gravity, base.gravity_form) - base.gravity
        friction = base.friction_base @ np.array(changes) + base.friction_by_gravity @ gravity
        friction = friction + _at_measured(base) - _at_measured(problem)
        empirical = None if self.empirical is None else self.empirical.at(base)
        load = base.load_base @ gravity
        if empirical is not None:
            friction, load = friction + empirical.friction, load + empirical.load
        return Beyond(
            friction=sum((term.friction for term in terms), friction),
            load=sum((term.load for term in terms), load),
            terms=terms,
            empirical=empirical,
        )

    def _term(self, effect: FittedEffect, base: Problem) -> Term:
        """Return what an effect adds; a lag of the gear beyond the measured temperature."""
        term = effect.at(base)
        if self.hidden is None or effect.effect is not thermal_lag.EFFECT:
            return term
        table = base.table
        carried = table.temperature_slope * (table.temperature - table.measured_temperature)
        return replace(term, friction=term.friction - carried + table.friction - _at_measured(base))


def _at_measured(problem: Problem) -> Array:
    """Return friction of a problem's parameters at the measured temperature, shape (rows,)."""
    table = problem.table
    return friction_torque(
        problem.parameters,
        load=table.load,
        speed=table.speed,
        temperature=table.measured_temperature,
    )
