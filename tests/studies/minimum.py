"""Does ``minimise`` find the global minimum, from the data alone? Ten thousand random joints.

Each joint has parameters, temperatures, speeds, loads, weights and noise of its own; some lack a
term, so that the minimum is at a bound. What is found is held against an oracle that shares no code
with the package: a dense grid of delta with every subset of the coefficients, its best valleys and
four random starts polished by ``least_squares``. Results are kept in ``build/bench/minimum.csv``; a
second call goes on where the first one stopped.

Usage: python -m tests.studies.minimum [JOINTS]
"""

import csv
import sys
from concurrent.futures import ProcessPoolExecutor
from itertools import combinations

import numpy as np
from scipy.optimize import least_squares

from frictioncli.model.equations import COEFFICIENTS, Equations
from frictioncli.model.variable_projection import DELTA_BOUNDS, minimise
from tests.studies.bench_fit import SOURCES
from tests.studies.bench_rounds import STORE, state

JOINTS = 10_000
ROWS = STORE / "minimum.csv"

SAME = 1e-9
"""A misfit that is greater than the oracle's by this share is a failure."""

_GRID = np.geomspace(*DELTA_BOUNDS, 600)
_SUBSETS = [list(chosen) for size in (4, 3, 2, 1) for chosen in combinations(range(4), size)]


def random_joint(seed: int) -> Equations:
    """Return the weighted equations of a random joint: 12 to 5000 observations."""
    generator = np.random.default_rng(seed)
    size = round(10 ** generator.uniform(np.log10(12), np.log10(5000)))
    present = generator.random(4) > 0.1
    tau_c, alpha, beta, gamma = present * generator.uniform(0, [30.0, 5e-3, 8.0, 40.0])
    delta = np.exp(generator.uniform(*np.log([0.002, 0.25])))
    temperature = generator.uniform(-10, 35) + generator.uniform(5, 60) * generator.random(size)
    if generator.random() < 0.5:
        temperature = np.round(temperature)
    levels = np.sort(generator.uniform(2, 250, generator.integers(2, 9)))
    root_speed = np.sqrt(generator.choice(levels, size))
    load = generator.uniform(2, 150) * np.cos(generator.uniform(0, np.pi, size))
    deviation = 10 ** generator.uniform(-2.5, 0.5) * generator.uniform(0.3, 3.0, size)
    heavy = generator.random() < 0.2
    noise = generator.standard_t(3, size) if heavy else generator.normal(0, 1, size)
    viscous = beta + gamma * np.exp(-delta * temperature)
    friction = tau_c + alpha * load**2 + viscous * root_speed + deviation * noise
    return Equations(
        constant=1 / deviation,
        squared_load=load**2 / deviation,
        root_speed=root_speed / deviation,
        temperature=temperature,
        friction=friction / deviation,
    )


def misfit(equations: Equations, values: np.ndarray) -> float:
    """Return the sum of squares at (tau_c, alpha, beta, gamma, delta)."""
    residual = _residual(values, equations)
    return float(residual @ residual)


def _residual(values: np.ndarray, joint: Equations) -> np.ndarray:
    tau_c, alpha, beta, gamma, delta = values
    viscous = beta + gamma * np.exp(-delta * joint.temperature)
    rigid = tau_c * joint.constant + alpha * joint.squared_load
    return rigid + viscous * joint.root_speed - joint.friction


def _slopes(values: np.ndarray, joint: Equations) -> np.ndarray:
    decay = joint.root_speed * np.exp(-values[4] * joint.temperature)
    by_delta = -values[3] * joint.temperature * decay
    return np.column_stack([joint.constant, joint.squared_load, joint.root_speed, decay, by_delta])


def oracle(joint: Equations, seed: int) -> float:
    """Return the least misfit that grid and polished starts find."""
    at, misfits = _grid(joint)
    padded = np.concatenate([[np.inf], misfits, [np.inf]])
    valleys = np.flatnonzero((misfits <= padded[:-2]) & (misfits <= padded[2:]))
    starts = [at[i] for i in valleys[np.argsort(misfits[valleys])][:3]]
    generator = np.random.default_rng([seed, 1])
    highest = np.array([30.0, 5e-3, 8.0, 40.0, 0.29])
    starts += [np.maximum(highest * generator.random(5), 2e-3) for _ in range(4)]
    return min([float(misfits.min()), *(_polished(joint, start) for start in starts)])


