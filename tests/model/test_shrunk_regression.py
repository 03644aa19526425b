"""A coefficient beside others that are likely small: against least squares and over many draws."""

import numpy as np
import pytest

from frictioncli.model.shrunk_regression import WIDTHS, ShrunkRegression

PAIRS, ANGLES = 60, 20
PAIR, ANGLE = np.divmod(np.arange(PAIRS * ANGLES), ANGLES)
VALUE = 2.0


def regression(seed, *, other=0.0, noise=1.0, by_angle=0.0, shrunk=True):
    """Return a regression on two columns that are alike to 95 %, the second of them with a prior.

    ``by_angle`` is noise that all rows of an angle share, times the first column.
    """
    generator = np.random.default_rng(seed)
    first, second = generator.normal(size=(2, len(PAIR)))
    second = 0.95 * first + np.sqrt(1 - 0.95**2) * second
    target = VALUE * first + other * second + noise * generator.normal(size=len(PAIR))
    target = target + by_angle * generator.normal(size=ANGLES)[ANGLE] * first
    return ShrunkRegression(
        columns=np.column_stack([first, second]),
        target=target,
        unit=np.array([np.inf, 10.0 if shrunk else np.inf]),
        pair=PAIR,
        angle=ANGLE,
        freedom=len(PAIR) - 2,
    )


def textbook(one, columns):
    """Return the first coefficient of least squares on some columns, and its error."""
    chosen = one.columns[:, columns]
    coefficients = np.linalg.lstsq(chosen, one.target, rcond=None)[0]
    residual = one.target - chosen @ coefficients
    variance = residual @ residual / (len(residual) - len(columns))
    return coefficients[0], np.sqrt(variance * np.linalg.inv(chosen.T @ chosen)[0, 0])


def test_without_a_prior_it_is_least_squares():
    one = regression(1, other=0.7, shrunk=False)
    found, (value, error) = one.first(), textbook(one, [0, 1])
    assert found.value == pytest.approx(value, rel=1e-9)
    assert found.change == pytest.approx(0.0, abs=1e-9)
    assert 0.99 * error <= found.error < 1.6 * error


def test_a_column_of_which_the_data_show_nothing_costs_little_precision():
    """The error lies nearer to that of least squares without the column than to that with it."""
    ratios = []
    for seed in range(30):
        one = regression(seed)
        without, beside = textbook(one, [0])[1], textbook(one, [0, 1])[1]
        ratios.append((one.first().error - without) / (beside - without))
    assert np.median(ratios) < 0.5


def test_a_column_that_the_data_show_is_beside_the_first_as_in_least_squares():
    one = regression(4, other=1.0)
    found = one.first()
    assert found.value == pytest.approx(textbook(one, [0, 1])[0], abs=0.3 * found.error)
    assert found.change == pytest.approx(-0.95, abs=0.15)


@pytest.mark.parametrize("law", [{}, {"by_angle": 0.5}, {"noise": 0.1, "by_angle": 0.05}], ids=str)
def test_intervals_hold_the_value_over_all_that_the_prior_allows(law):
    generator = np.random.default_rng(9)
    widths = generator.choice(WIDTHS, size=300)
    others = 10.0 * widths * generator.normal(size=300)
    found = [regression(seed, other=other, **law).first() for seed, other in enumerate(others)]
    assert np.mean([abs(one.value - VALUE) < 1.96 * one.error for one in found]) >= 0.9


def test_columns_that_agree_exactly_are_told_apart_by_nothing():
    one = regression(2)
    alike = one.columns[:, [0, 0]]
    twice = ShrunkRegression(alike, one.target, one.unit, PAIR, ANGLE, one.freedom).first()
    assert np.isfinite(twice.value)
    assert twice.value - 1.96 * twice.error < VALUE < twice.value + 1.96 * twice.error


def test_what_is_explained_without_rest_has_no_noise():
    one = regression(5, other=0.5, noise=0.0).first()
    assert one.value == pytest.approx(VALUE, abs=1e-4)
    assert one.error < 1e-3
