"""The temperature of friction: rivals fitted, compared, and the best one with intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import residual_of_base
from frictioncli.diagnosis.thermal.criterion import NoiseFit, information_criterion, noise_fit
from frictioncli.diagnosis.thermal.nonlinear_fit import NetworkForm, NonlinearFit, fit_structure
from frictioncli.diagnosis.thermal.pair_data import ThermalData
from frictioncli.effects.base import Basis
from frictioncli.effects.thermal_lag import EFFECT
from frictioncli.linear_algebra import scaled_gram_inverse
from frictioncli.model.friction import FrictionParameters

MEASURED = NetworkForm(name="measured")
"""Friction at the measured temperature of the base model."""

WITH_HOUSING = (
    NetworkForm(name="housing", at_housing=True),
    NetworkForm(name="mix", parts=(2,)),
    NetworkForm(name="one_node", parts=(1,), times=1, whole=True),
    NetworkForm(name="one_node", parts=(3,), times=1, whole=True),
    NetworkForm(name="one_node", parts=(1, 3), times=1, whole=True),
    NetworkForm(name="one_node", parts=(0, 3), times=1),
    NetworkForm(name="one_node", parts=(0, 1, 3), times=1),
)
"""Rivals where the housing is measured: it, a mix of both, a hidden gear between them, and one that
has a part of the friction while the rest is at the motor."""

WITHOUT_HOUSING = (
    NetworkForm(name="one_node", parts=(1,), times=1, whole=True),
    NetworkForm(name="one_node", parts=(0, 1), times=1),
    NetworkForm(name="two_nodes", parts=(1, 3), times=2, whole=True),
)
"""Rivals where it is not: a hidden gear, with all or a part of the friction, or a hidden gear and a
hidden housing."""

_Z95 = 1.959963984540054
"""Half-width of a 95 % interval in standard errors."""

_CONVINCING = 10.0
"""Difference of the criterion by which a rival must be better than a simpler one: very strong
evidence."""

_THAN_WHOLE = 20.0
"""Difference by which it must be better than a gear that has all the friction: with a part of the
friction elsewhere, a network imitates errors of the power, and predicts a new day worse."""

_THAN_MIX = 4.0
"""Difference by which it must be better than a mix: a mix has no physics of its own, and imitates a
network on one run."""

_ALIKE = 0.0025
"""A temperature that is measured is as good if it leaves no more than this share of the mean
friction beside what the best rival leaves: no network is exact."""

_FORM = 0.05
"""Standard deviation of the logarithm of a time constant by the form of the network: a joint has
more nodes than one or two, and its temperatures are read in steps."""

_TOLERANCE = 1e-10
"""Directions of unit columns with less than this share of the squared length are undetermined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalParameter:
    """An estimated parameter.

    Attributes
    ----------
    value, low, high : float
        Its value and its 95 % interval. [unit]
    unit : str
        Its unit.
    """

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedNetwork:
    """A structure fitted to the data.

    Attributes
    ----------
    structure : NetworkForm
        The network.
    fit : NonlinearFit
        Its best fit.
    noise : NoiseFit
        The noise that suits its residual best.
    criterion : float
        Its information criterion, the smaller the better.
    """

    structure: NetworkForm
    fit: NonlinearFit
    noise: NoiseFit
    criterion: float

    @property
    def is_housing(self) -> bool:
        """Whether all friction is at the temperature of the housing."""
        return self.structure.at_housing

    @property
    def left(self) -> float:
        """RMS residual of the pair means [N·m]."""
        return float(np.sqrt(np.mean(np.square(self.fit.residual))))


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalEstimate:
    """The temperature of friction.

    Attributes
    ----------
    rivals : tuple of FittedNetwork
        All structures: the chosen one, then the others by their criterion.
    parameters : FrictionParameters
        Parameters of (16) at that temperature.
    hidden : HiddenTemperature or None
        The hidden temperature; none where the measured one explains friction as well.
    estimates : mapping of str to ThermalParameter
        Time constants and coefficients of the network with intervals.
    temperature : ndarray, shape (pairs of all runs,)
        Temperature of friction in each pair of all runs. [°C]
    """

    rivals: tuple[FittedNetwork, ...]
    parameters: FrictionParameters
    hidden: HiddenTemperature | None
    estimates: Mapping[str, ThermalParameter]
    temperature: Array

    @property
    def chosen(self) -> FittedNetwork:
        """The simplest structure that explains friction as well as any."""
        return self.rivals[0]

    @property
    def mix(self) -> FittedNetwork | None:
        """The mix of measured temperatures; none where the housing is not measured."""
        return self.rival("mix")

    def rival(self, name: str) -> FittedNetwork | None:
        """Return the best rival of a kind of structure; none where it was not tried."""
        found = [one for one in self.rivals if one.structure.name == name]
        return min(found, key=lambda one: one.criterion, default=None)


def estimate_temperature(problem: Problem, beside: Sequence[Basis] = ()) -> ThermalEstimate:
    """Estimate the temperature of friction.

    Parameters
    ----------
    problem : Problem
        The rows, with gamma and delta among the fitted parameters.
    beside : sequence of Basis
        Columns of other effects at these rows.

    Returns
    -------
    ThermalEstimate
        The simplest rival that is as good as the best one: within 10 of its information criterion,
        a gear with all the friction within 20 if it is within 10 of the best of those, a mix within
        4, a measured temperature also where it leaves hardly more.
    """
    residual = residual_of_base(problem, problem.friction_misfit, "friction", beside)
    point = max(problem.layout.point_deviation(residual), 1e-9)
    means = problem.layout.means(residual[:, np.newaxis])[:, 0]
    deviation = max(float(np.median(np.abs(means))) * 1.4826, point / 10)
    data = ThermalData.of(problem, beside, point=point, deviation=deviation)
    others = WITHOUT_HOUSING if data.inputs.housing is None else WITH_HOUSING
    found = [_rival(problem, data, structure) for structure in (MEASURED, *others)]
    ranked = sorted(found, key=lambda one: one.criterion)
    chosen = simplest_as_good(ranked, _ALIKE * float(np.mean(np.abs(problem.friction))))
    ranked.remove(chosen)
    return _estimate(problem, data, (chosen, *ranked))