def _grid(joint: Equations) -> tuple[np.ndarray, np.ndarray]:
    """Return the best non-negative coefficients at every delta of the grid, and the misfits."""
    fixed = [joint.constant, joint.squared_load, joint.root_speed]
    at, misfits = np.zeros((len(_GRID), 5)), np.empty(len(_GRID))
    for i, delta in enumerate(_GRID):
        columns = np.column_stack([*fixed, joint.root_speed * np.exp(-delta * joint.temperature)])
        size = np.linalg.norm(columns, axis=0)
        triangle = np.linalg.qr(np.column_stack([columns / size, joint.friction]), mode="r")
        misfits[i] = triangle[:, 4] @ triangle[:, 4]
        at[i, 4] = delta
        for subset in _SUBSETS:
            found, *_ = np.linalg.lstsq(triangle[:, subset], triangle[:, 4], rcond=None)
            left = triangle[:, 4] - triangle[:, subset] @ found
            if (found < 0).any():
                continue
            if left @ left < misfits[i]:
                misfits[i] = left @ left
                at[i, :4] = 0.0
                at[i, subset] = found / size[subset]
            if len(subset) == len(size):
                break  # nothing is lower than all four together
    return at, misfits


def _polished(joint: Equations, start: np.ndarray) -> float:
    bounds = ([0.0, 0.0, 0.0, 0.0, DELTA_BOUNDS[0]], [np.inf] * 4 + [DELTA_BOUNDS[1]])
    found = least_squares(
        _residual,
        np.clip(start, np.array(bounds[0]) + 1e-9, np.array(bounds[1]) - 1e-9),
        _slopes,
        bounds,
        args=(joint,),
        x_scale="jac",
        ftol=1e-15,
        xtol=1e-15,
        gtol=1e-15,
        max_nfev=300,
    )
    return 2 * float(found.cost)


def compared(seed: int, known: float | None = None) -> tuple[int, int, float, float, bool]:
    """Return seed, observations, both misfits, and whether ours is as low as the oracle's.

    What the oracle finds does not depend on the package: it may be ``known`` from an earlier state.
    """
    joint = random_joint(seed)
    found = minimise(joint, COEFFICIENTS)
    values = np.array([getattr(found, name) for name in (*COEFFICIENTS, "delta")])
    ours = misfit(joint, values)
    theirs = oracle(joint, seed) if known is None else known
    allowed = bool((values >= 0).all()) and DELTA_BOUNDS[0] <= found.delta <= DELTA_BOUNDS[1]
    return seed, len(joint), ours, theirs, allowed and ours <= theirs * (1 + SAME)


def every() -> list[dict[str, str]]:
    """Return all rows that are stored."""
    if not ROWS.exists():
        return []
    with ROWS.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def stored() -> list[dict[str, str]]:
    """Return the rows that are stored for the present state of the package."""
    return [row for row in every() if row["state"] == state(*SOURCES)]


def main(joints: int) -> None:
    """Compare the joints that are missing; say how many failed."""
    rows = stored()
    done = {int(row["seed"]) for row in rows}
    known = {int(row["seed"]): float(row["oracle"]) for row in every()}
    ROWS.parent.mkdir(parents=True, exist_ok=True)
    with ROWS.open("w", encoding="utf-8", newline="") as stream, ProcessPoolExecutor() as pool:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["state", "seed", "size", "ours", "oracle", "same"])
        writer.writerows(row.values() for row in rows)
        missing = [seed for seed in range(joints) if seed not in done]
        oracles = map(known.get, missing)
        for row in pool.map(compared, missing, oracles, chunksize=10):
            writer.writerow([state(*SOURCES), *row[:2], *map(repr, row[2:4]), int(row[4])])
            stream.flush()
    print(text())


def text() -> str:
    """Return what the stored rows say."""
    rows = stored()
    missed = [row["seed"] for row in rows if row["same"] != "1"]
    many = sum(int(row["size"]) > 2000 for row in rows)
    told = f"{len(rows) - len(missed)} of {len(rows)} joints ({many} of over 2000 observations)"
    return told + (f"; missed: {', '.join(missed)}" if missed else "")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else JOINTS)
