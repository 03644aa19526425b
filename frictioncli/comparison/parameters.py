"""The parameters of the first work folder's model and of the last one's, side by side."""

from dataclasses import dataclass

import numpy as np

from frictioncli.model.document import PARAMETERS, FrictionModel


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterChange:
    """How far one parameter of equation (16) is from what it was.

    Attributes
    ----------
    name, unit : str, str
        Which one.
    first, last : float
        Its estimates.
    change : float or None
        Last less first; none where one of the models lacks the parameter.
    ci95 : (float, float) or None
        Its 95 % interval, by the noise that each model knows of.
    """

    name: str
    unit: str
    first: float
    last: float
    change: float | None
    ci95: tuple[float, float] | None


def parameter_changes(first: FrictionModel, last: FrictionModel) -> tuple[ParameterChange, ...]:
    """Return the difference of every parameter of two models fitted to different runs.

    Parameters
    ----------
    first, last : FrictionModel
        Of the same joint.
    """
    found = []
    for name in PARAMETERS:
        one, two = first.parameters[name], last.parameters[name]
        change = interval = None
        if one.ci95 is not None and two.ci95 is not None:
            change = two.estimate - one.estimate
            # model.json cuts intervals off at zero: the upper half tells their width
            reach = float(np.hypot(one.ci95[1] - one.estimate, two.ci95[1] - two.estimate))
            interval = (change - reach, change + reach)
        found.append(
            ParameterChange(
                name=name,
                unit=two.unit,
                first=one.estimate,
                last=two.estimate,
                change=change,
                ci95=interval,
            )
        )
    return tuple(found)
