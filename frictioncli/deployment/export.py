"""Export of one joint to a file format, with notes on what the format cannot hold."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from frictioncli.deployment.c_header import c_header
from frictioncli.deployment.deployed_model import DeployedModel, no_correction_reason
from frictioncli.deployment.document import deployed_document
from frictioncli.deployment.empirical_table import empirical_tables, tables_csv
from frictioncli.deployment.lookup_table import csv_text, lookup_table, tolerance_of
from frictioncli.deployment.operating_conditions import operating_conditions
from frictioncli.deployment.polynomial_damping import polynomial_friction
from frictioncli.deployment.settings import STATEFUL, ExportSettings
from frictioncli.deployment.simplified_friction import (
    SimplifiedFriction,
    simplified_friction,
    to_newton_metres,
)
from frictioncli.deployment.xml_forms import mjcf_text, urdf_text
from frictioncli.documents import to_json
from frictioncli.errors import OptionError
from frictioncli.model.friction import FORM

_ENDINGS = {"c": "h", "urdf": "urdf", "mjcf": "xml", "json": "json", "csv": "csv"}


@dataclass(frozen=True, slots=True)
class Exported:
    """Content of an exported file.

    Attributes
    ----------
    name : str
        File name.
    text : str
        Content.
    notes : tuple of str
        One sentence for each thing that the format cannot hold.
    """

    name: str
    text: str
    notes: tuple[str, ...]


def export(joint: DeployedModel, settings: ExportSettings) -> Exported:
    """Return a joint in the format of the settings.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    settings : ExportSettings
        Format and its options.

    Returns
    -------
    Exported
        File name, content and notes.

    Raises
    ------
    OptionError
        If the format cannot hold this joint's torque, or an option does not apply to it.
    """
    name = f"friction-joint{joint.model.joint}"
    writer = _WRITERS[settings.to]
    if settings.to == "csv" and settings.extended:
        name, writer = f"{name}-empirical", _empirical_as_csv
    text, notes = writer(joint, settings)
    name = f"{name}.{_ENDINGS[settings.to]}"
    return Exported(name, text, notes)


def _as_c(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    notes = _left_out(joint)
    text = c_header(joint, [*_origin(joint), FORM, *notes, *_accuracy(joint)])
    return text, notes or (
        "nothing is lost: friction, its inverse and the corrections by equations (17) to (20)",
    )


def _as_json(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    notes = _left_out(joint)
    return to_json(deployed_document(joint)), notes or ("nothing is lost",)


def _as_urdf(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    friction, notes = _simplified(joint, settings)
    remarks = (*_origin(joint), *notes)
    return urdf_text(friction, f"joint{joint.model.joint}", remarks), notes


def _as_mjcf(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    friction, notes = _simplified(joint, settings)
    polynomial = polynomial_friction(
        joint,
        operating_conditions(joint, settings),
        to_newton_metres(joint, settings.torque_constant),
    )
    notes += () if polynomial is None else (polynomial.describe(),)
    notes += ("no armature: logs at constant speed do not determine the rotor's inertia",)
    remarks = (*_origin(joint), *notes)
    return mjcf_text(friction, f"friction_joint{joint.model.joint}", remarks), notes


def _as_csv(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    conditions = operating_conditions(joint, settings)
    table = lookup_table(joint, conditions, settings.tolerance)
    unit = joint.model.torque_unit
    shape = " x ".join(str(len(axis)) for axis in table.axes)
    notes = (
        f"{shape} knots of speed, temperature and absolute load: linear interpolation misses"
        f" equation (16) by at most {table.error:.3g} {unit} ({table.tolerance:.3g} allowed)",
        "lost: everything outside these speeds, temperatures and loads",
        "lost: the correction of the temperature",
        *conditions.remarks,
    )
    columns = (
        "speed [deg/s]",
        "temperature [°C]",
        f"load [{joint.load_unit}]",
        f"friction [{unit}]",
    )
    return csv_text(table, columns, (*_origin(joint), *notes)), notes


def _empirical_as_csv(
    joint: DeployedModel, settings: ExportSettings
) -> tuple[str, tuple[str, ...]]:
    """Return the tables of the empirical term: what goes with the angle is in no other table."""
    extension = joint.extension
    if extension is None or extension.empirical is None:
        raise OptionError(
            "--extended --to csv: the extended model has no empirical term, and effects with a"
            f" memory have no place in a table; expected --to {' or '.join(STATEFUL)}"
        )
    unit, conditions = joint.model.torque_unit, operating_conditions(joint, settings)
    tolerance = tolerance_of(joint, conditions, settings.tolerance)
    tables = empirical_tables(extension, tolerance)
    notes = (
        "empirical torque, to be added to the extended model: the product of all validities times"
        f" the sum of the other parts of a torque, each interpolated linearly ({tolerance:.3g}"
        f" {unit} allowed)",
        "beyond the ends of a table its value at the end holds: validities are 0 there",
        "left out: the base model (--to csv) and the other effects of the extended model"
        f" (--to {' or '.join(STATEFUL)})",
    )
    return tables_csv(tables, unit, joint.load_unit, (*_origin(joint), *notes)), notes


_Writer = Callable[[DeployedModel, ExportSettings], tuple[str, tuple[str, ...]]]
_WRITERS: Mapping[str, _Writer] = {
    "c": _as_c,
    "urdf": _as_urdf,
    "mjcf": _as_mjcf,
    "json": _as_json,
    "csv": _as_csv,
}


def _simplified(
    joint: DeployedModel, settings: ExportSettings
) -> tuple[SimplifiedFriction, tuple[str, ...]]:
    """Return the friction that simulators know, with notes on what it cannot hold."""
    conditions = operating_conditions(joint, settings)
    friction = simplified_friction(joint, conditions, settings.torque_constant)
    notes = friction.describe(conditions.describe(joint.load_unit))
    return friction, (*notes, *conditions.remarks)


def _origin(joint: DeployedModel) -> list[str]:
    """Return lines on the origin of a file."""
    number, version = joint.model.joint, joint.version
    return [
        f"Friction of joint {number}, made by frictioncli {version} from",
        *(f"  {name}, SHA-256 {digest}" for name, digest in joint.origin.items()),
    ]


def _left_out(joint: DeployedModel) -> tuple[str, ...]:
    """Return notes on the parts of the model that a format with a state leaves out."""
    notes = []
    if not joint.can_correct:
        notes.append(
            f"left out: the temperature correction, as {no_correction_reason(joint.model)}"
        )
    if joint.extension:
        notes += [
            f"left out: effect {name}, which {reason}"
            for name, reason in joint.extension.left_out.items()
        ]
    return tuple(notes)


def _accuracy(joint: DeployedModel) -> list[str]:
    """Return the error of the base model and the notes of the model."""
    model, notes = joint.model, [f"note: {note}" for note in joint.model.notes]
    if joint.extension:
        return notes
    missed = f"{model.rmse:.3g} {model.torque_unit} RMS, without correction"
    return [f"misses the {model.n_pairs} pairs of its data by {missed}", *notes]
