"""Coefficients of the gravity torque as documents state them, and read back."""

import msgspec
import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.gravity import NAMES, PER_MASS, GravityForm, form_of
from frictioncli.errors import TableError


class PoseGravity(msgspec.Struct, frozen=True, kw_only=True):
    """What is added to the coefficients of gravity in some poses of the other joints.

    Attributes
    ----------
    poses : tuple of int
        The poses, by their numbers.
    cosine, sine : float
        Added to the coefficients of cosine and sine. [N·m]
    """

    poses: tuple[int, ...]
    cosine: float
    sine: float


class GravityCoefficients(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Coefficients of the gravity torque, as ``extended-model.json`` states them.

    Attributes
    ----------
    cosine, sine : float
        Coefficients of the cosine and the sine of the joint angle. [N·m]
    offset : float
        Constant. [N·m]
    cosine_per_kg, sine_per_kg : float or None
        Coefficients of the cosine and the sine times the payload; none where no two payloads are
        known. [N·m/kg]
    in_poses : tuple of PoseGravity
        What is added in other poses of the other joints; absent where gravity is the same in all.
    """

    cosine: float
    sine: float
    offset: float
    cosine_per_kg: float | None = None
    sine_per_kg: float | None = None
    in_poses: tuple[PoseGravity, ...] = ()

    def __post_init__(self) -> None:
        if (self.cosine_per_kg is None) != (self.sine_per_kg is None):
            raise ValueError("expected both cosine_per_kg and sine_per_kg, or none")

    @property
    def form(self) -> GravityForm:
        """What the gravity depends on."""
        return GravityForm(
            self.cosine_per_kg is not None, tuple(one.poses for one in self.in_poses)
        )


def gravity_document(gravity: Array, form: GravityForm | None = None) -> GravityCoefficients:
    """Return the coefficients of gravity by name, as documents state them.

    Parameters
    ----------
    gravity : ndarray, shape (coefficients,)
        Coefficients. [N·m], [N·m/kg]
    form : GravityForm, optional
        What they belong to; by default gravity in one pose.
    """
    form = form or form_of(gravity)
    first = (*NAMES, *PER_MASS)[: form.first_coefficients]
    rest = gravity[len(first) :].reshape(-1, 2).tolist()
    return GravityCoefficients(
        **dict(zip(first, map(float, gravity), strict=False)),
        in_poses=tuple(
            PoseGravity(poses=poses, cosine=cosine, sine=sine)
            for poses, (cosine, sine) in zip(form.poses, rest, strict=True)
        ),
    )


def stated_gravity(stated: GravityCoefficients, form: GravityForm | None = None) -> Array:
    """Return the coefficients that a document states, shape (coefficients,).

    Parameters
    ----------
    stated : GravityCoefficients
        The coefficients.
    form : GravityForm, optional
        The form to return them for; those that the document does not have are zero. By default the
        document's.

    Raises
    ------
    TableError
        If the document states coefficients that the form does not have.
    """
    form = form or stated.form
    found = [stated.cosine, stated.sine, stated.offset]
    per_mass = [stated.cosine_per_kg or 0.0, stated.sine_per_kg or 0.0]
    in_poses = {one.poses: (one.cosine, one.sine) for one in stated.in_poses}
    if stated.form.payloads > form.payloads:
        raise TableError(
            "the extended model's gravity goes with the payload, and these torques have no two"
            " payloads; run 'frictioncli diagnose' again"
        )
    if in_poses.keys() - set(form.poses):
        raise TableError(
            "the extended model's gravity is of other poses of the other joints than these torques"
            " have; run 'frictioncli diagnose' again"
        )
    if form.payloads:
        found += per_mass
    for poses in form.poses:
        found += in_poses.get(poses, (0.0, 0.0))
    return np.array(found)
