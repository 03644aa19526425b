r"""Where structure without a name shows: the parts of an empirical term with their sizes.

The term is a sum of functions of one quantity or two in either channel. The size of each is the RMS
of what the base leaves of it, of a form together with the random function of the same quantities,
which holds what the form does not: of a load that of the angle. The interval comes from estimates
from each part of the pairs alone,

.. math:: s \left( 1 \pm t_{0.975} \, \sigma_r / \sqrt{n} \right) ,

with the scatter of the ratio *r* of the torque from a part to that from all pairs, along it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.empirical.normal_equations import NormalEquations
from frictioncli.diagnosis.empirical.random_functions import Function
from frictioncli.diagnosis.empirical.term import FormFunction
from frictioncli.distributions import t_quantile


@dataclass(frozen=True, slots=True, kw_only=True)
class Located:
    """A part of an empirical term.

    Attributes
    ----------
    axes : tuple of str
        What it depends on.
    channel : {"friction", "load"}
        The torque in which it shows.
    form : FormFunction or None
        The form that describes it.
    size : float
        RMS of what the base leaves of it. [N·m]
    interval : (float, float)
        95 % interval of that. [N·m]
    share : float
        Its square relative to that of all parts together.
    """

    axes: tuple[str, ...]
    channel: str
    form: FormFunction | None
    size: float
    interval: tuple[float, float]
    share: float


def sizes_of_parts(
    functions: Sequence[Function], equations: NormalEquations, *, together: bool = False
) -> list[tuple[float, Array]]:
    """Return the RMS of each function, and its ratio in each part of the pairs alone.

    Parameters
    ----------
    functions : sequence of Function
        The functions.
    equations : NormalEquations
        Their normal equations.
    together : bool, optional
        Whether a form counts with the random function of the same quantities.

    Returns
    -------
    list of (float, ndarray of shape (parts,))
        RMS [N·m] and ratios.
    """
    whole = equations.coefficients()
    alone = [equations.by_part(number) for number in range(len(equations.inner))]
    numbers = np.repeat(np.arange(len(functions)), [len(one.scale) for one in functions])
    found = []
    for number, one in enumerate(functions):
        belonging = [number]
        if together and one.is_form:
            axes = {"position" if axis == "load" else axis for axis in one.axes}
            belonging += [
                other
                for other, two in enumerate(functions)
                if not two.is_form and set(two.axes) == axes and two.channel == one.channel
            ]
        chosen = np.isin(numbers, belonging)
        columns = equations.columns[:, chosen]
        torque = columns @ whole[chosen]
        square = max(float(torque @ torque), 1e-300)
        ratios = np.array([columns @ own[chosen] @ torque / square for own in alone])
        found.append((float(np.sqrt(square / (len(torque) / 2))), ratios))
    return found


def located(
    functions: Sequence[Function], equations: NormalEquations, forms: Sequence[FormFunction]
) -> tuple[Located, ...]:
    """Return the forms of a term, or else all of its functions, the largest first.

    Parameters
    ----------
    functions : sequence of Function
        The functions, forms first.
    equations : NormalEquations
        Their normal equations.
    forms : sequence of FormFunction
        The forms, in this order.
    """
    sizes = sizes_of_parts(functions, equations, together=True)
    squares = sum(size**2 for size, _ in sizes)
    found = []
    for number, (one, (size, ratios)) in enumerate(zip(functions, sizes, strict=True)):
        reach = float(t_quantile(0.975, len(ratios) - 1) * np.std(ratios, ddof=1))
        reach /= math.sqrt(len(ratios))
        found.append(
            Located(
                axes=one.axes,
                channel=one.channel,
                form=forms[number] if number < len(forms) else None,
                size=size,
                interval=(size * max(1 - reach, 0.0), size * (1 + reach)),
                share=size**2 / max(squares, 1e-300),
            )
        )
    kept = found[: len(forms)] or found
    return tuple(sorted(kept, key=lambda one: -one.size))