def simplest_as_good(ranked: Sequence[FittedNetwork], alike: float) -> FittedNetwork:
    """Return the simplest rival that is as good as the best one; see :func:`estimate_temperature`.

    Parameters
    ----------
    ranked : sequence of FittedNetwork
        The rivals by their criterion, the best first.
    alike : float
        What a measured temperature may leave beside what the best rival leaves. [N·m]
    """
    good = [one for one in ranked if _is_as_good(one, ranked, alike)]
    return min(good, key=lambda one: one.structure.order)


def _is_as_good(one: FittedNetwork, ranked: Sequence[FittedNetwork], alike: float) -> bool:
    """Return whether a rival explains friction as well as the best, up to a torque [N·m]."""
    best = ranked[0]
    worse = one.criterion - best.criterion
    if one.structure.name == "mix":
        return worse < _THAN_MIX
    if worse < _CONVINCING:
        return True
    if one.structure.whole:
        best_whole = next(other for other in ranked if other.structure.whole)
        return worse < _THAN_WHOLE and one.criterion - best_whole.criterion < _CONVINCING
    more = np.sqrt(max(one.left**2 - best.left**2, 0.0))
    return one.structure.name in ("measured", "housing") and bool(more < alike)


def _rival(problem: Problem, data: ThermalData, structure: NetworkForm) -> FittedNetwork:
    fit = fit_structure(data, structure)
    noise = noise_fit(problem.layout, fit.residual, fit.design)
    criterion = information_criterion(noise, fit.design.shape[1], len(data.target))
    return FittedNetwork(structure=structure, fit=fit, noise=noise, criterion=criterion)


def _estimate(
    problem: Problem, data: ThermalData, rivals: tuple[FittedNetwork, ...]
) -> ThermalEstimate:
    fit = rivals[0].fit
    values = dict(zip(data.names, map(float, fit.linear), strict=False))
    values |= {"gamma": fit.gamma, "delta": fit.delta}
    stated = {
        name: values.get(name, getattr(problem.parameters, name))
        for name in ("tau_c", "alpha", "beta", "gamma", "delta")
    }
    inputs = data.inputs
    if fit.housing_time_constant is not None:
        inputs = inputs.with_hidden_housing(fit.housing_time_constant)
    hidden = None
    if rivals[0].structure is not MEASURED:
        hidden = HiddenTemperature.of(
            fit.time_constant,
            fit.coefficients,
            problem.reference_power,
            fit.housing_time_constant,
        )
    return ThermalEstimate(
        rivals=rivals,
        parameters=FrictionParameters(**stated),
        hidden=hidden,
        estimates=MappingProxyType(_intervals(data, rivals[0])),
        temperature=inputs.base + inputs.excess(fit.time_constant) @ fit.coefficients,
    )


def _intervals(data: ThermalData, rival: FittedNetwork) -> dict[str, ThermalParameter]:
    """Return the parameters of the network; those on a bound with all others as they are."""
    fit = rival.fit
    first = fit.derivative.shape[1] - len(fit.names)
    fixed = np.append(np.ones(first, dtype=bool), fit.inside)
    found = {}
    axes = {one.name: one for one in (*EFFECT.shape, *EFFECT.coefficients)}
    axes["housing_time_constant"] = axes["time_constant"]
    names = [one.name for one in EFFECT.coefficients]
    for number, name in enumerate(fit.names[1:], start=1):
        chosen = fixed.copy()
        chosen[first + number] = True
        place = int(np.sum(chosen[: first + number]))
        error = float(np.sqrt(_error_covariance(data, rival, chosen)[place, place]))
        axis = axes[name]
        if name.endswith("time_constant"):
            value = float(getattr(fit, name))
            reach = _Z95 * float(np.hypot(error, _FORM))
            low, high = value * np.exp(-reach), value * np.exp(reach)
        else:
            value = float(fit.coefficients[names.index(name)])
            low, high = value - _Z95 * error, value + _Z95 * error
        found[name] = ThermalParameter(
            value=value,
            low=max(float(low), axis.lower),
            high=min(float(high), axis.upper),
            unit=axis.unit,
        )
    if rival.structure.whole:
        # the share that follows the motor is what the other one leaves
        other = found.get("housing_lag_share")
        low, high = (1.0 - other.high, 1.0 - other.low) if other else (1.0, 1.0)
        share = ThermalParameter(value=float(fit.coefficients[0]), low=low, high=high, unit="1")
        found["lag_share"] = share
    return found


def _error_covariance(data: ThermalData, rival: FittedNetwork, chosen: Array) -> Array:
    """Return the covariance of weighted estimates under the rival's correlated noise."""
    derivative = rival.fit.derivative[:, chosen]
    count = data.linear.shape[1]
    within = np.zeros((len(data.within), derivative.shape[1]))
    within[:, :count] = data.within[:, :count]
    weight = data.deviation**2
    gram = within.T @ within
    bread = scaled_gram_inverse(derivative.T @ derivative / weight + gram, tolerance=_TOLERANCE)
    meat = derivative.T @ rival.noise.covariance.times(derivative) / weight**2 + gram
    return np.asarray(bread @ meat @ bread)
