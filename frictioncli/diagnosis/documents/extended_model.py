"""The extended model as ``extended-model.json`` holds it: read once, evaluated in one place."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.gravity import stated_gravity
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Effect
from frictioncli.errors import TableError
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import FrictionParameters

Part = TypeVar("Part")


@dataclass(frozen=True, slots=True)
class Term:
    """What one effect of the extended model adds to both channels, shape (rows,). [N·m]."""

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
    def of(cls, document: Mapping[str, Any]) -> "FittedEffect":
        """Return the effect that a document states, which is one of the catalogue.

        Raises
        ------
        TableError
            If its shape has other parameters than the catalogue's, as of another version.
        """
        effect = BY_NAME[document["name"]]
        shape = {name: float(value) for name, value in document["shape"].items()}
        known = {axis.name for axis in effect.shape}
        if set(shape) != known:
            raise TableError(
                f"{effect.name} has the shape parameters {sorted(shape)}, expected {sorted(known)}"
            )
        stated = [document["coefficients"][parameter.name] for parameter in effect.coefficients]
        coefficients = np.array([float(coefficient["estimate"]) for coefficient in stated])
        return cls(effect=effect, shape=shape, coefficients=coefficients)

    def at(self, problem: Problem) -> Term:
        """Return what it adds to a problem's rows."""
        basis = problem.basis(self.effect, self.shape)
        return Term(self.effect, basis.friction @ self.coefficients, basis.load @ self.coefficients)


@dataclass(frozen=True, slots=True, kw_only=True)
class Beyond:
    """What an extended model adds to the base, shape (rows,) each. [N·m]."""

    friction: Array
    load: Array
    terms: tuple[Term, ...]


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
    gravity, gravity_about : mapping of str to float
        Coefficients of gravity as refitted, and the base's; empty without effects.
    effects : tuple of FittedEffect
        The effects, in the order of the causes; without any it adds nothing to its base.
    """

    temperature: str
    parameters: FrictionParameters
    about: FrictionParameters
    gravity: Mapping[str, float]
    gravity_about: Mapping[str, float]
    effects: tuple[FittedEffect, ...]

    def beyond(self, problem: Problem) -> Beyond:
        """Return what it adds to the simulated torque of a problem's rows.

        Parameters
        ----------
        problem : Problem
            Rows with the base model that the extension started from.
        """
        friction, load = np.zeros_like(problem.friction), np.zeros_like(problem.load)
        if not self.effects:
            return Beyond(friction=friction, load=load, terms=())
        terms = tuple(effect.at(problem) for effect in self.effects)
        changes = [
            getattr(self.parameters, name) - getattr(problem.parameters, name)
            for name in problem.names
        ]
        gravity = stated_gravity(self.gravity, len(problem.gravity)) - problem.gravity
        friction = problem.friction_base @ np.array(changes) + problem.friction_by_gravity @ gravity
        return Beyond(
            friction=sum((term.friction for term in terms), friction),
            load=sum((term.load for term in terms), problem.load_base @ gravity),
            terms=terms,
        )


def read_extended(path: Path) -> dict[int, ExtendedModel]:
    """Return the extended model of each joint.

    Raises
    ------
    TableError
        If the file is missing, damaged, or names an effect that the catalogue does not have.
    """
    return read_by_joint(path, extended_model)


def extended_model(document: Mapping[str, Any]) -> ExtendedModel:
    """Return a joint's extended model from its part of ``extended-model.json``.

    Raises
    ------
    TableError
        If it names an effect that the catalogue does not have, or with another shape.
    """
    entries = document["effects"]
    unknown = sorted({entry["name"] for entry in entries} - set(BY_NAME))
    if unknown:
        raise TableError(f"unknown effects {', '.join(unknown)}")
    stated = {name: float(document["parameters"][name]["estimate"]) for name in PARAMETERS}
    about = {name: float(document["linear_about"][name]) for name in PARAMETERS if entries}
    for name in ("gravity", "gravity_about"):
        if entries:
            stated_gravity(document[name])
    return ExtendedModel(
        temperature=str(document["temperature"]),
        parameters=FrictionParameters(**stated),
        about=FrictionParameters(**(about or stated)),
        gravity=document["gravity"] if entries else {},
        gravity_about=document["gravity_about"] if entries else {},
        effects=tuple(FittedEffect.of(entry) for entry in entries),
    )


def read_by_joint(path: Path, take: Callable[[Mapping[str, Any]], Part]) -> dict[int, Part]:
    """Return what a file of the diagnosis holds of each joint.

    Parameters
    ----------
    path : Path
        ``diagnosis.json`` or ``extended-model.json``.
    take : callable
        Makes a joint's part into what is wanted.

    Raises
    ------
    TableError
        If the file is missing, or not of this program's form.
    """
    if not path.exists():
        raise TableError(f"{path} is missing; run 'frictioncli diagnose' first")
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
        parts = whole.get("joints", {"": whole}).values()
        return {int(part["joint"]): take(part) for part in parts}
    except TableError as error:
        raise TableError(f"{path}: {error}; run 'frictioncli diagnose' again") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise TableError(
            f"{path}: is not of this program's form ({error!r}); run 'frictioncli diagnose' again"
        ) from error
