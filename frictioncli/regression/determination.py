"""Which parameters the motion determines, which it does not, and when it tells nothing at all."""

from dataclasses import dataclass, replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.errors import NotEnoughData
from frictioncli.regression.dissipation import friction_sign
from frictioncli.regression.equation import (
    FRICTION_TERMS,
    EquationTerms,
    JointEquations,
    friction_columns,
    load_torque,
)
from frictioncli.regression.estimate import RegressionEstimate
from frictioncli.regression.identification import DELTA_BOUNDS, identify, identify_delay
from frictioncli.regression.preparation import PreparedJoint
from frictioncli.regression.speed_law import NO_LAW
from frictioncli.regression.zero_load_friction import friction_at

LEAST_ROWS = 100
"""Least rows for a regression: 5 s of motion, at the usual width of the filter."""

_LEAST_TEMPERATURE_SPAN = 10.0
"""Least span of temperature from which gamma and delta are told, as in the fit. [°C]"""

_LEAST_SPEED_RATIO = 1.5
"""Least ratio of the 95 % to the 5 % quantile of speed that tells viscous friction."""

_LEAST_ANGLE_SPAN = 20.0
"""Angles that span less do not tell gravity's amplitude, but its torque there. [deg]"""

_STRAIGHT = "the fall with temperature is too weakly curved to separate beta from gamma; fixed at 0"

_LEAST_LOAD_SPREAD = 0.05
"""Spread of the squared load, as a share of its mean, below which its term is Coulomb friction."""

