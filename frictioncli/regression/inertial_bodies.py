r"""Whether bodies could have the inertial parameters of an arm, and what a payload weighs.

Ten parameters of a link (mass, first and second moments of mass) belong to a body if and only if
its pseudo-inertia is positive definite [1]_,

.. math::

    \begin{pmatrix} \tfrac12 \operatorname{tr}(I)\, 1 - I & h \\ h^T & m \end{pmatrix} \succ 0 .

Least squares do not know that. Here the joints' torques, less their friction, are fitted together
by parameters inside that cone, a convex problem that a logarithmic barrier solves [2]_; what that
fit cannot explain, and least squares can, is the excess. Nothing is forced: the friction stays what
it is.

References
----------
.. [1] P. M. Wensing, S. Kim, and J.-J. E. Slotine, "Linear matrix inequalities for physically
   consistent inertial parameter identification," IEEE Robotics and Automation Letters 3(1), 2018,
   doi:10.1109/LRA.2017.2729659.
.. [2] S. Boyd and L. Vandenberghe, "Convex Optimization," Cambridge University Press, 2004,
   doi:10.1017/CBO9780511804441, section 11.3.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.distributions import chi2_tail

_PER_BODY = 10
_RANK = 1e-6
_TOLD = 1e-3
"""Share of a parameter outside what the motion tells, up to which it is told."""
_PRIOR = 0.01
"""Weight of the start values against a whitened row: it decides only what the data leave open."""
_ROTOR = 0.1
"""Inertia of a rotor to start from. [kg·m²]"""
_LEAST_BARRIER = 1e-3
"""Last weight of the barrier; each is a quarter of the one before and starts from its end."""
_STEPS = 60
"""Most Newton steps for one weight."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointTorques:
    """Torque of one joint without its friction, and its columns.

    Attributes
    ----------
    columns : ndarray, shape (rows, 10 bodies + joints)
        Torque of a unit of each parameter: mass, first moments, and Ixx, Ixy, Iyy, Ixz, Iyz, Izz
        about the frame of each body, then the inertias of the rotors.
    torque : ndarray, shape (rows,)
        Measured torque without friction and offset. [N·m]
    deviation : float
        Standard deviation of a row, as if rows were independent. [N·m]
    """

    columns: Array
    torque: Array
    deviation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyFit:
    """Fit of an arm by bodies, beside that by least squares.

    Attributes
    ----------
    rmse : float
        Root mean square residual of least squares. [N·m]
    excess : float
        Root mean square of what bodies cannot explain, and least squares can. [N·m]
    chance : float
        Probability of so much excess, or more, if bodies made the torques. [-]
    worst : tuple of float
        The excess of each joint. [N·m]
    """

    rmse: float
    excess: float
    chance: float
    worst: tuple[float, ...]

    @property
    def is_consistent(self) -> bool:
        """Whether bodies could have made the torques."""
        return self.chance > 0.01 or self.excess < 0.02 * self.rmse


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyMass:
    """Mass of a body by least squares, where the motion tells it.

    Attributes
    ----------
    mass : float
        Mass. [kg]
    ci95 : (float, float)
        Its 95 % interval. [kg]
    """

    mass: float
    ci95: tuple[float, float]


def pseudo_inertia(parameters: Array) -> Array:
    """Return the pseudo-inertia of a body.

    Parameters
    ----------
    parameters : ndarray, shape (10,)
        Mass, first moments, and Ixx, Ixy, Iyy, Ixz, Iyz, Izz. [kg], [kg·m], [kg·m²]

    Returns
    -------
    ndarray, shape (4, 4)
        Positive definite if and only if a body can have these parameters.

    Examples
    --------
    A ball of 2 kg and 0.1 m; then one whose moment about x exceeds the sum of the others:

    >>> ball = np.array([2.0, 0, 0, 0, 0.008, 0, 0.008, 0, 0, 0.008])
    >>> bool(np.all(np.linalg.eigvalsh(pseudo_inertia(ball)) > 0))
    True
    >>> ball[4] = 0.02
    >>> bool(np.all(np.linalg.eigvalsh(pseudo_inertia(ball)) > 0))
    False
    """
    xx, xy, yy, xz, yz, zz = parameters[4:].tolist()
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    found = np.empty((4, 4))
    found[:3, :3] = np.trace(inertia) / 2 * np.eye(3) - inertia
    found[:3, 3] = found[3, :3] = parameters[1:4]
    found[3, 3] = parameters[0]
    return found


def fit_bodies(joints: Sequence[JointTorques], start: Array) -> BodyFit:
    """Return how well bodies explain the torques of an arm, beside least squares.

    Parameters
    ----------
    joints : sequence of JointTorques
        Torques of the joints.
    start : ndarray, shape (bodies, 10)
        Bodies to start from, each physically possible.

    Returns
    -------
    BodyFit
        The excess, and its chance by the F distribution of the parameters that bodies lack.
    """
    bodies = len(start)
    rotors = joints[0].columns.shape[1] - _PER_BODY * bodies
    table = np.vstack([one.columns / one.deviation for one in joints])
    target = np.concatenate([one.torque / one.deviation for one in joints])
    solution, rank = _least_squares(table, target)
    triangle = np.asarray(np.linalg.qr(np.column_stack([table, target]), mode="r"))
    known, right = triangle[:, :-1], triangle[:, -1]
    first = np.concatenate([start.reshape(-1), np.full(rotors, _ROTOR)])
    best = _possible(known, right, first, bodies)
    more, worst = 0.0, []
    left, rows = 0.0, 0
    for one in joints:
        free = one.torque - one.columns @ solution
        apart = one.columns @ (best - solution)
        worst.append(float(np.sqrt(np.mean(np.square(apart)))))
        more += float(np.sum(np.square(apart)))
        left += float(np.sum(np.square(free)))
        rows += len(one.torque)
    excess = float(np.sum(np.square(known @ (best - solution))))
    # whitened rows have a variance of one
    chance = chi2_tail(excess, rank)
    return BodyFit(
        rmse=float(np.sqrt(left / rows)),
        excess=float(np.sqrt(more / rows)),
        chance=chance,
        worst=tuple(worst),
    )


