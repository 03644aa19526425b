r"""Least squares on all rows of a joint: bounded search in two parameters, the others projected.

For given :math:`\delta` and delay all other parameters follow from a linear problem [1]_, whose
rows are whitened (:mod:`frictioncli.regression.whitening`) and lose weight where their residual is
large [2]_. The covariance is that of a jackknife that leaves out one block of time after another
[3]_: noise may be correlated within a block in any way. It also predicts each block from the
others, which gives the held-out error.

References
----------
.. [1] G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
   squares problems whose variables separate," SIAM J. Numer. Anal. 10(2), 1973,
   doi:10.1137/0710036.
.. [2] P. J. Huber, "Robust estimation of a location parameter," Ann. Math. Statist. 35(1), 1964,
   doi:10.1214/aoms/1177703732.
.. [3] M. H. Quenouille, "Notes on bias in estimation," Biometrika 43(3/4), 1956,
   doi:10.1093/biomet/43.3-4.353.
"""

from dataclasses import replace

import numpy as np

from frictioncli.arrays import Array
from frictioncli.linear_algebra import scaled_gram_inverse
from frictioncli.regression.blocks import block_numbers
from frictioncli.regression.equation import (
    EquationTerms,
    JointEquations,
    friction_columns,
    load_columns,
    load_derivatives,
    load_torque,
)
from frictioncli.regression.estimate import TOLERANCE, RegressionEstimate, left_out_changes
from frictioncli.regression.whitening import Whitening, places, whitening

DELTA_BOUNDS = (1e-3, 0.3)
"""Range of delta, as of the fit of pairs. [1/°C]"""

LONGEST_DELAY = 0.1
"""Greatest delay of the torque, either way. [s]"""

_SEARCHED = 40_000
"""Rows on which the nonlinear parameters are searched."""

_STRETCH = 64
"""Rows that follow each other in what is searched."""

_DELTAS = np.geomspace(*DELTA_BOUNDS, 16)

_HUBER = 2.0
"""Residuals above so many robust standard deviations lose weight."""

_STEPS = 12
"""Most Gauss-Newton steps."""

_CONVERGED = 1e-7
"""Share of the sum of squares by which the last step made it smaller."""

_MUCH_LEFT = 1.05
"""Ratio of the residuals without and with a delay from which it is believed whatever its error."""

_ROUNDS = 3
"""Rounds of whitening and of the load in the friction."""


def identify(equations: JointEquations, terms: EquationTerms) -> RegressionEstimate:
    """Fit the equation of motion to all rows of a joint.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    terms : EquationTerms
        Terms of the equation.

    Returns
    -------
    RegressionEstimate
        Parameters with their covariance.
    """
    fit = _RowFit(equations, terms)
    part = some_equations(equations)
    if part is equations:
        fit.search()
    else:
        first = _RowFit(part, terms)
        first.search()
        fit.take(first)
    fit.refine()
    fit.refine()
    return fit.result()


def identify_delay(
    equations: JointEquations, terms: EquationTerms
) -> tuple[RegressionEstimate, RegressionEstimate | None]:
    """Fit the equation with a delay if it is told, or if much more is left without it.

    Far from the known delay the series leave so much that no interval tells the delay. Rows that
    are free of a delay keep the term whatever its interval.

    Parameters
    ----------
    equations : JointEquations
        The rows.
    terms : EquationTerms
        Terms of the equation, perhaps with a delay.

    Returns
    -------
    estimate : RegressionEstimate
        The fit.
    other : RegressionEstimate or None
        Where its interval does not tell the delay, the fit without it, or with it if that is not
        the first.
    """
    some, prompt = some_equations(equations), None
    estimate = identify(some, terms)
    if terms.delay and not equations.known_delay and not estimate.told("delay"):
        prompt = identify(equations, replace(terms, delay=False))
        if prompt.rmse < _MUCH_LEFT * estimate.rmse:
            return prompt, estimate
    return (estimate if some is equations else identify(equations, terms)), prompt


