"""State of a logged joint at each sample, as the laws of planted effects take it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.challenge.logged_run import LoggedRun, strokes_of
from frictioncli.challenge.operation import motor_temperature, operating_histories
from frictioncli.model.document import FrictionModel
from frictioncli.model.friction import FrictionParameters, friction_torque
from frictioncli.simulator.planted.listed_speed_and_load import gear_minus_motor
from frictioncli.simulator.planted.operating_history import OperatingHistory
from frictioncli.simulator.planted.state import State
from frictioncli.simulator.thermal_history import MOTOR

_STANDING = 0.1
"""Share of the lowest speed of pairs below which the joint stands."""

_LEAST_SPEED = 1e-3
"""Speed of a joint that stands. [deg/s]"""

_GEAR_LAG = 10.0
"""Time constant with which the gear follows the motor, for laws that ask for it. [min]"""

_USUAL_POWER = 50.0
"""Mean power that stands for one that the unit of the torque does not tell. [W]"""

_GEAR = "gear"
"""Key of the gear among the temperatures."""


@dataclass(frozen=True, slots=True)
class FittedJoint:
    """The joint as far as its log tells it: friction by the base model that was fitted to it.

    Attributes
    ----------
    parameters : FrictionParameters
        Parameters of equation (16).
    """

    parameters: FrictionParameters

    def friction(
        self, *, load: ArrayLike, speed: ArrayLike, temperatures: Mapping[str, ArrayLike]
    ) -> Array:
        """Return the friction of the base model [torque unit]."""
        return friction_torque(
            self.parameters, load=load, speed=speed, temperature=temperatures[MOTOR]
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LogState(State):
    """State of a logged joint at the samples of one run.

    Attributes
    ----------
    run : LoggedRun
        The samples.
    joint : FittedJoint
        The joint as the base model describes it.
    standing : float
        Speed below which friction falls linearly to zero. [deg/s]
    turned : ndarray, shape (samples,)
        Angle since the last reversal. [deg]
    """

    run: LoggedRun
    joint: Any
    standing: float
    turned: Array

    @property
    def speed(self) -> Array:
        """Absolute velocity, never 0: laws have its logarithm [deg/s]."""
        return np.maximum(np.abs(self.velocity), _LEAST_SPEED)

    @property
    def direction(self) -> Array:
        """+1 forward, -1 in reverse, in between near rest [-]."""
        return np.clip(self.velocity / self.standing, -1.0, 1.0)

    @property
    def since_turn(self) -> Array:
        """Angle since the last reversal [deg]."""
        return self.turned


def log_states(
    runs: Sequence[LoggedRun], torques: pd.DataFrame, model: FrictionModel
) -> list[LogState]:
    """Return the state of a joint in each run.

    The load is what the pairs measured at that angle, or the log's own load channel; friction is
    the rest of the logged torque, noise included.

    Parameters
    ----------
    runs : sequence of LoggedRun
        The joint's runs.
    torques : DataFrame
        Its rows of :data:`frictioncli.schemas.TORQUES`.
    model : FrictionModel
        Its fitted model.
    """
    standing = _STANDING * float(torques["speed"].min())
    joint = FittedJoint(model.friction)
    loads = [measured_load(run, torques) for run in runs]
    frictions = [_friction(run, load, model.sign) for run, load in zip(runs, loads, strict=True)]
    powers = _powers(joint, runs, loads, model.torque_unit)
    histories = operating_histories(runs, powers, standing)
    return [
        _state(run, joint, operation, load, friction, standing)
        for run, operation, load, friction in zip(runs, histories, loads, frictions, strict=True)
    ]


def measured_load(run: LoggedRun, torques: pd.DataFrame) -> Array:
    """Return the load torque at each sample: of the log's channel, or of the pairs by angle.

    Parameters
    ----------
    run : LoggedRun
        The run.
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of the joint.
    """
    if np.isfinite(run.load).any():
        known = np.isfinite(run.load)
        return np.asarray(np.interp(run.time, run.time[known], run.load[known]))
    own = torques[torques["run"] == run.name]
    by_angle = (own if len(own) else torques).groupby("position")["load_torque"].mean()
    return np.asarray(np.interp(run.position, by_angle.index.to_numpy(float), by_angle.to_numpy()))


def _friction(run: LoggedRun, load: Array, sign: int) -> Array:
    carried = np.zeros_like(load) if np.isfinite(run.load).any() else load
    return np.asarray(sign * np.sign(run.velocity) * (run.torque - carried))


def _powers(
    joint: FittedJoint, runs: Sequence[LoggedRun], loads: Sequence[Array], unit: str
) -> list[Array]:
    """Return the power that friction dissipates; its mean is assumed where the unit is not N·m."""
    powers = [
        np.abs(
            joint.friction(
                load=load,
                speed=np.abs(run.velocity),
                temperatures={MOTOR: motor_temperature(run)},
            )
            * np.radians(run.velocity)
        )
        for run, load in zip(runs, loads, strict=True)
    ]
    if unit == "N·m":
        return powers
    mean = float(np.mean(np.concatenate(powers)))
    return [power * (_USUAL_POWER / mean if mean > 0 else 0.0) for power in powers]


def _state(
    run: LoggedRun,
    joint: FittedJoint,
    operation: OperatingHistory,
    load: Array,
    friction: Array,
    standing: float,
) -> LogState:
    strokes = strokes_of(run, standing)
    motor = motor_temperature(run)
    lag = gear_minus_motor(operation, magnitude=_GEAR_LAG, heating=0.0, loss=np.inf, stirring=0.0)
    return LogState(
        run=run,
        joint=joint,
        operation=operation,
        time=run.time,
        position=run.position,
        velocity=run.velocity,
        acceleration=run.acceleration,
        since_reversal=strokes.since_start,
        temperatures={MOTOR: motor, _GEAR: motor + operation.at(run.time, lag)},
        load=load,
        friction=friction,
        inertial=np.zeros_like(load),
        standing=standing,
        turned=strokes.since_turn,
    )
