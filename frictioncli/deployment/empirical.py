r"""The empirical term of an extended model outside the program: in Python and in C.

It adds to the friction and to the load, at an angle, a load, a speed and the temperature at which
the extended model evaluates friction. What it changes of the base is linear,

.. math::

    \Delta\tau_c + \Delta\alpha L^2 + \left(\Delta\beta
    + e^{-\delta T} (\Delta\gamma - \gamma T \Delta\delta) \right) \sqrt{v}
    + 2 \alpha L \, \Delta L_g(q) ,

with the gravity :math:`\Delta L_g` in the usual pose without a payload.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from frictioncli.arrays import Array
from frictioncli.diagnosis.empirical.form_columns import LATE_BUMPS
from frictioncli.diagnosis.empirical.term import (
    FADING,
    EmpiricalTerm,
    FormFunction,
    SmoothFunction,
    in_coordinates,
    validity,
)
from frictioncli.effects.base import Basis, EffectTable
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import FrictionParameters

TableOf = Callable[[FrictionParameters, Array, Array, Array, Array], EffectTable]


def empirical_torque(
    term: EmpiricalTerm,
    about: FrictionParameters,
    table_of: TableOf,
    *,
    position: ArrayLike,
    load: ArrayLike,
    speed: ArrayLike,
    temperature: ArrayLike,
) -> Basis:
    """Return the friction and the load torque that the term adds.

    Parameters
    ----------
    term : EmpiricalTerm
        The term.
    about : FrictionParameters
        Parameters of the base that it is linear about.
    table_of : callable
        Returns instants without history from parameters, load, speed, temperature and position.
    position : array_like, shape (rows,)
        Joint angle. [deg]
    load : array_like, shape (rows,)
        Load torque. [N·m]
    speed : array_like, shape (rows,)
        Absolute velocity. [deg/s]
    temperature : array_like, shape (rows,)
        Temperature at which friction is evaluated. [°C]

    Returns
    -------
    Basis
        Friction and load torque, shape (rows,) each. [torque unit]
    """
    inputs = (load, speed, temperature, position)
    load, speed, temperature, position = (
        np.atleast_1d(np.asarray(one, float)) for one in np.broadcast_arrays(*inputs)
    )
    table = table_of(about, load, speed, temperature, position)
    angle, gravity = np.radians(position), term.gravity_changes
    moved = gravity.cosine * np.cos(angle) + gravity.sine * np.sin(angle) + gravity.offset
    change = {name: term.base_changes.get(name, 0.0) for name in PARAMETERS}
    decay = np.exp(-about.delta * temperature)
    falling = change["gamma"] - about.gamma * temperature * change["delta"]
    friction = (
        change["tau_c"]
        + change["alpha"] * np.square(load)
        + (change["beta"] + decay * falling) * np.sqrt(speed)
        + 2 * about.alpha * load * moved
    )
    added, valid = term.functions_at(table), validity(table, term.ranges)
    return Basis(valid * (added.friction + friction), valid * (added.load + moved))


def c_functions(term: EmpiricalTerm) -> str:
    """Return the term as C functions, with placeholders for the prefix of names.

    Parameters
    ----------
    term : EmpiricalTerm
        The term.
    """
    return "\n".join(
        [
            "",
            "/* 1 where the empirical term was measured, falling to 0 beyond. */",
            "static inline double ${prefix}_empirical_validity(",
            "    double position, double load, double speed, double temperature)",
            "{",
            "    double share = 1.0, away;",
            *_validity_lines(term),
            "    return share;",
            "}",
            *_function_lines(term, "friction"),
            *_function_lines(term, "load"),
            "",
        ]
    )


def _validity_lines(term: EmpiricalTerm) -> list[str]:
    lines = []
    for axis, (low, high) in in_coordinates(term.ranges).items():
        value = {"load": "fabs(load)", "speed": "log(speed > 1e-9 ? speed : 1e-9)"}.get(axis, axis)
        reach = FADING * (high - low) or FADING * max(abs(high), 1.0)
        lines += [
            f"    away = {value};",
            f"    away = away < ({low!r}) ? ({low!r}) - away : away - ({high!r});",
            f"    away = away < 0.0 ? 0.0 : away > {reach!r} ? 1.0 : away / {reach!r};",
            "    share *= 1.0 - away * away * (3.0 - 2.0 * away);",
        ]
    return lines


_HEADS = {
    "friction": """