class _RowFit:
    """State of a fit: nonlinear parameters, load, whitening and weights."""

    def __init__(self, equations: JointEquations, terms: EquationTerms) -> None:
        self.equations, self.terms = equations, terms
        rows = equations.rows
        self.place = places(rows.move, rows.number)
        self.white = Whitening((np.empty(0),), (1.0,))
        self.weight = np.ones(len(rows))
        self.squared_load = np.zeros(len(rows))
        self.delta, self.delay = 0.05, equations.known_delay if terms.delay else 0.0
        self.linear = np.zeros(len(terms.linear))

    def take(self, other: "_RowFit") -> None:
        """Start from another fit of the same terms."""
        self.delta, self.delay, self.white = other.delta, other.delay, other.white
        self.linear = other.linear
        self._set_load()

    def search(self) -> None:
        """Scan delta with the load of the fit before, then refine all."""
        for _ in range(_ROUNDS + 1):
            self._project()
            if "gamma" in self.terms.friction:
                errors = []
                for delta in _DELTAS.tolist():
                    self.delta = delta
                    errors.append(self._project())
                self.delta = float(_DELTAS[int(np.argmin(errors))])
                self._project()
            self._set_load()
        for _ in range(_ROUNDS):
            self.refine()

    def refine(self) -> None:
        """Gauss-Newton steps in all parameters, then new whitening and weights."""
        error = self._project()
        for _ in range(_STEPS if self.terms.nonlinear else 0):
            before = self.delta, self.delay, self.linear
            step = self._newton_step()
            for share in (1.0, 0.5, 0.25, 0.125):
                self._move(before, share * step)
                new = self._project()
                if new <= error:
                    break
            else:
                self.delta, self.delay, self.linear = before
                break
            done = error - new <= _CONVERGED * error
            error = new
            if done:
                break
        self._set_load()
        self._project()
        residual = self._residual()
        scale = 1.4826 * float(np.median(np.abs(residual))) or 1e-12
        self.white = whitening(np.clip(residual, -4 * scale, 4 * scale), self.place)
        white = self.white.apply(residual, self.place)
        spread = 1.4826 * float(np.median(np.abs(white))) or 1e-12
        self.weight = np.minimum(1.0, _HUBER * spread / np.maximum(np.abs(white), 1e-300))

    def _columns(self) -> Array:
        load = load_columns(self.equations, self.terms, self.delay)
        friction = friction_columns(
            self.equations, self.terms, self.squared_load, self.delta, self.delay
        )
        return np.hstack([load, friction])

    def _whitened(self, values: Array) -> Array:
        return self.white.apply(values, self.place)

    def _weighted(self, values: Array) -> Array:
        """Return whitened values with the root of the robust weights."""
        return np.asarray((self._whitened(values).T * np.sqrt(self.weight)).T)

    def _project(self) -> float:
        """Solve for the linear parameters; return the sum of squares."""
        columns = self._weighted(self._columns())
        target = self._weighted(self.equations.rows.torque)
        gram = columns.T @ columns
        self.linear = scaled_gram_inverse(gram, tolerance=TOLERANCE) @ (columns.T @ target)
        return float(np.sum(np.square(target - columns @ self.linear)))

    def _residual(self) -> Array:
        return np.asarray(self.equations.rows.torque - self._columns() @ self.linear)

    def _newton_step(self) -> Array:
        """Return the step of the nonlinear parameters."""
        jacobian = self._weighted(self.jacobian())
        target = self._weighted(self._residual())
        gram = jacobian.T @ jacobian
        step = scaled_gram_inverse(gram, tolerance=TOLERANCE) @ (jacobian.T @ target)
        return np.asarray(step[len(self.linear) :])

    def _move(self, before: tuple[float, float, Array], step: Array) -> None:
        """Set the nonlinear parameters to a step from others, within their bounds."""
        self.delta, self.delay, self.linear = before
        for name, change in zip(self.terms.nonlinear, step.tolist(), strict=True):
            if name == "delta":
                self.delta = float(np.clip(self.delta + change, *DELTA_BOUNDS))
            else:
                self.delay = float(np.clip(self.delay + change, -LONGEST_DELAY, LONGEST_DELAY))

    def jacobian(self) -> Array:
        """Return the derivatives of the torque by all parameters, shape (rows, names)."""
        columns = self._columns()
        more = []
        for name in self.terms.nonlinear:
            if name == "delta":
                index = self.terms.linear.index("gamma")
                derivative = -self.equations.temperature * columns[:, index] * self.linear[index]
            else:
                step = 1e-5
                delay, self.delay = self.delay, self.delay + step
                derivative = (self._columns() @ self.linear - columns @ self.linear) / step
                self.delay = delay
            more.append(derivative)
        return np.hstack([columns, *(one[:, np.newaxis] for one in more)])

    def _set_load(self) -> None:
        """Take the load of the friction from the present fit, or from the load channel."""
        if self.terms.load_channel:
            self.squared_load = np.square(self.equations.rows.load)
        else:
            coefficients = self.linear[: len(self.terms.load_names)]
            load = load_torque(self.equations, self.terms, coefficients, self.delay)
            self.squared_load = np.square(load)

    def result(self) -> RegressionEstimate:
        """Return the parameters with the covariance of the jackknife."""
        residual = self._residual()
        raw = self.jacobian()
        columns, derivatives = (self._whitened(one) for one in (raw, self._full_jacobian(raw)))
        white = self._whitened(residual)
        block = block_numbers(self.equations.rows, white * self.equations.direction)
        # an outlier's pull is constant, so that it does not hold the parameters in place
        inlier = (self.weight >= 1.0).astype(float)
        changes = left_out_changes(
            columns, derivatives * inlier[:, np.newaxis], white * self.weight, block
        )
        count = len(changes)
        mean = changes.mean(axis=0)
        covariance = (count - 1) / count * (changes - mean).T @ (changes - mean)
        size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        predicted = residual - np.einsum("ij,ij->i", raw, changes[block])
        nonlinear = {"delta": self.delta, "delay": self.delay}
        parameters = dict(zip(self.terms.linear, self.linear.tolist(), strict=True))
        parameters |= {name: nonlinear[name] for name in self.terms.nonlinear}
        return RegressionEstimate(
            terms=self.terms,
            parameters=parameters,
            covariance=covariance,
            blocks=count,
            residual=residual,
            held_out=float(np.sqrt(np.mean(np.square(predicted)))),
            squared_load=self.squared_load,
            condition=float(np.linalg.cond(columns / size)),
            noise_order=self.white.order,
            downweighted=int(np.sum(self.weight < 0.5)),
        )

    def _full_jacobian(self, jacobian: Array) -> Array:
        """Return the jacobian with what gravity changes in the friction through the load."""
        if self.terms.load_channel or "alpha" not in self.terms.friction:
            return jacobian
        full = jacobian.copy()
        alpha = self.linear[self.terms.linear.index("alpha")]
        own = len(self.terms.load_names)
        derivatives = load_derivatives(self.equations, self.terms, self.delay)
        slope = 2 * alpha * (derivatives @ self.linear[:own]) * self.equations.direction
        full[:, :own] += slope[:, np.newaxis] * derivatives
        return full


def some_equations(equations: JointEquations) -> JointEquations:
    """Return the equations of some rows of a long log, in stretches that follow each other.

    Parameters
    ----------
    equations : JointEquations
        All rows; returned as they are if they are few.
    """
    rows = len(equations.rows)
    if rows <= _SEARCHED:
        return equations
    stretch = np.arange(rows) // _STRETCH
    every = -(-rows // _SEARCHED)
    return equations.where(stretch % every == 0)
