"""Coverage of the inputs, against a response surface by hand."""

import numpy as np
import pytest

from frictioncli.design.precision import response_surface_log_determinants
from frictioncli.effects.pair_series import rows_of
from tests.design.examples import few_pairs


@pytest.fixture(scope="module")
def problem():
    return few_pairs()


def test_coverage_is_the_determinant_of_a_quadratic(problem):
    """By hand: inputs of a table, scaled to -1 ... 1, with squares and products."""
    table = problem.table
    half = rows_of(table, table.time < 600.0)
    low, high = response_surface_log_determinants([half, table])
    rest = np.log1p(np.minimum(table.rest, 43200.0))
    inputs = [np.sqrt(table.speed), table.temperature, table.position, table.load]
    inputs += [np.sqrt(table.travel), np.sqrt(table.time), rest]
    unit = [2 * (one - one.min()) / np.ptp(one) - 1 for one in inputs if np.ptp(one) > 0]
    columns = [np.ones(len(rest)), *unit]
    columns += [a * b for i, a in enumerate(unit) for b in unit[i:]]
    design = np.column_stack(columns)
    strengths = np.linalg.svd(design, compute_uv=False)
    assert high == pytest.approx(0.5 * np.sum(np.log1p(strengths**2)), rel=1e-9)
    assert low < high