/* Friction torque [$unit] that has been measured and has no known cause: empirical, nothing
 * outside the ranges that were measured. At a joint angle [deg], a load [$load_unit], a speed
 * [deg/s] and the temperature of the gear [degC]. Add it to the friction predicted; subtract it
 * from a measured pair before ${prefix}_correct. */
static inline double ${prefix}_empirical_friction(""",
    "load": """
/* The same in the load torque [$unit]. */
static inline double ${prefix}_empirical_load(""",
}


def _function_lines(term: EmpiricalTerm, channel: str) -> list[str]:
    """Return the function of one channel."""
    gravity, change = term.gravity_changes, term.base_changes
    get = {name: f"({change.get(name, 0.0)!r})" for name in PARAMETERS}
    lines = [
        *_HEADS[channel].splitlines(),
        "    double position, double load, double speed, double temperature)",
        "{",
        f"    double angle = position * {np.pi / 180!r};",
        f"    double moved = ({gravity.cosine!r}) * cos(angle) + ({gravity.sine!r}) * sin(angle)"
        f" + ({gravity.offset!r});",
    ]
    if channel == "friction":
        lines += [
            "    double decay = exp(-${PREFIX}_DELTA * temperature);",
            f"    double torque = {get['tau_c']} + {get['alpha']} * (load * load)",
            f"                    + ({get['beta']} + decay * ({get['gamma']}",
            f"                       - ${{PREFIX}}_GAMMA * temperature * {get['delta']}))"
            " * sqrt(speed)",
            "                    + 2.0 * ${PREFIX}_ALPHA * load * moved;",
        ]
    else:
        lines += ["    double torque = moved;"]
    for form in term.forms:
        lines += _form_lines(form, channel)
    for one in term.functions:
        if one.channel == channel:
            lines += _series_lines(one, term)
    return [
        *lines,
        "    return torque * ${prefix}_empirical_validity(position, load, speed, temperature);",
        "}",
    ]


def _series_lines(one: SmoothFunction, term: EmpiricalTerm) -> list[str]:
    """Return the lines that add a series of cosines."""
    within = in_coordinates(term.ranges)
    lines = ["    {"]
    values = ", ".join(repr(value) for value in one.coefficients)
    lines.append(f"        static const double c[{len(one.coefficients)}] = {{{values}}};")
    lines.append("        int i, k = 0;")
    for number, axis in enumerate(one.axes):
        low, high = within[axis]
        value = "log(speed > 1e-9 ? speed : 1e-9)" if axis == "speed" else axis
        lines.append(f"        double u{number} = ({value} - ({low!r})) / {high - low!r};")
    lines += ["        int j;"] if len(one.axes) == 2 else []
    for number in range(len(one.axes)):
        name = f"u{number}"
        lines.append(
            f"        {name} = {np.pi!r} * ({name} < 0.0 ? 0.0 : {name} > 1.0 ? 1.0 : {name});"
        )
    lines.append(f"        for (i = 1; i <= {one.orders[0]}; i++)")
    if len(one.axes) == 2:
        lines += [
            f"            for (j = 1; j <= {one.orders[1]}; j++)",
            "                torque += c[k++] * cos(i * u0) * cos(j * u1);",
        ]
    else:
        lines.append("            torque += c[k++] * cos(i * u0);")
    return [*lines, "    }"]


def _form_lines(form: FormFunction, channel: str) -> list[str]:
    """Return the lines that add a form in one channel."""
    if form.kind in LATE_BUMPS:
        c, w, lag = (repr(form.shape[name]) for name in ("centre", "width", "lag"))
        ahead, behind = (
            f"exp(-0.5 * pow((position {way} speed * {lag} - ({c})) / {w}, 2.0))" for way in "-+"
        )
        heights = list(form.coefficients.values())
        forward, reverse = heights[0] / 2, heights[-1] / 2
        if form.channel == "load":
            # the same torque in both directions is friction with opposite signs
            forward, reverse = form.sign * forward, -form.sign * reverse
        if channel == "load":
            forward, reverse = form.sign * forward, -form.sign * reverse
        return [
            f"    torque += ({forward!r}) * {ahead}",
            f"            + ({reverse!r}) * {behind};",
        ]
    if form.channel != channel:
        return []
    return [
        f"    torque += ({value!r}) * ({column});"
        for value, column in zip(
            form.coefficients.values(), _C_COLUMNS[form.kind](form), strict=True
        )
    ]


def _c_amount(axis: str) -> str:
    return "fabs(load)" if axis == "load" else axis


def _c_peak(form: FormFunction) -> list[str]:
    return [f"exp(-0.5 * pow({_c_away(form)}, 2.0))"]


def _c_away(form: FormFunction) -> str:
    """Return the distance from a centre in widths, of the speed in its logarithm."""
    (axis,), shape = form.axes, form.shape
    away = f"{_c_amount(axis)} - ({shape['centre']!r})"
    if axis == "speed":
        away = f"log((speed > 1e-9 ? speed : 1e-9) / {shape['centre']!r})"
    return f"({away}) / {shape['width']!r}"


def _c_bend(form: FormFunction) -> list[str]:
    value, start = _c_amount(form.axes[0]), f"({form.shape['start']!r})"
    away = f"{value} - {start}" if form.kind == "bend_above" else f"{start} - {value}"
    return [f"fmax({away}, 0.0) / 10.0"]


def _c_step(form: FormFunction) -> list[str]:
    return [f"0.5 * erfc(-({_c_away(form)}) * {float(np.sqrt(0.5))!r})"]


def _c_lifting(form: FormFunction) -> list[str]:
    return [f"copysign(pow(fabs(load / 50.0), {form.shape['exponent']!r}), load)"]


def _c_moving_peak(form: FormFunction) -> list[str]:
    shape = form.shape
    moved = f"log((speed > 1e-9 ? speed : 1e-9) / {shape['centre']!r})"
    moved += f" - ({shape['shift']!r}) * (temperature - 40.0)"
    return [f"exp(-0.5 * pow(({moved}) / {shape['width']!r}, 2.0))"]


def _c_waves(form: FormFunction) -> list[str]:
    order = repr(form.shape["order"])
    return [f"{wave}({order} * angle)" for wave in ("cos", "sin")]


def _c_warm_wave(form: FormFunction) -> list[str]:
    waves = _c_waves(form)
    return [*waves, *(f"{wave} * (temperature - 40.0) / 10.0" for wave in waves)]


def _c_turning_wave(form: FormFunction) -> list[str]:
    ratio = f"pow((speed > 1e-9 ? speed : 1e-9) / {form.shape['turn']!r}, 2.0)"
    return [f"{wave} * ({ratio} - 1.0) / ({ratio} + 1.0)" for wave in _c_waves(form)]


_C_COLUMNS: Mapping[str, Callable[[FormFunction], list[str]]] = {
    "peak": _c_peak,
    "bend_above": _c_bend,
    "bend_below": _c_bend,
    "step": _c_step,
    "lifting": _c_lifting,
    "moving_peak": _c_moving_peak,
    "warm_wave": _c_warm_wave,
    "turning_wave": _c_turning_wave,
}
"""Columns of forms in C; a test compares each with Python."""
