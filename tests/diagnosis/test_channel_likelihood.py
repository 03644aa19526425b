"""Inner products of one channel, against its rows under the dense covariance."""

import numpy as np
import pytest

from frictioncli.diagnosis.fit.channel_likelihood import ChannelLikelihood
from frictioncli.diagnosis.fit.columns import ChannelColumns
from frictioncli.diagnosis.noise.spectra import spectra_of
from tests.diagnosis import dense_noise

PAIRS = dense_noise.layout(14, 11, bins=[2, 3, 2, 3, 2] * 5)
COUNT = 25
POINT = 0.2
GENERATOR = np.random.default_rng(9)


def channel(columns):
    return ChannelColumns(
        GENERATOR.normal(size=(40, columns)), GENERATOR.normal(size=(COUNT, columns))
    )


BASE, CANDIDATES, MISFIT = channel(3), channel(5), channel(1)
SPECTRA = spectra_of(PAIRS, POINT, np.linspace(0, 0.2, COUNT), MISFIT.means[:, 0])
CHANNEL = ChannelLikelihood.of(SPECTRA, POINT, BASE, MISFIT)


def products(chosen, setting):
    """White products of the deviations, and those of the means under the dense covariance."""
    inside = np.hstack([BASE.within, CANDIDATES.within[:, chosen], MISFIT.within]) / POINT
    means = np.hstack([BASE.means, CANDIDATES.means[:, chosen], MISFIT.means])
    noise = dense_noise.covariance(PAIRS, SPECTRA, setting)
    return inside.T @ inside, means.T @ np.linalg.solve(noise, means)


@pytest.mark.parametrize("setting", [(0, 0), (1, 3), (5, 7)])
@pytest.mark.parametrize("columns", [[[2]], [[0, 1], [3, 4]], [[4, 0, 1], [1, 2, 3]]])
def test_equations_of_many_candidates_are_those_of_their_rows(columns, setting):
    modes = SPECTRA.modes_at(setting[0], CANDIDATES.means)
    found = CHANNEL.normal_equations_each(CANDIDATES, modes, np.array(columns), setting)
    assert found.determinant == CHANNEL.null.determinant[setting]
    assert found.freedom == COUNT - 3
    for number, chosen in enumerate(columns):
        inside, between = products(chosen, setting)
        np.testing.assert_allclose(found.within[number], inside, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(found.between[number], between, rtol=1e-7, atol=1e-8)


def test_equations_of_the_base_alone_hold_base_and_misfit():
    nothing = ChannelColumns(CANDIDATES.within[:, :0], CANDIDATES.means[:, :0])
    found = CHANNEL.normal_equations(nothing, nothing.means, (2, 4))
    inside, between = products([], (2, 4))
    np.testing.assert_allclose(found.within, inside, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found.between, between, rtol=1e-7, atol=1e-8)
