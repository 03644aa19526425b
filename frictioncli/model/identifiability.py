"""Which parameters of equation (16) the data determine, and how the others are handled.

A term that the experiment did not excite, or whose confidence interval is too wide, is not fitted:
another term takes over its share, or it is left out. The reason is given with the numbers that
decided it. The intervals that decide are those by noise within the runs: what these runs show is
there, even where other days may differ.
"""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.model.equations import COEFFICIENTS
from frictioncli.model.identification import Estimate, fit_terms
from frictioncli.model.observations import Observations
from frictioncli.model.variable_projection import DELTA_BOUNDS
from frictioncli.wording import range_text

MIN_TEMPERATURE_SPAN = 10.0
"""Least span of temperature from which gamma and delta are fitted. [°C]"""

MIN_SPEED_RATIO = 1.5
"""Least ratio of the highest to the lowest speed that separates viscous from Coulomb friction."""

_VAGUE = 0.5
"""A term whose half interval exceeds this share of the mean friction is not determined."""

_NEGLIGIBLE = 0.05
"""A load term that may be zero is kept if its upper bound is below this share of the friction."""

_NOISY = 4.0
"""Variance of the squared load, relative to that of its noise, from which the load is more."""


@dataclass(frozen=True, slots=True)
class Determination:
    """The terms that are fitted, and why the others are not.

    Attributes
    ----------
    terms : tuple of str
        Coefficients that are fitted.
    dropped : dict of str to str
        Parameters that are not fitted, with the reason and what was done.
    merged : dict of str to str
        Parameters that took over another one's share, with what they hold.
    """

    terms: tuple[str, ...] = COEFFICIENTS
    dropped: dict[str, str] = field(default_factory=dict)
    merged: dict[str, str] = field(default_factory=dict)

    def without(self, term: str, reason: str, holder: str | None, holds: str) -> "Determination":
        """Return the determination without a term.

        Parameters
        ----------
        term : str
            The coefficient that is no longer fitted.
        reason : str
            Why.
        holder : str or None
            Parameter that takes over its share.
        holds : str
            What that parameter then holds.
        """
        dropped = self.dropped | {term: reason}
        if term == "gamma":
            dropped["delta"] = reason
        merged = self.merged if holder is None else self.merged | {holder: holds}
        if holder == "gamma":
            merged["delta"] = "the rate at which the whole viscous coefficient falls"
        return Determination(tuple(t for t in self.terms if t != term), dropped, merged)

    def without_gamma(self, reason: str) -> "Determination":
        """Return the determination without gamma; beta comes back where gamma held its share.

        Parameters
        ----------
        reason : str
            Why gamma is no longer fitted.
        """
        if "gamma" not in self.merged:
            return self.without("gamma", f"{reason}; left out (0)", None, "")
        taken = ("gamma", "delta")
        dropped = {name: why for name, why in self.dropped.items() if name != "beta"}
        merged = {name: what for name, what in self.merged.items() if name not in taken}
        terms = tuple(one for one in COEFFICIENTS if one == "beta" or one in self.terms)
        return Determination(terms, dropped, merged).without(
            "gamma",
            f"{reason}; merged with beta into one viscous coefficient",
            "beta",
            "holds the whole viscous coefficient",
        )


def determined_fit(
    observed: Observations, *, vague_delta: bool = False
) -> tuple[Estimate, Determination]:
    """Fit the parameters that the data determine.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    vague_delta : bool, optional
        Whether gamma and delta stay where delta is vague, be it because the temperature hardly
        varies: what the model lacks may be the reason, and what it could have is no other effect.

    Returns
    -------
    Estimate, Determination
        The fit, and which terms it has.
    """
    chosen = _by_excitation(observed, least_span=0.0 if vague_delta else MIN_TEMPERATURE_SPAN)
    while True:
        estimate = fit_terms(observed, chosen.terms)
        fewer = _by_interval(observed, estimate, chosen, vague_delta=vague_delta)
        if fewer is chosen:
            return estimate, chosen
        chosen = fewer


def at_bound(estimate: Estimate) -> dict[str, str]:
    """Return the fitted parameters that lie at a physical bound, with the reason."""
    flags = {
        name: "at its lower bound, 0: the best fit would be negative"
        for name in estimate.names
        if name != "delta" and getattr(estimate.parameters, name) <= 0
    }
    if "delta" in estimate.names:
        if "gamma" in flags:
            flags["delta"] = "without meaning, as gamma is 0"
            return flags
        for bound in DELTA_BOUNDS:
            if abs(estimate.parameters.delta / bound - 1) < 1e-3:
                flags["delta"] = f"at the bound {bound:g} of its search range"
        if "delta" not in flags and estimate.interval_within("delta")[0] <= 0:
            flags["delta"] = "its interval includes 0, no fall with temperature"
    return flags


