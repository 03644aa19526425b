"""Changes of the model parameters from the first to the last work folder."""

from dataclasses import dataclass

import numpy as np

from frictioncli.model.document import PARAMETERS, FrictionModel


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterChange:
    """Change of one parameter of equation (16).

    Attributes
    ----------
    name, unit : str
        Name and unit of the parameter.
    first, last : float
        Estimates.
    change : float or None
        Last less first; None where one of the models lacks the parameter.
    ci95 : (float, float) or None
        95 % interval of the change, from the intervals of both models.
    """

    name: str
    unit: str
    first: float
    last: float
    change: float | None
    ci95: tuple[float, float] | None


def parameter_changes(first: FrictionModel, last: FrictionModel) -> tuple[ParameterChange, ...]:
    """Return the change of every parameter between two models fitted to different runs.

    Parameters
    ----------
    first, last : FrictionModel
        Models of the same joint.

    Returns
    -------
    tuple of ParameterChange
        One per parameter.
    """
    changes = []
    for name in PARAMETERS:
        one, two = first.parameters[name], last.parameters[name]
        change = interval = None
        if one.ci95 is not None and two.ci95 is not None:
            change = two.estimate - one.estimate
            # model.json cuts intervals off at zero: the upper half has the full width
            half_width = float(np.hypot(one.ci95[1] - one.estimate, two.ci95[1] - two.estimate))
            interval = (change - half_width, change + half_width)
        changes.append(
            ParameterChange(
                name=name,
                unit=two.unit,
                first=one.estimate,
                last=two.estimate,
                change=change,
                ci95=interval,
            )
        )
    return tuple(changes)
