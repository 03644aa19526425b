"""Coefficients that differ between runs: against dense matrices, and days drawn by hand."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import cauchy, t

from frictioncli.model.fitting import fit_joint
from frictioncli.model.noise import Noise
from frictioncli.model.run_differences import (
    difference_of_estimates,
    noise_and_differences,
    run_starts,
)
from frictioncli.model.settings import FitSettings
from tests.equation_16 import TRUTH, daily_torques, torques

SHORT = np.linspace(25.0, 60.0, 8), 300.0 * np.arange(8.0), np.repeat("heat-up", 8)


def shares_of(seed, runs, share):
    """By which factor the friction of each run is another one."""
    return 1 + share * np.random.default_rng(seed).standard_normal(runs)


def days(seed, runs, share, **noise):
    """So many short days, each with friction of another size."""
    parts = []
    for run, factor in enumerate(shares_of(seed, runs, share)):
        truth = {name: factor * value for name, value in TRUTH.items()} | {"delta": TRUTH["delta"]}
        own = torques(100 * seed + run, truth=truth, temperatures=SHORT, **noise)
        parts.append(own.assign(run=f"day{run}"))
    return pd.concat(parts, ignore_index=True)


def widths(table, method="joint"):
    found = fit_joint(table, {}, FitSettings(method=method)).parameters
    return {name: np.ptp(found[name].ci95) for name in TRUTH}


def test_runs_begin_where_their_number_changes():
    np.testing.assert_array_equal(run_starts(np.array([4, 4, 0, 7, 7])), [0, 2, 3])


def test_a_difference_of_estimates_is_the_posterior_mean_by_numerical_integration():
    """Means are integrated out by hand; the prior of the share is a half-Cauchy distribution."""
    values, variances = np.array([0.98, 1.03, 1.0, 1.02]), np.array([1.0, 4.0, 2.0, 1.0]) * 1e-5
    shares, means = np.geomspace(0.0005, 0.2, 300), np.linspace(0.8, 1.2, 2001)
    spread = np.sqrt(variances[:, None] + shares**2)[:, :, None]
    away = (values[:, None, None] - means) / spread
    likelihood = np.sum(np.exp(-np.sum(np.square(away) / 2 + np.log(spread), axis=0)), axis=1)
    density = likelihood * shares * cauchy.pdf(shares, scale=0.005)
    expected = np.sqrt(np.sum(density * shares**2) / np.sum(density))
    # six standard deviations stand for all
    assert difference_of_estimates(values, variances) == pytest.approx(expected, rel=0.15)


def test_shares_are_those_of_dense_matrices():
    """Three runs with an offset each; the likelihood of a share is that of the whole covariance."""
    generator = np.random.default_rng(2)
    run, time = np.repeat([0, 1, 2], 6), np.tile(50.0 * np.arange(6.0), 3)
    ones, slope = np.ones(18), np.linspace(0, 1, 18)
    design = np.column_stack([ones, slope])
    level = np.repeat([0.5, -0.3, 0.1], 6)
    residual = level + 0.05 * generator.standard_normal(18)
    contributions = 10.0 * ones[None, :]
    noises, shares = noise_and_differences(
        contributions,
        np.array([0.01]),
        residual=residual,
        design=design,
        time=time,
        run=run,
        bins=np.full(18, 10.0),
        point=0.05,
    )
    tried = np.geomspace(0.001, 0.1, 6)
    chances = np.zeros(6)
    for noise, _ in noises:
        chances += [
            np.exp(restricted(noise, share, residual, design, run, time)) for share in tried
        ]
    chances *= tried * cauchy.pdf(tried, scale=0.005)
    expected = np.sqrt(chances @ tried**2 / chances.sum())
    assert shares[0] == pytest.approx(expected, rel=1e-3)
    assert sum(weight for _, weight in noises) == pytest.approx(1.0)


def restricted(noise: Noise, share, residual, design, run, time):
    """The restricted log likelihood as its definition says it."""
    same = run[:, None] == run[None, :]
    apart = np.abs(time[:, None] - time[None, :])
    drift = noise.drift**2 * np.exp(-apart / noise.drift_time) + (10.0 * share) ** 2
    whole = same * drift + np.eye(18) * (noise.pair**2 + noise.point**2 / 10)
    inverse = np.linalg.inv(whole)
    information = design.T @ inverse @ design
    right = design.T @ inverse @ residual
    determinants = np.linalg.slogdet(whole)[1] + np.linalg.slogdet(information)[1]
    quadratic = residual @ inverse @ residual - right @ np.linalg.solve(information, right)
    return -(determinants + quadratic) / 2


@pytest.mark.parametrize("method", ["joint", pytest.param("paper", marks=pytest.mark.slow)])
def test_alpha_of_days_that_differ_is_as_uncertain_as_their_mean(method):
    """Within a day alpha is known to 0.3 %. Days of 3 % give Student's interval of their mean."""
    table = days(1, 6, 0.03, drift=0.05)
    cooled = table.assign(phase="cool-down", pair=table["pair"] + 100, time=table["time"] + 3e4)
    drawn = TRUTH["alpha"] * shares_of(1, 6, 0.03)
    expected = 2 * t.ppf(0.975, df=5) * np.std(drawn, ddof=1) / np.sqrt(6)
    found = widths(pd.concat([table, cooled], ignore_index=True), method)["alpha"]
    assert found == pytest.approx(expected, rel=0.25)


@pytest.mark.long
def test_intervals_of_days_that_differ_hold():
    """Twelve logs of six days that differ by 2 %: of 60 intervals of 95 % at least 53 hold."""
    held = 0
    for seed in range(12):
        model = fit_joint(days(seed, 6, 0.02, drift=0.05), {}, FitSettings())
        for name, value in TRUTH.items():
            low, high = model.parameters[name].ci95
            held += low <= value <= high
    assert held >= 53


def test_one_run_tells_nothing_of_other_runs():
    assert difference_of_estimates(np.array([1.0]), np.array([1e-4])) == 0.0


def test_days_that_do_not_differ_cost_little():
    """Ten days alike are hardly less certain than one run as long as all of them."""
    alike = daily_torques(10, seed=3).assign(housing_temperature=np.nan)
    one = alike.assign(
        time=alike["time"] + 1e4 * alike["run"].str[1:].astype(int),
        pair=alike["pair"] + 100 * alike["run"].str[1:].astype(int),
        run="all",
    )
    wide, narrow = widths(alike), widths(one)
    for name in ("tau_c", "beta", "gamma", "delta"):
        assert wide[name] < 1.6 * narrow[name]
