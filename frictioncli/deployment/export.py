"""One joint written in the form that a target wants, with what that form loses."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from frictioncli.deployment.c_header import c_header
from frictioncli.deployment.deployed_model import DeployedModel, why_no_correction
from frictioncli.deployment.document import deployed_document
from frictioncli.deployment.lookup_table import csv_text, lookup
from frictioncli.deployment.operating_conditions import conditions
from frictioncli.deployment.settings import ExportSettings
from frictioncli.deployment.simplified_friction import SimpleForm, simple_form
from frictioncli.deployment.xml_forms import mjcf, urdf
from frictioncli.documents import to_json
from frictioncli.model.friction import FORM

_ENDINGS = {"c": "h", "urdf": "urdf", "mjcf": "xml", "json": "json", "csv": "csv"}


@dataclass(frozen=True, slots=True)
class Exported:
    """A file to write, and what to say of it.

    Attributes
    ----------
    name : str
        File name.
    text : str
        Contents.
    said : tuple of str
        What was lost, a sentence each.
    """

    name: str
    text: str
    said: tuple[str, ...]


def export(joint: DeployedModel, settings: ExportSettings) -> Exported:
    """Return a joint in the form that the settings ask for.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    settings : ExportSettings
        Target and its options.

    Raises
    ------
    OptionError
        If the target cannot hold this joint's torque, or an option makes no sense for it.
    """
    name = f"friction-joint{joint.model.joint}.{_ENDINGS[settings.to]}"
    text, said = _WRITERS[settings.to](joint, settings)
    return Exported(name, text, said)


def _as_c(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    said = _without_state(joint)
    text = c_header(joint, [*_origin(joint), FORM, *said, *_uncertain(joint)])
    return text, said or ("nothing is lost: friction, its inverse and the correction of (17)-(20)",)


def _as_json(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    said = _without_state(joint)
    return to_json(deployed_document(joint)), said or ("nothing is lost",)


def _as_urdf(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    form, said = _simple(joint, settings)
    return urdf(form, f"joint{joint.model.joint}", (*_origin(joint), *said)), said


def _as_mjcf(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    form, said = _simple(joint, settings)
    said += ("no armature: logs of constant speed do not tell the rotor's inertia",)
    return mjcf(form, f"friction_joint{joint.model.joint}", (*_origin(joint), *said)), said


def _as_csv(joint: DeployedModel, settings: ExportSettings) -> tuple[str, tuple[str, ...]]:
    where = conditions(joint, settings)
    table = lookup(joint, where, settings.tolerance)
    unit = joint.model.torque_unit
    shape = " x ".join(str(len(axis)) for axis in table.axes)
    said = (
        f"{shape} knots of speed, temperature and load's amount: linear interpolation misses"
        f" equation (16) by at most {table.error:.3g} {unit} ({table.tolerance:.3g} allowed)",
        "lost: everything outside these speeds, temperatures and loads",
        "lost: the correction of the temperature",
        *where.remarks,
    )
    columns = (
        "speed [deg/s]",
        "temperature [°C]",
        f"load [{joint.load_unit}]",
        f"friction [{unit}]",
    )
    return csv_text(table, columns, (*_origin(joint), *said)), said


_Writer = Callable[[DeployedModel, ExportSettings], tuple[str, tuple[str, ...]]]
_WRITERS: Mapping[str, _Writer] = {
    "c": _as_c,
    "urdf": _as_urdf,
    "mjcf": _as_mjcf,
    "json": _as_json,
    "csv": _as_csv,
}


def _simple(joint: DeployedModel, settings: ExportSettings) -> tuple[SimpleForm, tuple[str, ...]]:
    where = conditions(joint, settings)
    form = simple_form(joint, where, settings.torque_constant)
    return form, (*form.told(where.told(joint.load_unit)), *where.remarks)


def _origin(joint: DeployedModel) -> list[str]:
    """Return where a file comes from, a line each."""
    number, version = joint.model.joint, joint.version
    return [
        f"Friction of joint {number}, made by frictioncli {version} from",
        *(f"  {name}, SHA-256 {digest}" for name, digest in joint.origin.items()),
    ]


def _without_state(joint: DeployedModel) -> tuple[str, ...]:
    """Return what of the model does not go along with a target that can hold a state."""
    said = []
    if not joint.can_correct:
        said.append(f"left out: temperature's correction, as {why_no_correction(joint.model)}")
    if joint.extension:
        said += [
            f"left out: effect {name}, which {why}"
            for name, why in joint.extension.left_out.items()
        ]
    return tuple(said)


def _uncertain(joint: DeployedModel) -> list[str]:
    """Return the notes that the model carries, and the base model's error."""
    model, notes = joint.model, [f"note: {note}" for note in joint.model.notes]
    if joint.extension:
        return notes
    missed = f"{model.rmse:.3g} {model.torque_unit} RMS, without correction"
    return [f"misses the {model.n_pairs} pairs of its data by {missed}", *notes]
