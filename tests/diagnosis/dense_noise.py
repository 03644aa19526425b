"""Pairs with drifting noise, and what dense matrices say of them."""

import numpy as np
import pandas as pd
from scipy.linalg import null_space

from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.noise.spectra import STRENGTHS
from frictioncli.model.friction import FrictionParameters
from tests.equation_16 import TRUTH, cycle_temperatures, torques


def layout(*sizes, bins=3, gap=20.0, seed=0):
    """Return the layout of runs of so many pairs, at uneven moments, with four speeds in turn."""
    generator = np.random.default_rng(seed)
    pairs = sum(sizes)
    width = np.broadcast_to(bins, pairs)
    return PairLayout.of(
        row_pair=np.repeat(np.arange(pairs), width),
        run=np.repeat(np.arange(len(sizes)), sizes),
        time=np.concatenate([np.cumsum(gap * generator.uniform(0.5, 1.5, n)) for n in sizes]),
        speed=np.resize([20.0, 40.0, 70.0, 100.0], pairs),
        position=np.concatenate([5.0 * np.arange(n) for n in width]),
    )


def alike(pairs, time_constant):
    """Return the correlation of an Ornstein-Uhlenbeck drift that starts anew with each run."""
    apart = np.abs(np.subtract.outer(pairs.time, pairs.time))
    return np.exp(-apart / time_constant) * np.equal.outer(pairs.run, pairs.run)


def covariance(pairs, spectra, setting):
    """Return H + rho R, the covariance at scale 1, of a place of the noise."""
    time, strength = setting
    drift = STRENGTHS[strength] * alike(pairs, spectra.spectra[time].time)
    return np.diag(spectra.profile) + drift


def settings(spectra):
    """Return all places of the noise; without drift all correlation times are one."""
    return [(0, 0)] + [
        (time, strength)
        for time in range(len(spectra.spectra))
        for strength in range(1, len(STRENGTHS))
    ]


def restricted(data, base, noise):
    """Return square sum, log determinant and number of the contrasts that the base leaves."""
    contrasts = null_space(base.T)
    inner = contrasts.T @ noise @ contrasts
    seen = contrasts.T @ data
    square = np.einsum("i...,i...->...", seen, np.linalg.solve(inner, seen))
    return square, np.linalg.slogdet(inner)[1], contrasts.shape[1]


def left_square(data, columns, noise):
    """Return the weighted square sum that generalised least squares leaves of data."""
    inverse = np.linalg.inv(noise)
    fitted = np.linalg.solve(columns.T @ inverse @ columns, columns.T @ inverse @ data)
    left = data - columns @ fitted
    return np.einsum("i...,i...->...", left, inverse @ left)


def days(seed, every=8, **noise):
    """Return rows of two short days of a joint that is exactly the base model, 80 pairs."""
    cycle = tuple(values[::every] for values in cycle_temperatures())
    rows = pd.concat(
        [
            torques(2 * seed + day, temperatures=cycle, **noise).assign(run=f"day{day}")
            for day in (1, 2)
        ],
        ignore_index=True,
    )
    generator = np.random.default_rng(seed)
    pair = rows.groupby(["run", "pair"]).ngroup().to_numpy()
    apart = generator.normal(0, 0.1, pair.max() + 1)[pair] + generator.normal(0, 0.3, len(rows))
    return rows.assign(
        load=np.nan,
        time=rows["time"] + 5.0,
        load_torque=rows["load_torque"] + apart,
        # off the registered one, so that no error of a whole step is assumed that is not there
        motor_temperature_reading=rows["motor_temperature"] + 0.4,
    )


def problem(seed, friction=None, load=None, **noise):
    """Return the problem of such days about the true base, with more friction and load added.

    Parameters
    ----------
    friction, load : callable, optional
        Of the rows of :func:`days`, the torque that is added to each.
    """
    rows = days(seed, **noise)
    if friction is not None:
        rows["friction_torque"] += friction(rows)
    if load is not None:
        rows["load_torque"] += load(rows)
    return simulated(rows, "motor", FrictionParameters(**TRUTH), np.array([95.0, 0.0, 0.0]))[1]
