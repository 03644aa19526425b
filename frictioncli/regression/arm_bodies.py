"""What the regressions of all joints tell of the bodies of an arm: possible or not, payloads."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from frictioncli.arrays import Array
from frictioncli.regression.arm_dynamics import ArmModel
from frictioncli.regression.determination import JointRegression
from frictioncli.regression.equation import friction_columns
from frictioncli.regression.inertial_bodies import (
    BodyFit,
    BodyMass,
    JointTorques,
    body_mass,
    fit_bodies,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmBodies:
    """Bodies of an arm by the torques of its joints.

    Attributes
    ----------
    joints : tuple of int
        Joints whose torques were fitted.
    fit : BodyFit
        Fit by bodies that can be, beside least squares.
    payloads : tuple of (float, float, BodyMass or None)
        Each payload but the lightest: its mass as told, that of the lightest, and what it weighs
        more by the torques. [kg]
    unit : str
        Unit of the torque.
    """

    joints: tuple[int, ...]
    fit: BodyFit
    payloads: tuple[tuple[float, float, BodyMass | None], ...]
    unit: str

    def texts(self) -> list[str]:
        """Return the sentences on bodies and payloads."""
        fit, unit = self.fit, self.unit
        beside = f"beside a residual of {fit.rmse:.3g} {unit}"
        if fit.is_consistent:
            lines = [
                "arm: bodies could have the inertial parameters: the nearest miss"
                f" {fit.excess:.2g} {unit} RMS of the torques without friction, {beside}"
            ]
        else:
            each = ", ".join(
                f"joint {joint} {one:.2g}"
                for joint, one in zip(self.joints, fit.worst, strict=True)
            )
            lines = [
                "arm: no bodies can have the inertial parameters (pseudo-inertia not positive"
                f" definite): the nearest miss {fit.excess:.3g} {unit} RMS ({each}), {beside}; not"
                " forced, friction is as it was; check axes, lengths and directions of the URDF"
            ]
        for told, least, found in self.payloads:
            text = f"payload of {told:g} kg, {told - least:g} kg more than the lightest: "
            if found is None:
                lines.append(text + "the motion does not determine its mass")
                continue
            low, high = found.ci95
            lines.append(
                f"{text}{found.mass:.4g} ({low:.4g} to {high:.4g}) kg by the torques"
                + ("" if low <= told - least <= high else ", which contradicts the manifest")
            )
        return lines

    def facts(self) -> dict[str, Any]:
        """Return them for the metadata of the table."""
        return {
            "joints": list(self.joints),
            "physically_consistent": self.fit.is_consistent,
            "excess": self.fit.excess,
            "excess_by_joint": list(self.fit.worst),
            "rmse": self.fit.rmse,
            "p_value": self.fit.chance,
            "unit": self.unit,
            "payloads": [
                {
                    "told": told,
                    "more_than": least,
                    "estimate": None if found is None else found.mass,
                    "ci95": None if found is None else list(found.ci95),
                    "unit": "kg",
                }
                for told, least, found in self.payloads
            ],
        }


def arm_bodies(
    regressions: Mapping[int, JointRegression], model: ArmModel, unit: str
) -> ArmBodies | None:
    """Return what the regressions of an arm tell of its bodies.

    Parameters
    ----------
    regressions : mapping of int to JointRegression
        Regressions by joint.
    model : ArmModel
        Kinematics of the arm.
    unit : str
        Unit of the torque; bodies are told from a current too, their masses are not.

    Returns
    -------
    ArmBodies or None
        None where a load channel stands in place of the links' weight, or payloads differ between
        the joints.
    """
    prepared = [found.prepared for found in regressions.values()]
    lists = {str(one.payloads): one.payloads for one in prepared}
    if len(lists) != 1 or any(one.terms.load_channel for one in prepared):
        return None
    (told,) = lists.values()
    joints = [_torques(found) for found in regressions.values()]
    fit = fit_bodies(joints, model.start(max(len(told) - 1, 0)))
    masses = []
    if unit == "N·m":
        for number, mass in enumerate(told[1:]):
            masses.append((mass, told[0], body_mass(joints, model.joints + number)))
    return ArmBodies(joints=tuple(regressions), fit=fit, payloads=tuple(masses), unit=unit)


def _torques(found: JointRegression) -> JointTorques:
    """Return the torque of a joint without friction and offset, and the columns of all bodies."""
    estimate, equations = found.estimate, found.equations
    terms = estimate.terms
    delta = estimate.parameters.get("delta", 0.0)
    friction = friction_columns(equations, terms, estimate.squared_load, delta, estimate.delay)
    own = friction @ np.array([estimate.parameters[name] for name in terms.friction_names])
    torque = equations.rows.torque - own - estimate.parameters.get("offset", 0.0)
    assert equations.arm is not None
    return JointTorques(
        columns=equations.arm.bodies,
        torque=torque,
        deviation=_deviation(found, equations.arm.torque),
    )


def _deviation(found: JointRegression, columns: Array) -> float:
    """Return the standard deviation that independent rows would have for the same intervals."""
    estimate = found.estimate
    residual = float(np.sqrt(np.mean(np.square(estimate.residual))))
    known = np.hstack([columns, np.ones((len(columns), 1))])
    size = np.linalg.norm(known, axis=0)
    inverse = np.linalg.pinv((known / size).T @ (known / size), hermitian=True)
    plain = residual * np.sqrt(np.diag(inverse))[:-1] / size[:-1]
    names = estimate.names[: columns.shape[1]]
    ratios = [estimate.deviation(name) / one for name, one in zip(names, plain, strict=True)]
    return residual * max(float(np.median(ratios)), 1.0)