def _by_excitation(observed: Observations, least_span: float) -> Determination:
    """Return the terms that the spans of temperature and speed excite."""
    chosen = Determination()
    temperatures = observed.temperature[np.isfinite(observed.temperature)]
    if not temperatures.size:
        chosen = chosen.without(
            "gamma",
            "the temperature is not logged; merged with beta into one viscous coefficient",
            "beta",
            "holds the whole viscous coefficient at the unknown temperature of the log",
        )
    elif (span := float(np.ptp(temperatures))) < least_span or not span:
        low, high = np.min(temperatures), np.max(temperatures)
        chosen = chosen.without(
            "gamma",
            f"temperature spans {high - low:.1f} °C ({low:.1f} to {high:.1f}), at least"
            f" {MIN_TEMPERATURE_SPAN:g} °C are needed; merged with beta into one viscous"
            " coefficient",
            "beta",
            f"holds the whole viscous coefficient at {low:.1f} to {high:.1f} °C",
        )
    slowest, fastest = np.min(observed.speed), np.max(observed.speed)
    if fastest < MIN_SPEED_RATIO * slowest:
        speeds = f"{range_text([f'{slowest:.3g}', f'{fastest:.3g}'])} deg/s"
        chosen = chosen.without(
            "beta",
            f"motion at {speeds} does not separate viscous from Coulomb friction; merged into"
            " tau_c",
            "tau_c",
            f"holds Coulomb friction and the viscous part beta, at {speeds}",
        )
    return chosen


def why_no_load_term(observed: Observations, estimate: Estimate) -> str:
    """Return why the data do not determine alpha; empty if they do.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    estimate : Estimate
        A fit to it; one without alpha does not determine it.
    """
    squares = observed.squared_load[observed.row_pair] + observed.squared_load_within
    if "alpha" in estimate.names:
        friction = float(np.mean(np.abs(observed.friction)))
        low, high = estimate.interval_within("alpha")
        vague = (high - low) / 2 * np.ptp(squares) > _VAGUE * friction
        # a user will ask for loads at least as great as the friction
        greatest = max(float(np.max(squares)), friction**2)
        doubtful = low <= 0 and high * greatest > _NEGLIGIBLE * friction
        if load_varies(observed, estimate) and not (vague or doubtful):
            return ""
    return (
        f"the magnitude of the load spans {np.sqrt(np.min(squares)):.3g} to"
        f" {np.sqrt(np.max(squares)):.3g}, too little to show in the friction; left out (0)"
    )


def load_varies(observed: Observations, estimate: Estimate, noise: float = np.inf) -> bool:
    """Return whether the square of the load varies by more than noise makes of it.

    Parameters
    ----------
    observed : Observations
        Friction of one joint.
    estimate : Estimate
        A fit to it.
    noise : float, optional
        Greatest noise of a bin, where it is known apart from that of the fit. [N·m]
    """
    squares = observed.squared_load[observed.row_pair] + observed.squared_load_within
    # what noise of the size of a bin's makes of the square of a load
    of_noise = _NOISY * float(np.mean(4.0 * squares)) * min(estimate.noise.point, noise) ** 2
    return bool(np.var(squares) > of_noise)


def _by_interval(
    observed: Observations, estimate: Estimate, chosen: Determination, *, vague_delta: bool
) -> Determination:
    """Return a determination with a term less if the data do not determine it, else the same."""
    friction = float(np.mean(np.abs(observed.friction)))
    if "gamma" in chosen.terms and estimate.parameters.gamma <= 0:
        # with gamma 0 the derivative by delta is 0 too, and nothing tells delta
        return chosen.without_gamma(
            "at its lower bound 0: friction does not fall with temperature in these data"
        )
    half_width = {
        name: (high - low) / 2
        for name in estimate.names
        for low, high in [estimate.interval_within(name)]
    }
    if "alpha" in chosen.terms and (reason := why_no_load_term(observed, estimate)):
        return chosen.without("alpha", reason, None, "")
    if "delta" in half_width and half_width["delta"] >= estimate.parameters.delta:
        if "beta" in chosen.terms:
            return chosen.without(
                "beta",
                "the fall with temperature is too weakly curved to separate beta from gamma;"
                " fixed at 0",
                "gamma",
                "holds the whole viscous coefficient",
            )
        if not vague_delta:
            return chosen.without_gamma("the data do not show that friction falls with temperature")
    if "beta" in half_width and "gamma" not in chosen.terms:
        root_speed = np.sqrt(observed.speed)
        if half_width["beta"] * float(np.ptp(root_speed)) > _VAGUE * friction * 2:
            return chosen.without(
                "beta",
                "too uncertain to be separated from Coulomb friction; merged into tau_c",
                "tau_c",
                "holds Coulomb and viscous friction",
            )
    return chosen
