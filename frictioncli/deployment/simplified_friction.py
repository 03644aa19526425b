"""The friction that robot simulators know: a dry part and one that grows with speed."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from frictioncli.arrays import Array
from frictioncli.deployment.deployed_model import DeployedModel
from frictioncli.deployment.operating_conditions import Conditions
from frictioncli.errors import OptionError

_POINTS = 400


@dataclass(frozen=True, slots=True, kw_only=True)
class SimpleForm:
    """Best fit of ``dry + damping * speed`` to (16), and what it misses.

    Attributes
    ----------
    dry : float
        Friction that does not depend on speed. [N·m]
    damping : float
        Friction per speed. [N·m·s/rad]
    rms, worst : float
        Root mean square and greatest miss where it was fitted. [N·m]
    worst_speed : float
        Where the greatest is. [deg/s]
    worst_anywhere : float
        Greatest miss over all loads and temperatures of the data. [N·m]
    """

    dry: float
    damping: float
    rms: float
    worst: float
    worst_speed: float
    worst_anywhere: float

    def torque(self, speed: Array) -> Array:
        """Return the friction torque at speeds in deg/s. [N·m]."""
        return self.dry + self.damping * np.radians(speed)

    def told(self, at: str) -> list[str]:
        """Return the fit and its loss, a line each; ``at`` says where it was fitted."""
        return [
            f"dry friction {self.dry:.6g} N·m, damping {self.damping:.6g} N·m·s/rad: least squares"
            f" to the measured friction law, {at}",
            f"lost there: {self.rms:.3g} N·m RMS, at most {self.worst:.3g} N·m at"
            f" {self.worst_speed:.3g} deg/s",
            f"lost at other loads and temperatures of the data: up to {self.worst_anywhere:.3g}"
            " N·m, as this form knows neither",
        ]


def simple_form(
    joint: DeployedModel, where: Conditions, torque_constant: float | None
) -> SimpleForm:
    """Return the best fit of the form that simulators know, with neither part negative.

    Parameters
    ----------
    joint : DeployedModel
        The joint.
    where : Conditions
        Where to fit.
    torque_constant : float or None
        Torque at the joint per unit of the log's torque. [N·m/A]

    Raises
    ------
    OptionError
        If the log's torque is no torque at the joint and there is no constant.
    """
    factor = _to_newton_metres(joint, torque_constant)
    speed = np.linspace(*where.speeds, _POINTS)

    def wanted(load: float, temperature: float) -> Array:
        return factor * joint.friction(load=load, speed=speed, temperature=temperature)

    columns = np.column_stack([np.ones_like(speed), np.radians(speed)])
    (dry, damping), _ = nnls(columns, wanted(where.load, where.temperature))
    fitted = columns @ [dry, damping]
    missed = np.abs(fitted - wanted(where.load, where.temperature))
    # (16) is monotonous in temperature and in the load's amount: the ends are the extremes
    loads = (0.0 if where.loads[0] < 0 < where.loads[1] else min(map(abs, where.loads)),)
    corners = [
        (load, temperature)
        for load in (*loads, max(map(abs, where.loads)))
        for temperature in where.temperatures
    ]
    return SimpleForm(
        dry=float(dry),
        damping=float(damping),
        rms=float(np.sqrt(np.mean(np.square(missed)))),
        worst=float(np.max(missed)),
        worst_speed=float(speed[np.argmax(missed)]),
        worst_anywhere=max(
            float(np.max(missed)), *(float(np.max(np.abs(fitted - wanted(*at)))) for at in corners)
        ),
    )


def _to_newton_metres(joint: DeployedModel, torque_constant: float | None) -> float:
    model = joint.model
    found = f"{model.torque_unit} at the {model.torque_side}"
    if found == "N·m at the joint":
        if torque_constant is not None:
            raise OptionError(
                f"--torque-constant {torque_constant:g}: joint {model.joint}'s torque is in {found}"
                " already; leave it out"
            )
        return 1.0
    if torque_constant is None:
        raise OptionError(
            f"joint {model.joint}: the log's torque is in {found}, and a simulator needs N·m at the"
            f" joint; give --torque-constant, the N·m at the joint per {model.torque_unit} of the"
            " log (motor's torque constant times gear ratio)"
        )
    return torque_constant