_VAGUE = 0.5
"""Friction whose half interval exceeds this share of it is not determined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointRegression:
    """A regression of one joint, with what it determines.

    Attributes
    ----------
    prepared : PreparedJoint
        Its rows.
    estimate : RegressionEstimate
        Its parameters, friction terms with the sign of the log.
    sign : int
        +1 where the log holds load plus friction while moving forward, -1 where the difference.
    undetermined : dict of str to str
        Parameters that were not fitted or are not told, with the reason.
    friction : dict of float to (float, float, float)
        Friction without load, with its 95 % interval, by speed in deg/s. [torque unit]
    temperature : float or None
        Temperature of that friction. [°C]
    late : RegressionEstimate or None
        A fit with a delay that is not told from zero; none where it is, or where there is no such
        fit.
    """

    prepared: PreparedJoint
    estimate: RegressionEstimate
    sign: int
    undetermined: dict[str, str]
    friction: dict[float, tuple[float, float, float]]
    temperature: float | None
    late: RegressionEstimate | None = None

    @property
    def equations(self) -> JointEquations:
        """The rows."""
        return self.prepared.equations

    def load(self) -> Array:
        """Return gravity, measured load and offset at each row."""
        one = self.estimate
        return load_torque(self.equations, one.terms, one.load_coefficients, one.delay)

    def modelled_friction(self) -> Array:
        """Return the friction of the model at each row, positive against the motion."""
        one = self.estimate
        columns = friction_columns(
            self.equations, one.terms, one.squared_load, one.parameters.get("delta", 0.0), one.delay
        )
        coefficients = np.array([one.parameters[name] for name in one.terms.friction_names])
        return np.asarray(self.sign * self.equations.direction * (columns @ coefficients))


def regress(prepared: PreparedJoint, joint: int, sign: int | None = None) -> JointRegression:
    """Fit the parameters that the motion of a joint determines.

    Parameters
    ----------
    prepared : PreparedJoint
        Rows of the joint.
    joint : int
        Its number, for messages.
    sign : {+1, -1}, optional
        Sign convention of the log; found from the data where not given.

    Returns
    -------
    JointRegression
        The fit.

    Raises
    ------
    NotEnoughData
        If there is too little motion, the torque holds no friction, or friction is not told from
        load and inertia.
    """
    equations = prepared.equations
    if len(equations.rows) < LEAST_ROWS:
        dropped = ", ".join(f"{reason}: {n}" for reason, n in prepared.dropped.items() if n)
        raise NotEnoughData(
            f"joint {joint}: {len(equations.rows)} stretches of motion of"
            f" {_row_time(equations):.2g} s for a regression ({dropped}), expected at least"
            f" {LEAST_ROWS}; log longer moves"
        )
    try:
        return _regressed(prepared, joint, sign)
    except NotEnoughData:
        if not prepared.terms.speed_law.names:
            raise
    # a motion that does not tell a free law of the speed may tell that of the root
    terms = replace(prepared.terms, speed_law=NO_LAW)
    return _regressed(replace(prepared, terms=terms), joint, sign)


def _regressed(prepared: PreparedJoint, joint: int, sign: int | None) -> JointRegression:
    """Fit the terms that the motion excites, without a delay where it does not tell one."""
    terms, undetermined = _by_excitation(prepared)
    estimate, other = identify_delay(prepared.equations, terms)
    late = None if estimate.terms.delay else other
    try:
        return _determined(prepared, joint, sign, estimate, dict(undetermined), late)
    except NotEnoughData:
        if other is None or late is other:
            raise
    return _determined(prepared, joint, sign, other, undetermined)


def _determined(
    prepared: PreparedJoint,
    joint: int,
    sign: int | None,
    estimate: RegressionEstimate,
    undetermined: dict[str, str],
    late: RegressionEstimate | None = None,
) -> JointRegression:
    """Leave out of a fit what the data do not determine; refuse friction that they do not."""
    equations, terms = prepared.equations, prepared.terms
    if "alpha" in estimate.terms.friction:
        # a load that hardly varies would let it hold anything
        fewer = _without_vague_load(estimate, 0, undetermined)
        estimate = estimate if fewer is None else identify(equations, fewer)
    direction = friction_sign(equations, estimate, joint, sign)
    while True:
        fewer = _by_interval(equations, estimate, direction, undetermined)
        if fewer is None:
            break
        estimate = identify(equations, fewer)
    found = JointRegression(
        prepared=prepared,
        estimate=estimate,
        sign=direction,
        undetermined=undetermined,
        friction=friction_at(equations, estimate, direction),
        temperature=_temperature(equations, terms),
        late=late,
    )
    _refuse(found, joint)
    return found


def _row_time(equations: JointEquations) -> float:
    rows = equations.rows
    return 2 * float(np.sqrt(3 * rows.variance[0])) if len(rows) else 0.05


def _by_excitation(prepared: PreparedJoint) -> tuple[EquationTerms, dict[str, str]]:
    """Return the terms that spans of temperature, speed and angle excite."""
    equations, terms = prepared.equations, prepared.terms
    undetermined: dict[str, str] = {}
    if "gamma" not in terms.friction:
        reason = "the log has no motor temperature; merged with beta"
        undetermined |= {"gamma": reason, "delta": reason}
    elif (span := float(np.ptp(equations.temperature))) < _LEAST_TEMPERATURE_SPAN:
        reason = f"temperature spans {span:.1f} °C, at least 10 °C are needed; merged with beta"
        undetermined |= {"gamma": reason, "delta": reason}
        terms = terms.without("gamma")
    low, high = np.quantile(np.abs(equations.velocity), [0.05, 0.95]).tolist()
    if high < _LEAST_SPEED_RATIO * low:
        reason = f"speeds of {low:.3g} to {high:.3g} deg/s do not determine viscous friction"
        undetermined["beta"] = f"{reason}; merged into tau_c"
        terms = replace(terms.without("beta"), speed_law=NO_LAW)
    if not terms.offset:
        reason = "motion in one direction only; a constant offset counts as friction"
        undetermined["offset"] = reason
    span = float(np.ptp(equations.rows.position))
    if not equations.rows.position.any():
        undetermined["gravity"] = "the log has no angle"
    elif span < _LEAST_ANGLE_SPAN:
        reason = "the load torque within it is still determined"
        undetermined["gravity"] = f"angle spans {span:.1f} deg; {reason}"
    return terms, undetermined


def _without_vague_load(
    estimate: RegressionEstimate, sign: int, undetermined: dict[str, str]
) -> EquationTerms | None:
    """Return the terms without that of the load, if it may be zero or negative; else none."""
    low, high = sorted((sign or 1) * bound for bound in estimate.interval("alpha"))
    squared = estimate.squared_load
    varies = float(np.std(squared)) > _LEAST_LOAD_SPREAD * float(np.mean(squared))
    if varies and (low > 0 or (not sign and high < 0)):
        return None
    load = np.sqrt(estimate.squared_load)
    undetermined["alpha"] = (
        f"the magnitude of the load spans {load.min():.3g} to {load.max():.3g}, too little to show"
        f" in the friction ({low:.2g} to {high:.2g}); left out (0)"
    )
    return estimate.terms.without("alpha")


def _by_interval(
    equations: JointEquations,
    estimate: RegressionEstimate,
    sign: int,
    undetermined: dict[str, str],
) -> EquationTerms | None:
    """Return the terms without one that the data do not determine; none if all are."""
    terms = estimate.terms
    if "alpha" in terms.friction:
        fewer = _without_vague_load(estimate, sign, undetermined)
        if fewer is not None:
            return fewer
    if "delta" in estimate.parameters:
        delta, gamma = estimate.parameters["delta"], estimate.parameters["gamma"] * sign
        vague = estimate.quantile() * estimate.deviation("delta") >= delta
        at_bound = any(abs(delta / bound - 1) < 1e-3 for bound in DELTA_BOUNDS)
        if vague or at_bound or gamma <= 0:
            if "beta" in terms.friction and gamma > 0:
                undetermined["beta"] = _STRAIGHT
                return terms.without("beta")
            reason = "the data do not show that friction falls with temperature; left out (0)"
            undetermined |= {"gamma": reason, "delta": reason}
            left = terms.without("gamma").friction
            if undetermined.get("beta") == _STRAIGHT:
                del undetermined["beta"]
                left = tuple(name for name in FRICTION_TERMS if name in (*left, "beta"))
            return replace(terms, friction=left)
    return None


def _temperature(equations: JointEquations, terms: EquationTerms) -> float | None:
    known = "gamma" in terms.friction or bool(np.any(equations.temperature))
    return float(np.median(equations.temperature)) if known else None


def _refuse(found: JointRegression, joint: int) -> None:
    """Refuse friction that is not told from load and inertia, or that predicts nothing."""
    middle = float(np.median(np.abs(found.equations.velocity)))
    speed = min(found.friction, key=lambda one: abs(one - middle))
    value, low, _ = found.friction[speed]
    if value - low > _VAGUE * abs(value):
        raise NotEnoughData(
            f"joint {joint}: friction cannot be separated from load and inertia"
            f" ({value:.3g} ± {value - low:.2g} at {speed:.3g} deg/s, condition number"
            f" {found.estimate.condition:.3g}); log motion in both directions over the same angles"
        )
    modelled = found.modelled_friction()
    spread = float(np.sqrt(np.mean(np.square(modelled))))
    if found.estimate.held_out > 2 * spread:
        raise NotEnoughData(
            f"joint {joint}: torque predicted for stretches that were left out errs by"
            f" {found.estimate.held_out:.3g} RMS, more than the friction of {spread:.3g}: the log"
            " holds other torques than inertia, gravity and friction of this joint"
        )
