"""The five parameters by least squares, against scipy's ``curve_fit`` given a good start."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from tests.studies.benching import Disagreement, Round, Work, faster, function

NAMES = ("tau_c", "alpha", "beta", "gamma", "delta")
TRUTH = (10.57, 0.0014, 3.48, 15.66, 0.056)

START = (9.0, 0.0016, 3.0, 17.0, 0.05)
"""Where ``curve_fit`` begins: within 16 % of the truth."""

TIMES = 7
"""Fits in each process; their median counts. The first one warms up."""

SOURCES = tuple(
    f"model/{name}.py" for name in ("equations", "variable_projection", "newton_refinement")
)

SAME = 1e-6
"""Greatest difference from the exact minimum. [standard errors]"""


def works(small: bool) -> list[Work]:
    """Return the fits of two sizes."""
    sizes = (
        {10**3: (0.1, None), 10**4: (0.5, None)} if small else {10**5: (3, None), 10**6: (5, None)}
    )
    return [_work(size, must, reach) for size, (must, reach) in sizes.items()]


def _work(size: int, must: float, reach: float | None) -> Work:
    return Work(
        name=f"fit-{size:.0e}".replace("+0", ""),
        title=f"Fit of equation (16) to {size:.0e} observations".replace("+0", ""),
        prepare=partial(observe, size=size),
        contestants=[
            function(
                "frictioncli",
                "tests.studies.bench_fit:projected",
                times=TIMES,
                shown="frictioncli.model.variable_projection.minimise(equations, COEFFICIENTS)",
            ),
            function(
                "curve_fit",
                "tests.studies.bench_fit:curve_fitted",
                times=TIMES,
                shown=f"scipy.optimize.curve_fit(law, (T, sqrt(v), L**2), friction, p0={START})",
            ),
        ],
        check=partial(same_minimum, size=size),
        goals=[faster("frictioncli", "curve_fit", must, reach)],
        sources=SOURCES,
    )


def observe(data: Path, size: int) -> None:
    """Write observations of a joint: temperature, speed, load, friction. [°C], [deg/s], [N·m]."""
    np.save(data / "observations.npy", observed(size))


def observed(size: int) -> np.ndarray:
    """Return such observations, shape (4, size)."""
    generator = np.random.default_rng(16)
    temperature = generator.uniform(20, 68, size)
    speed = generator.choice([19.1, 39.4, 67.5, 101.2], size)
    load = 95 * np.cos(np.radians(generator.uniform(0, 180, size)))
    exact = law((temperature, np.sqrt(speed), np.square(load)), *TRUTH)
    return np.stack([temperature, speed, load, exact + generator.normal(0, 0.3, size)])


def law(at, tau_c, alpha, beta, gamma, delta):
    """Equation (16), of temperature, root of speed and squared load."""
    temperature, root_speed, squared_load = at
    viscous = beta + gamma * np.exp(-delta * temperature)
    return tau_c + alpha * squared_load + viscous * root_speed


def projected(data: Path, out: Path) -> Callable[[], list[float]]:
    """Prepare frictioncli's fit, which has no start."""
    from frictioncli.model.equations import COEFFICIENTS, Equations
    from frictioncli.model.variable_projection import minimise

    temperature, speed, load, friction = np.load(data / "observations.npy")

    def act() -> list[float]:
        equations = Equations(
            constant=np.ones_like(friction),
            squared_load=np.square(load),
            root_speed=np.sqrt(speed),
            temperature=temperature,
            friction=friction,
        )
        found = minimise(equations, COEFFICIENTS)
        return [getattr(found, name) for name in NAMES]

    return act


def curve_fitted(data: Path, out: Path) -> Callable[[], list[float]]:
    """Prepare scipy's fit, with a good start."""
    from scipy.optimize import curve_fit

    temperature, speed, load, friction = np.load(data / "observations.npy")

    def act() -> list[float]:
        at = (temperature, np.sqrt(speed), np.square(load))
        return [float(value) for value in curve_fit(law, at, friction, p0=START)[0]]

    return act


def same_minimum(runs: Round, size: int) -> str:
    """Check both against the minimum itself, found with 64 bits of mantissa."""
    exact, error = minimum(observed(size))
    away = {
        name: float(np.max(np.abs(np.array(run.result) - exact) / error))
        for name, run in runs.items()
    }
    if away["frictioncli"] > SAME or away["curve_fit"] > 1e-3:
        raise Disagreement(f"standard errors from the minimum: {away}")
    told = ", ".join(f"{name} {value:.0e}" for name, value in away.items())
    return f"Distance from the exact minimum, in standard errors: {told}."


def minimum(observations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the least-squares minimum by Gauss-Newton steps in long doubles, and standard errors.

    Residuals are in extended precision; the last step is 1e-12 standard errors or less.
    """
    temperature, speed, load, friction = observations.astype(np.longdouble)
    at = (temperature, np.sqrt(speed), np.square(load))
    values = np.array(TRUTH, dtype=np.longdouble)
    for _ in range(30):
        decay = at[1] * np.exp(-values[4] * temperature)
        slopes = [np.ones_like(decay), at[2], at[1], decay, -values[3] * temperature * decay]
        residual = friction - law(at, *values)
        gradient = np.array([slope @ residual for slope in slopes])
        jacobian = np.stack(slopes).astype(float)
        inverse = np.linalg.inv(jacobian @ jacobian.T)
        error = np.sqrt(np.diag(inverse) * float(residual @ residual) / len(friction))
        step = inverse @ gradient
        values = values + step
        if np.all(np.abs(step) <= 1e-12 * error):
            return values.astype(float), error
    raise Disagreement("the exact minimum was not found")
