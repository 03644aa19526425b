r"""Equation of motion of one joint, linear in all but two of its parameters.

.. math::

    u(t) = J \ddot\varphi + a \cos\varphi + b \sin\varphi + c
    + \operatorname{sign}(\dot\varphi) \left( \tau_c + \alpha L^2
    + (\beta + \gamma e^{-\delta T}) \sqrt{|\dot\varphi|} + f(|\dot\varphi|) \right)

with a free law of the speed *f* (:mod:`frictioncli.regression.speed_law`), and with all of the
right-hand side at :math:`t - d`: the logged torque may lag behind the logged position. The columns
are Taylor series about a known delay, of which the torque of the rows is free already, and hold
only near it. Only :math:`\delta` and :math:`d` are nonlinear. The load *L* is the gravity of the
fit before, or that of a load channel, which then stands in place of cosine and sine beside them.
"""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array, Flags, Numbers
from frictioncli.regression.arm_dynamics import ArmColumns
from frictioncli.regression.friction_rivals import RIVALS, rival_columns
from frictioncli.regression.motion_rows import MotionRows
from frictioncli.regression.speed_law import NO_LAW, SpeedLaw

FRICTION_TERMS = ("tau_c", "alpha", "beta", "gamma")
"""Linear parameters of equation (16)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EquationTerms:
    """Which terms the equation has.

    Attributes
    ----------
    friction : tuple of str
        Those of :data:`FRICTION_TERMS`.
    speed_law : SpeedLaw
        What friction has of the speed beside them; a law without functions where it has nothing.
    rivals : bool
        Whether there are the columns of :mod:`~frictioncli.regression.friction_rivals`, beside
        which Coulomb friction and its kin have no meaning.
    offset : bool
        Whether there is a constant torque; motion in one direction cannot tell it from friction.
    gravity : bool
        Whether there are cosine and sine of the angle; a log without angles has none.
    load_channel : bool
        Whether a measured load stands in the torque.
    delay : bool
        Whether the torque may lag behind the position.
    base_parameters : int
        Number of base parameters of the whole arm, in place of inertia and gravity of one joint; 0
        without its kinematics.
    payloads, poses : tuple of float
        Payload [kg] and number of the pose of the other joints, NaN where unknown, in each state of
        the load; every state has an inertia and a gravity of its own.
    """

    friction: tuple[str, ...] = FRICTION_TERMS
    speed_law: SpeedLaw = NO_LAW
    rivals: bool = False
    offset: bool = True
    gravity: bool = True
    load_channel: bool = False
    delay: bool = True
    base_parameters: int = 0
    payloads: tuple[float, ...] = (float("nan"),)
    poses: tuple[float, ...] = (float("nan"),)

    def without(self, *names: str) -> "EquationTerms":
        """Return the terms without some of the friction terms."""
        return replace(self, friction=tuple(one for one in self.friction if one not in names))

    @property
    def load_names(self) -> tuple[str, ...]:
        """Names of the linear parameters that are not of friction."""
        names = [f"base_{number + 1}" for number in range(self.base_parameters)]
        for number in range(len(self.payloads) if not names else 0):
            suffix = f"_{number + 1}" if number else ""
            names.append(f"inertia{suffix}")
            if self.gravity:
                names += [f"gravity_cos{suffix}", f"gravity_sin{suffix}"]
        return (*names, *(["load"] if self.load_channel else []), *(["offset"] * self.offset))

    @property
    def friction_names(self) -> tuple[str, ...]:
        """Names of the linear parameters of friction."""
        return (*self.friction, *self.speed_law.names, *(RIVALS if self.rivals else ()))

    @property
    def linear(self) -> tuple[str, ...]:
        """Names of the linear parameters in the order of the columns."""
        return (*self.load_names, *self.friction_names)

    @property
    def nonlinear(self) -> tuple[str, ...]:
        """Names of the others."""
        return (*(["delta"] if "gamma" in self.friction else []), *(["delay"] * self.delay))


@dataclass(frozen=True, slots=True, kw_only=True)
class JointEquations:
    """Rows of one joint as equations.

    Attributes
    ----------
    rows : MotionRows
        The rows.
    speed_from_position : bool
        Whether velocity and acceleration are those of the position, or of the logged velocity.
    temperature : ndarray, shape (rows,)
        Temperature of equation (16), zero where there is none. [°C]
    state : ndarray of int, shape (rows,)
        Number of the state of the load, payload and pose, among those of the terms.
    arm : ArmColumns or None
        Columns of the base parameters of the whole arm.
    known_delay : float
        Delay that the torque of the rows is free of. [s]
    """

    rows: MotionRows
    speed_from_position: bool
    temperature: Array
    state: Numbers
    arm: ArmColumns | None = None
    known_delay: float = 0.0

    @property
    def velocity(self) -> Array:
        """Velocity [deg/s]."""
        return self.rows.position_slope if self.speed_from_position else self.rows.velocity

    @property
    def acceleration(self) -> Array:
        """Acceleration [deg/s²]."""
        return self.rows.acceleration if self.speed_from_position else self.rows.velocity_slope

    @property
    def jerk(self) -> Array:
        """Rate of change of the acceleration [deg/s³]."""
        return self.rows.jerk if self.speed_from_position else self.rows.velocity_curvature

    @property
    def direction(self) -> Array:
        """+1 where the position grows, -1 where it falls."""
        return np.where(self.velocity >= 0, 1.0, -1.0)

    def where(self, kept: Flags) -> "JointEquations":
        """Return the equations of some rows.

        Parameters
        ----------
        kept : ndarray of bool, shape (rows,)
            Whether each is kept.
        """
        return replace(
            self,
            rows=self.rows.where(kept),
            temperature=self.temperature[kept],
            state=self.state[kept],
            arm=None if self.arm is None else self.arm.where(kept),
        )


def load_columns(equations: JointEquations, terms: EquationTerms, delay: float) -> Array:
    """Return the columns of inertia, gravity, measured load and offset.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    terms : EquationTerms
        The terms.
    delay : float
        Delay of the torque. [s]

    Returns
    -------
    ndarray, shape (rows, columns)
        In the order of :attr:`EquationTerms.load_names`.
    """
    rows, velocity, acceleration = equations.rows, equations.velocity, equations.acceleration
    rest = delay - equations.known_delay
    angle = np.radians(rows.position - rest * velocity + rest**2 / 2 * acceleration)
    acceleration = np.radians(acceleration - rest * equations.jerk)
    columns = [] if equations.arm is None else [*equations.arm.torque.T]
    # the average of a cosine over the filter's weights is smaller than that of the mean angle
    shrink = np.exp(-np.square(np.radians(velocity)) * rows.variance / 2)
    for number in range(len(terms.payloads) if equations.arm is None else 0):
        here = (equations.state == number).astype(float)
        columns.append(here * acceleration)
        if terms.gravity:
            columns += [here * shrink * np.cos(angle), here * shrink * np.sin(angle)]
    if terms.load_channel:
        columns.append(rows.load)
    if terms.offset:
        columns.append(np.ones(len(rows)))
    return np.stack(columns, axis=1)


def root_speed(equations: JointEquations, delay: float) -> Array:
    """Return the average of the root of the speed over the filter's weights.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    delay : float
        Delay of the torque. [s]

    Returns
    -------
    ndarray, shape (rows,)
        Root of the mean speed, less what its changes make of the average. [(deg/s)^0.5]
    """
    rest = delay - equations.known_delay
    speed = np.maximum(np.abs(equations.velocity - rest * equations.acceleration), 1e-9)
    change = np.square(equations.acceleration) * equations.rows.variance / np.square(speed)
    # the root of a speed that grows from zero is averaged a little below the root of its mean
    return np.asarray(np.sqrt(speed) * (1 - np.minimum(change, 0.5) / 8))


def friction_columns(
    equations: JointEquations,
    terms: EquationTerms,
    squared_load: Array,
    delta: float,
    delay: float,
) -> Array:
    """Return the columns of friction, with the sign of the motion.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    terms : EquationTerms
        The terms.
    squared_load : ndarray, shape (rows,)
        Square of the load torque. [(N·m)²]
    delta : float
        Rate of the decrease with temperature. [1/°C]
    delay : float
        Delay of the torque. [s]

    Returns
    -------
    ndarray, shape (rows, columns)
        In the order of ``terms.friction_names``.
    """
    root = root_speed(equations, delay)
    of = {
        "tau_c": np.ones(len(root)),
        "alpha": squared_load,
        "beta": root,
        "gamma": root * np.exp(-delta * equations.temperature),
    }
    own = [of[name][:, np.newaxis] for name in terms.friction]
    stacked = np.hstack([*own, terms.speed_law.columns(np.square(root))])
    columns = equations.direction[:, np.newaxis] * stacked
    if not terms.rivals:
        return columns
    rivals = rival_columns(
        root=root,
        acceleration=equations.acceleration,
        direction=equations.direction,
        travel=equations.rows.travel,
        load=np.sqrt(squared_load),
    )
    return np.hstack([columns, rivals])


def load_derivatives(equations: JointEquations, terms: EquationTerms, delay: float) -> Array:
    """Return what a unit of each coefficient of :func:`load_columns` adds to the load at rest.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    terms : EquationTerms
        The terms.
    delay : float
        Delay of the torque. [s]

    Returns
    -------
    ndarray, shape (rows, columns)
        The columns; zeros where they are of inertia.
    """
    columns = load_columns(equations, terms, delay)
    if equations.arm is not None:
        columns[:, : terms.base_parameters] = equations.arm.gravity
    for index, name in enumerate(terms.load_names):
        if name.startswith("inertia"):
            columns[:, index] = 0.0
    return columns


def load_torque(
    equations: JointEquations, terms: EquationTerms, coefficients: Array, delay: float
) -> Array:
    """Return gravity, measured load and offset of a fit, without inertia, shape (rows,) [N·m].

    Parameters
    ----------
    equations : JointEquations
        The rows.
    terms : EquationTerms
        The terms.
    coefficients : ndarray, shape (columns,)
        Those of :func:`load_columns`.
    delay : float
        Delay of the torque. [s]
    """
    return np.asarray(load_derivatives(equations, terms, delay) @ coefficients)
