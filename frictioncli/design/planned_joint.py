"""The joint that a programme is planned for, with a guess of all parameters."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.design.limits import Limits
from frictioncli.design.thermal_model import ThermalModel, thermal_model_of
from frictioncli.diagnosis.data.gravity import known_payload
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.model.friction import PUBLISHED, FrictionParameters

PLANNING_COLUMNS = (
    *("run", "joint", "pair", "speed", "time", "phase", "motor_temperature"),
    *("housing_temperature", "position", "motor_temperature_reading", "load", "payload"),
    *("friction_torque", "load_torque"),
)
"""Columns of the torque table that planning needs."""


_USUAL_LEVER = 0.5 * 9.80665
"""Gravity torque of a mass at half a metre, where no payload was changed yet. [N·m/kg]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedJoint:
    """What is known of the joint that a programme is planned for.

    Attributes
    ----------
    torques : DataFrame
        Observed rows of a single joint, as returned by :func:`planning_columns`.
    temperature : {"motor", "housing", "mean"}
        Temperature that enters the friction model.
    parameters : FrictionParameters
        Parameters of the base model.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of the gravity torque. [N·m], [N·m/kg]
    thermal_model : ThermalModel or None
        Thermal model of the motor; None where its temperature is not known.
    waiting : float
        Motor temperature above which motion waits. [°C]
    angle_logged : bool
        Whether the log has the joint's angle. Without it a pair has a single row, as observed.
    """

    torques: pd.DataFrame
    temperature: str
    parameters: FrictionParameters
    gravity: Array
    thermal_model: ThermalModel | None
    waiting: float = np.inf
    angle_logged: bool = True

    @property
    def payload(self) -> float | None:
        """Mounted payload, as far as the last run tells [kg]."""
        known = known_payload(self.torques)
        return float(known[-1]) if len(known) and np.isfinite(known[-1]) else None


def planned_joint(
    torques: pd.DataFrame, temperature: str, problem: Problem, limits: Limits, *, angle_logged: bool
) -> PlannedJoint:
    """Return the joint that a programme is planned for.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that enters the friction model.
    problem : Problem
        The base model, fitted to them.
    limits : Limits
        Limits of the motion.
    angle_logged : bool
        Whether the log has the joint's angle.
    """
    return PlannedJoint(
        torques=planning_columns(torques),
        temperature=temperature,
        parameters=_planning_parameters(problem),
        gravity=_planning_gravity(problem, limits),
        thermal_model=thermal_model_of(torques),
        waiting=limits.waiting,
        angle_logged=angle_logged,
    )


def planning_columns(torques: pd.DataFrame) -> pd.DataFrame:
    """Return the columns of a torque table that planning needs, labels as plain text."""
    return torques[list(PLANNING_COLUMNS)].astype({"run": str, "phase": str}).reset_index(drop=True)


def _planning_parameters(problem: Problem) -> FrictionParameters:
    """Return the fitted friction parameters; undetermined ones have a usual value.

    A locally optimal design needs a guess of the parameters [1]_. Where the decay with temperature
    is not determined, the published rate is taken, and half of the viscous part decays.

    References
    ----------
    .. [1] H. Chernoff, "Locally optimal designs for estimating parameters," Ann. Math. Stat. 24(4),
       1953, doi:10.1214/aoms/1177728915.
    """
    fitted = problem.parameters
    if fitted.gamma > 0 and fitted.delta > 0:
        return fitted
    temperature = float(np.mean(problem.table.temperature)) or 20.0
    viscous = max(fitted.beta, 1e-3 * float(np.mean(np.abs(problem.friction))))
    return replace(
        fitted,
        beta=viscous / 2,
        gamma=viscous / 2 * float(np.exp(PUBLISHED.delta * temperature)),
        delta=PUBLISHED.delta,
    )


def _planning_gravity(problem: Problem, limits: Limits) -> np.ndarray:
    """Return the fitted gravity coefficients; an unmeasured payload gets a usual lever."""
    # a programme is driven in one pose of the other joints
    gravity = problem.gravity[: problem.gravity_form.first_coefficients]
    if problem.gravity_form.payloads or not limits.payloads:
        return gravity
    return np.append(gravity, [_USUAL_LEVER, 0.0])
