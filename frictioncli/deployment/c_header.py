"""C99 header with friction, its inverse and Algorithm 3."""

from collections.abc import Callable, Mapping, Sequence
from string import Template
from textwrap import fill

from frictioncli.deployment import c_template as c
from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.empirical import c_functions
from frictioncli.deployment.extension import DeployedExtension
from frictioncli.deployment.gear_temperature import GearLag
from frictioncli.diagnosis.documents.extended_model import FittedEffect
from frictioncli.model.document import PARAMETERS

_BASE_TEMPERATURE = {
    "motor": "joint->motor_temperature",
    "housing": "joint->housing_temperature",
    "mean": "0.5 * (joint->motor_temperature + joint->housing_temperature)",
}
"""Uncorrected temperature of the base model, in C."""


def c_header(joint: DeployedModel, remarks: Sequence[str]) -> str:
    """Return the header of one joint.

    Parameters
    ----------
    joint : DeployedModel
        The joint; without a dependence on temperature it has no inverse and no corrector.
    remarks : sequence of str
        Lines of the comment at the top.

    Returns
    -------
    str
        Text of the header, in ASCII.
    """
    prefix = prefix_of(joint)
    extension = joint.extension if joint.can_correct else None
    parts = [c.HEAD]
    if joint.can_correct:
        parts += [c.INVERSE, *([c.LAGGING] if extension else []), c.UPDATE]
    if extension:
        parts += [c.GEAR, c.BEYOND]
    if joint.can_correct:
        parts.append(c.CORRECT)
    if extension and extension.empirical is not None:
        parts.append(c_functions(extension.empirical))
    values = _placeholder_values(joint, extension)
    names = {"prefix": prefix, "PREFIX": prefix.upper(), **_units(joint)}
    # the values may themselves contain names of the joint
    values = {name: Template(text).substitute(names) for name, text in values.items()} | names
    values["remarks"] = "\n".join(
        fill(line, width=98, initial_indent=" * ", subsequent_indent=" *   ") for line in remarks
    ).replace("*/", "* /")
    header = "".join(Template(part).substitute(values) for part in (*parts, c.TAIL))
    return ascii_text(header)


def prefix_of(joint: DeployedModel) -> str:
    """Return the prefix of all names in the header of a joint."""
    return f"friction_joint{joint.model.joint}"


def ascii_text(text: str) -> str:
    """Return text in ASCII, for any compiler."""
    replacements = {"·": ".", "°": "deg", "²": "^2", "–": "-", "−": "-"}
    for sign, plain in replacements.items():
        text = text.replace(sign, plain)
    return text.encode("ascii", "replace").decode("ascii")


def _units(joint: DeployedModel) -> dict[str, str]:
    parameters = joint.model.parameters
    return {
        "unit": joint.model.torque_unit,
        "load_unit": joint.load_unit,
        "alpha_unit": parameters["alpha"].unit,
        "viscous_unit": parameters["beta"].unit,
    }


def _placeholder_values(
    joint: DeployedModel, extension: DeployedExtension | None
) -> dict[str, str]:
    """Return the values of the placeholders in the template."""
    gear = extension is not None
    return {
        "constants": "\n".join(_constants(joint, extension)),
        "in_range": _in_range(joint),
        "fields": (c.CORRECTION_FIELDS if joint.can_correct else "")
        + (c.GEAR_FIELDS if gear else ""),
        "initial_values": (c.CORRECTION_INITIAL_VALUES if joint.can_correct else "")
        + (c.GEAR_INITIAL_VALUES if gear else ""),
        "arguments": c.GEAR_ARGUMENTS if gear else "",
        "more": c.GEAR_COMMENT if gear else "",
        "gear_step": c.GEAR_STEP if gear else "",
        "base_temperature": _BASE_TEMPERATURE[joint.model.temperature],
        "excess": "${prefix}_gear_excess(joint)",
        "terms": "".join(_term(term) for term in extension.terms) if extension else "",
        "minus_extension": " - ${prefix}_beyond(joint, load, speed)" if gear else "",
        "plus_extension": "\n           + ${prefix}_beyond(joint, load, speed)" if gear else "",
    }