def _possible(known: Array, right: Array, first: Array, bodies: int) -> Array:
    """Return the parameters with the least squares of those that bodies can have.

    The problem is convex; a logarithmic barrier keeps inside, and is made smaller step by step.
    """
    cone = _Cone(first, bodies)
    start = first / cone.scale
    table = np.vstack([known * cone.scale, _PRIOR * np.eye(len(first))])
    target = np.concatenate([right, _PRIOR * start])
    gram, product = table.T @ table, table.T @ target
    at, weight = start, float(np.sum(np.square(table @ start - target)))
    while weight > _LEAST_BARRIER:
        weight /= 4
        for _ in range(_STEPS):
            slope, curvature = cone.derivatives(at)
            slope = gram @ at - product - weight * slope
            step = -np.linalg.solve(gram + weight * curvature, slope)
            down = float(-slope @ step)
            if down < 1e-3 * weight:
                break
            size = 1.0
            while size > 1e-9:
                new, moved = at + size * step, size * step
                change = float((gram @ at - product) @ moved + moved @ gram @ moved / 2)
                change -= weight * (cone.logarithm(new) - cone.logarithm(at))
                if change <= -1e-4 * size * down:
                    break
                size /= 2
            at = at + size * step
    return np.asarray(at * cone.scale)


class _Cone:
    """Parameters that bodies and rotors can have, in units of their start values.

    Parameters
    ----------
    first : ndarray, shape (parameters,)
        Start values, ten per body, then rotors.
    bodies : int
        Number of bodies.
    """

    def __init__(self, first: Array, bodies: int) -> None:
        self.parts = [slice(10 * body, 10 * body + 10) for body in range(bodies)]
        self.rotors = slice(10 * bodies, None)
        length = 0.3
        shape = np.repeat([1.0, length, length**2], [1, 3, 6])
        sizes = [first[part][0] * shape for part in self.parts]
        self.scale = np.concatenate([*sizes, first[self.rotors]])
        self.basis = np.stack([pseudo_inertia(one) for one in np.eye(10)])

    def logarithm(self, at: Array) -> float:
        """Return the logarithm of all determinants, minus infinity outside."""
        values: list[Array] = [at[self.rotors]]
        for part in self.parts:
            pseudo = pseudo_inertia(at[part] * self.scale[part])
            values.append(np.asarray(np.linalg.eigvalsh(pseudo), dtype=np.float64))
        found = np.concatenate(values)
        return float(np.sum(np.log(found))) if found.min() > 0 else -np.inf

    def derivatives(self, at: Array) -> tuple[Array, Array]:
        """Return its gradient, and its second derivatives with the other sign."""
        slope, curvature = np.zeros(len(at)), np.zeros((len(at), len(at)))
        slope[self.rotors] = 1 / at[self.rotors]
        curvature[self.rotors, self.rotors] = np.diag(1 / np.square(at[self.rotors]))
        for part in self.parts:
            inverse = np.linalg.inv(pseudo_inertia(at[part] * self.scale[part]))
            ways = inverse @ self.basis * self.scale[part][:, np.newaxis, np.newaxis]
            slope[part] = np.trace(ways, axis1=1, axis2=2)
            curvature[part, part] = np.einsum("aij,bji->ab", ways, ways)
        return slope, curvature


def body_mass(joints: Sequence[JointTorques], body: int) -> BodyMass | None:
    """Return the mass of a body by least squares, None where the motion does not tell it.

    Parameters
    ----------
    joints : sequence of JointTorques
        Torques of the joints.
    body : int
        Number of the body, from 0.
    """
    table = np.vstack([one.columns / one.deviation for one in joints])
    target = np.concatenate([one.torque / one.deviation for one in joints])
    size = np.linalg.norm(table, axis=0)
    scaled = table / np.where(size > 0, size, 1.0)
    _, values, right = np.linalg.svd(np.asarray(np.linalg.qr(scaled, mode="r")))
    kept = right[values > _RANK * values[0]]
    place = _PER_BODY * body
    unit = np.zeros(table.shape[1])
    unit[place] = 1.0
    within = kept @ unit
    if size[place] == 0 or 1 - float(within @ within) > _TOLD:
        return None
    solution, _ = _least_squares(table, target)
    inverse = kept.T @ (kept / np.square(values[: len(kept), np.newaxis]))
    half = float(1.96 * np.sqrt(inverse[place, place]) / size[place])
    mass = float(solution[place])
    return BodyMass(mass=mass, ci95=(mass - half, mass + half))


def _least_squares(table: Array, target: Array) -> tuple[Array, int]:
    """Return the least squares solution of least size in units of the columns, and its rank."""
    size = np.linalg.norm(table, axis=0)
    scale = np.where(size > 0, size, 1.0)
    solution, _, rank, _ = np.linalg.lstsq(table / scale, target, rcond=_RANK)
    return np.asarray(solution / scale), int(rank)
