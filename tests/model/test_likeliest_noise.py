"""The restricted likelihood of several drifts at once against dense matrices and differences."""

import numpy as np
import pytest
from scipy.optimize import minimize

from frictioncli.model.drift import Drift, inverse_diagonal, posterior_factor, solved
from frictioncli.model.likeliest_noise import NoiseLikelihood, likeliest

TIME = np.array([0.0, 10.0, 25.0, 400.0, 500.0, 0.0, 30.0, 31.0, 90.0])
RUN = np.array([0, 0, 0, 0, 0, 1, 1, 1, 1])
KNOWN = np.array([1.0, 1.0, 2.0, 1.0, 1.0, 3.0, 1.0, 1.0, 2.0]) * 0.01
DURATIONS = (20.0, 120.0, 900.0)
SHARED = np.array([np.full(9, 0.3), 0.1 * np.arange(9.0)])
LOGS = np.log([[0.2, 0.5], [0.3, 0.1], [0.05, 0.4]])


def dense(logs, duration):
    """The covariance of white noise, drift and runs as their definition says it, part by part."""
    apart = np.abs(TIME[:, None] - TIME[None, :])
    same = RUN[:, None] == RUN[None, :]
    pair, slow = np.exp(2 * np.asarray(logs))
    fixed = np.diag(KNOWN) + same * (SHARED.T @ SHARED)
    return fixed, pair * np.eye(len(TIME)), slow * np.exp(-apart / duration) * same


def parts():
    """An orthonormal basis of the design beside the residuals."""
    generator = np.random.default_rng(4)
    basis, _ = np.linalg.qr(generator.normal(size=(len(TIME), 2)))
    return basis, generator.normal(size=len(TIME))


def projection(covariance, basis):
    inverse = np.linalg.inv(covariance)
    middle = np.linalg.inv(basis.T @ inverse @ basis)
    return inverse - inverse @ basis @ middle @ basis.T @ inverse


def likelihood():
    basis, residual = parts()
    drifts = [Drift.of(TIME, RUN, duration) for duration in DURATIONS]
    return NoiseLikelihood.of(np.column_stack([basis, residual]), KNOWN, drifts, RUN, SHARED)


def dense_cost(logs, duration):
    basis, residual = parts()
    covariance = sum(dense(logs, duration))
    information = basis.T @ np.linalg.inv(covariance) @ basis
    determinants = sum(np.linalg.slogdet(one)[1] for one in (covariance, information))
    return (determinants + residual @ projection(covariance, basis) @ residual) / 2


def test_costs_agree_with_dense_matrices():
    found = likelihood().costs(LOGS, np.arange(3)).value
    expected = [dense_cost(*one) for one in zip(LOGS, DURATIONS, strict=True)]
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_some_of_the_drifts_have_the_costs_that_they_have_among_all():
    every = likelihood().costs(LOGS, np.arange(3))
    some = likelihood().costs(LOGS[[2, 0]], np.array([2, 0]))
    np.testing.assert_allclose(some.value, every.value[[2, 0]], rtol=1e-12)
    np.testing.assert_allclose(some.gradient, every.gradient[[2, 0]], rtol=1e-9)


def test_gradients_agree_with_differences():
    gradient = likelihood().costs(LOGS, np.arange(3)).gradient
    for number, step in enumerate(1e-5 * np.eye(2)):
        above, below = (
            likelihood().costs(LOGS + sign * step, np.arange(3)).value for sign in (1, -1)
        )
        np.testing.assert_allclose(gradient[:, number], (above - below) / 2e-5, rtol=1e-6)


def test_curvature_is_the_average_information():
    """y'P V_i P V_j P y / 2, with V_i twice the share of the covariance."""
    basis, residual = parts()
    found = likelihood().costs(LOGS, np.arange(3)).curvature
    for logs, duration, curvature in zip(LOGS, DURATIONS, found, strict=True):
        shares = dense(logs, duration)
        middle = projection(sum(shares), basis)
        along = np.array([2 * one @ middle @ residual for one in shares[1:]])
        np.testing.assert_allclose(curvature, along @ middle @ along.T / 2, rtol=1e-8)


def test_the_likeliest_is_where_another_search_finds_it():
    time = 60.0 * np.arange(80.0)
    generator = np.random.default_rng(5)
    residual = np.cumsum(generator.normal(size=80)) * 0.2 + 0.3 * generator.normal(size=80)
    columns = np.column_stack([np.full(80, 80**-0.5), residual])
    drifts = [Drift.of(time, np.zeros(80, int), duration) for duration in (100.0, 1000.0, 1e4)]
    run, none = np.zeros(80, int), np.zeros((0, 80))
    noise = NoiseLikelihood.of(columns, np.full(80, 0.003), drifts, run, none)
    bounds = float(np.log(1e-3)), float(np.log(10.0))
    logs, value = likeliest(noise, np.log([0.5, 0.5]), bounds)
    for number in range(3):
        other = minimize(
            lambda tried, at=number: noise.costs(tried[None], np.array([at])).value[0],
            logs[number] + 0.3,
            method="Nelder-Mead",
            bounds=[bounds] * 2,
            options={"xatol": 1e-5, "fatol": 1e-8},
        )
        assert value[number] == pytest.approx(-other.fun, abs=1e-5)


def test_what_is_not_there_ends_at_its_bound():
    """Alternating residuals have no drift."""
    residual = np.tile([1.0, -1.0], 20)
    columns = np.column_stack([np.full(40, 40**-0.5), residual])
    run, none = np.zeros(40, int), np.zeros((0, 40))
    drift = Drift.of(60.0 * np.arange(40.0), run, 3000.0)
    noise = NoiseLikelihood.of(columns, np.full(40, 0.01), [drift], run, none)
    logs, _ = likeliest(noise, np.log([0.5, 0.5]), (float(np.log(1e-3)), float(np.log(10.0))))
    assert np.exp(logs[0, 0]) == pytest.approx(1.0, rel=0.05)
    assert np.exp(logs[0, 1]) < 0.01


def test_a_single_pair_has_an_inverse_covariance():
    drift, white = Drift.of(np.array([5.0]), np.array([0]), 60.0), np.array([0.5])
    factor = posterior_factor(drift.diagonal / 0.25, drift.beside / 0.25, white)
    np.testing.assert_allclose(solved(factor, white, np.array([[3.0]])), [[4.0]])
    np.testing.assert_allclose(inverse_diagonal(factor, white), [4 / 3])