def _constants(joint: DeployedModel, extension: DeployedExtension | None) -> list[str]:
    """Return the definitions of all constants."""
    lines = []

    def define(name: str, value: float | str, remark: str) -> None:
        lines.append(f"#define ${{PREFIX}}_{name} {value} /* {remark} */")

    for name in PARAMETERS:
        entry = joint.model.parameters[name]
        interval = entry.ci95 and f"95 %: {entry.ci95[0]:.4g} to {entry.ci95[1]:.4g}"
        remark = interval or f"not determined: {entry.reason}"
        if extension:
            remark = "base of the extended model"
        define(name.upper(), repr(getattr(joint.base, name)), f"[{entry.unit}] {remark}")
    for name, unit in (("speed", "deg/s"), ("load", joint.load_unit), ("temperature", "°C")):
        limits = getattr(joint.model.range, name)
        if limits is not None:
            define(f"LOWEST_{name.upper()}", repr(limits[0]), f"of the data [{unit}]")
            define(f"HIGHEST_{name.upper()}", repr(limits[1]), f"of the data [{unit}]")
    if joint.can_correct:
        rule = joint.schedule
        define("CORRECTION_SPEED", repr(joint.correction_speed), "at which to correct [deg/s]")
        define("K", repr(float(rule.k)), "scale of criterion (20) [1]")
        define("TMAX", repr(float(rule.tmax)), "time that forces a correction [s]")
        define(
            "LATEST_DEGREE",
            str(int(rule.criterion == "latest_degree")),
            f"reading of (20): {rule.criterion}",
        )
    if extension:
        for name in PARAMETERS:
            change = getattr(extension.parameters, name) - getattr(extension.about, name)
            define(f"{name.upper()}_CHANGE", f"({change!r})", "refitted with the effects")
        lines += _gear_constants(extension.gear)
    return lines


def _gear_constants(gear: GearLag | None) -> list[str]:
    lag = gear or _NO_LAG
    ends = lag.time_constant_ci95 or (lag.time_constant, lag.time_constant)
    times = ", ".join(repr(value) for value in (lag.time_constant, *ends))
    lines = [f"#define ${{PREFIX}}_TIME_CONSTANTS {{{times}}} /* [s], 95 % */"]
    for name, remark in (
        ("lag_share", "share at a gear that follows the motor [1]"),
        ("friction_heating", "at the reference power [°C]"),
        ("housing_share", "share at the housing [1]"),
        ("housing_lag_share", "share at a gear that follows the housing [1]"),
        ("reference_power", "torque times speed [$unit.deg/s]"),
        ("start_sd", "when the past is unknown [°C]"),
    ):
        lines.append(f"#define ${{PREFIX}}_{name.upper()} ({getattr(lag, name)!r}) /* {remark} */")
    slow = lag.housing_time_constant or 0.0
    lines.append(
        f"#define ${{PREFIX}}_HOUSING_TIME_CONSTANT {slow!r} /* [s], 0 where it is measured */"
    )
    return lines


def _in_range(joint: DeployedModel) -> str:
    tests = []
    for name in ("load", "speed", "temperature"):
        if getattr(joint.model.range, name) is None:
            tests.append(f"({name} == {name})")
            continue
        for bound, sign in (("LOWEST", ">="), ("HIGHEST", "<=")):
            tests.append(f"{name} {sign} ${{PREFIX}}_{bound}_{name.upper()}")
    return "\n           && ".join(tests)


_NO_LAG = GearLag(
    time_constant=1.0,
    time_constant_ci95=None,
    lag_share=0.0,
    friction_heating=0.0,
    housing_share=0.0,
    housing_lag_share=0.0,
    housing_time_constant=None,
    reference_power=1.0,
    start_sd=0.0,
)
"""Gear that is as warm as the motor."""


def _term(term: FittedEffect) -> str:
    (coefficient,) = (float(value) for value in term.coefficients)
    expression = _TERMS[term.effect.name](term.shape)
    return f"    torque += {coefficient!r} * ({expression}); /* {term.effect.name} */\n"


def _load_temperature(shape: Mapping[str, float]) -> str:
    bend, warm = shape["bend"], "(temperature - 25.0)"
    if abs(bend) < 1e-9:
        return f"(load / 10.0) * (load / 10.0) * {warm} / 10.0"
    return f"(load / 10.0) * (load / 10.0) * -expm1(-({bend!r}) * {warm}) / (10.0 * ({bend!r}))"


def _stribeck(shape: Mapping[str, float]) -> str:
    fall = f"({shape['velocity']!r} * exp(({shape['shift']!r}) * (temperature - 40.0)))"
    return f"exp(-pow(speed / {fall}, {shape['exponent']!r}))"


_TERMS: dict[str, Callable[[Mapping[str, float]], str]] = {
    "stribeck": _stribeck,
    "linear_viscous": lambda shape: "speed",
    "quadratic_drag": lambda shape: "(speed / 100.0) * (speed / 100.0)",
    "coulomb_temperature": lambda shape: "(temperature - 25.0) / 10.0",
    "load_linear": lambda shape: "fabs(load)",
    "load_velocity": lambda shape: "(load / 10.0) * (load / 10.0) * sqrt(speed / 100.0)",
    "load_temperature": _load_temperature,
}
"""Effects without memory in C; a test compares each with the catalogue."""
