"""What a regression found, as text and as facts of the table."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from frictioncli.regression.cells import TorqueCells
from frictioncli.regression.determination import JointRegression
from frictioncli.regression.equation import EquationTerms
from frictioncli.wording import count_text


def parameter_units(found: JointRegression, torque_unit: str, load_unit: str) -> dict[str, str]:
    """Return the unit of each parameter of a regression that has a meaning by itself.

    Parameters
    ----------
    found : JointRegression
        The regression.
    torque_unit, load_unit : str
        Units of torque and of a measured load.
    """
    load = load_unit if found.estimate.terms.load_channel else torque_unit
    viscous = f"{torque_unit}/(deg/s)^0.5"
    units = {
        "offset": torque_unit,
        "load": f"{torque_unit}/({load_unit})",
        "tau_c": torque_unit,
        "alpha": f"1/({load})" if load == torque_unit else f"{torque_unit}/({load})²",
        "beta": viscous,
        "gamma": viscous,
        "delta": "1/°C",
        "delay": "s",
        "inertia": "kg·m²" if torque_unit == "N·m" else f"{torque_unit}·s²/rad",
        "gravity": torque_unit,
        "base": "",
    }
    terms = found.estimate.terms
    free = set(terms.friction_names) - set(terms.friction)
    names = [name for name in found.estimate.names if name not in free]
    return {name: units[name if name in units else name.split("_")[0]] for name in names}


def regression_text(
    joint: int, found: JointRegression, cells: TorqueCells, torque_unit: str, load_unit: str
) -> str:
    """Return the text about the regression of a joint.

    Parameters
    ----------
    joint : int
        Its number.
    found : JointRegression
        The regression.
    cells : TorqueCells
        Its torques.
    torque_unit, load_unit : str
        Units of torque and load.
    """
    estimate = found.estimate
    rows = found.equations.rows
    convention = "load + friction" if found.sign > 0 else "load - friction"
    speed, count = np.abs(found.equations.velocity), int(rows.samples.sum())
    units = parameter_units(found, torque_unit, load_unit)
    pairs = int(cells.table.groupby("run", observed=True)["pair"].nunique().sum())
    ways = "both directions in each bin" if cells.both_ways else "one direction in some bins"
    lines = [
        f"joint {joint}: by regression of {count_text(count, 'sample')} in motion,"
        f" {speed.min():.3g} to {speed.max():.3g} deg/s; forward torque is {convention}"
        f" (sign {found.sign:+d}); {count_text(pairs, 'group')} of one speed, temperature and time,"
        f" {ways}"
    ]
    shown = [name for name in estimate.names if name not in estimate.terms.friction_names]
    if estimate.terms.base_parameters:
        lines.append(
            f"  dynamics of the whole arm: {estimate.terms.base_parameters} base parameters"
        )
    for name in [one for one in shown if one != "delta" and not one.startswith("base")]:
        low, high = estimate.interval(name)
        lines.append(
            f"  {name:12s} {estimate.parameters[name]:10.4g}  {f'{low:.4g} to {high:.4g}':>22s}"
            f"  {units[name]}"
        )
    lines += _state_lines(estimate.terms)
    at = "" if found.temperature is None else f" at {found.temperature:.0f} °C"
    friction = ", ".join(
        f"{value:.3g} ({low:.3g} to {high:.3g}) at {speed:.3g} deg/s"
        for speed, (value, low, high) in found.friction.items()
    )
    lines.append(f"  friction without load{at}: {friction} {torque_unit}")
    lines.append(
        f"  rmse {estimate.rmse:.3g}, of stretches left out {estimate.held_out:.3g} {torque_unit};"
        f" condition number {estimate.condition:.3g}"
    )
    lines += [f"  not determined: {name}: {why}" for name, why in found.undetermined.items()]
    lines += [f"  warning: {note}" for note in found.prepared.notes]
    return "\n".join(lines)


def _state_lines(terms: EquationTerms) -> list[str]:
    """Return a line for each state of the load that has an inertia and a gravity of its own."""
    lines = []
    for number, (payload, pose) in enumerate(zip(terms.payloads, terms.poses, strict=True)):
        told = [
            *([] if np.isnan(payload) else [f"{payload:g} kg"]),
            *([] if np.isnan(pose) else [f"pose {pose:.0f} of the other joints"]),
        ]
        if len(terms.payloads) > 1:
            suffix = f"_{number + 1}" if number else ""
            of = ", ".join(told) or "unknown payload and pose"
            lines.append(f"  inertia{suffix}, gravity{suffix}: with {of}")
    return lines


def regression_facts(
    found: JointRegression, cells: TorqueCells, torque_unit: str, load_unit: str
) -> Mapping[str, Any]:
    """Return what a regression found, for the metadata of the table.

    Parameters
    ----------
    found : JointRegression
        The regression.
    cells : TorqueCells
        Its torques.
    torque_unit, load_unit : str
        Units of torque and load.
    """
    estimate = found.estimate
    units = parameter_units(found, torque_unit, load_unit)
    return {
        "parameters": {
            name: {
                "estimate": estimate.parameters[name],
                "ci95": list(estimate.interval(name)),
                "unit": units[name],
            }
            for name in units
        },
        "undetermined": dict(found.undetermined),
        "friction": [
            {"speed": speed, "estimate": value, "ci95": [low, high]}
            for speed, (value, low, high) in found.friction.items()
        ],
        "friction_temperature": found.temperature,
        "rmse": estimate.rmse,
        "held_out": estimate.held_out,
        "condition": estimate.condition,
        "both_directions": cells.both_ways,
        "acceleration_from": "position" if found.equations.speed_from_position else "velocity",
        "noise_order": estimate.noise_order,
        "blocks": estimate.blocks,
    }
