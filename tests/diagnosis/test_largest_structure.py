"""What a model lacks on a run that was kept out, beyond what days differ by."""

import numpy as np
import pytest

from frictioncli.diagnosis.search.largest_structure import _size, inadequacy, size_along
from tests.diagnosis.dense_noise import problem

FLOOR = 0.02
"""RMS of the noise, far below 1 % of the friction. [N·m]"""


def lacking(misfit_of, share):
    """Return what is lacking where a misfit of so large a share of the friction is left (RMS)."""
    data = problem(4)
    misfit = misfit_of(data)
    misfit = misfit * share * np.mean(data.friction) / np.sqrt(np.mean(np.square(misfit)))
    noise = np.random.default_rng(0).normal(0, FLOOR, (2, len(misfit)))
    return inadequacy(data, misfit + noise[0], noise[1], floor=FLOOR, margin=0.1)


@pytest.mark.parametrize(
    "of_the_day", [lambda data: np.ones_like(data.friction), lambda data: data.friction]
)
def test_a_day_with_a_little_more_or_less_friction_lacks_nothing(of_the_day):
    for share in (0.02, -0.02):
        assert lacking(of_the_day, share) is None
    found = lacking(of_the_day, 0.05)
    assert found.axes == ("time",)
    assert found.channel == "friction"


def test_what_varies_with_the_speed_alone_is_lacking_though_it_is_as_small():
    found = lacking(lambda data: np.cos(4 * np.log(data.table.speed)), 0.02)
    assert found.axes == ("speed",)


def test_what_is_below_the_margin_along_every_axis_is_not_lacking():
    """Waves along angle, speed and temperature, each 0.75 of the margin, 1.3 together."""
    data = problem(4)
    table = data.table
    waves = [
        np.cos(4 * np.log(table.speed)),
        np.sin(np.radians(7 * table.position)),
        np.cos(table.temperature / 2),
    ]
    waves = [one - np.mean(one) for one in waves]
    parts = [one / np.sqrt(np.mean(np.square(one))) for one in waves]
    none = np.zeros_like(parts[0])
    for size, is_lacking in ((0.075, False), (0.15, True)):
        found = inadequacy(data, size * sum(parts), none, floor=FLOOR, margin=0.1)
        assert (found is not None) is is_lacking


def test_the_size_along_an_axis_is_that_of_what_varies_with_it():
    data = problem(4)
    levels, place = np.unique(data.table.speed, return_inverse=True)
    torque = np.array([0.3, -0.2, 0.1, 0.4, -0.1, 0.2])[: len(levels)][place]
    noise = np.random.default_rng(1).normal(0, FLOOR, len(torque))
    assert size_along(data, "speed", 2.0 + torque + noise) == pytest.approx(
        np.std(torque), rel=0.05
    )
    assert size_along(data, "position", 2.0 + torque + noise) < 0.2 * np.std(torque)


def test_a_pair_counts_by_its_rows_as_in_the_rms():
    """Half of the pairs cross two bins each, and only they are misfitted."""
    pair = np.repeat(np.arange(40), np.where(np.arange(40) % 2, 2, 20))
    short = pair % 2 == 1
    bins = np.where(np.arange(len(pair)) % 2, 0, 1)
    misfit = np.where(short, 1.0, 0.0) * np.where(bins, 1.0, -1.0)
    size, _ = _size(misfit, bins, pair)
    # the mean of either bin is 1 in one row of eleven, without what the scatter gives
    assert size == pytest.approx(1 / 11, rel=0.2)
    assert size < np.sqrt(np.mean(np.square(misfit)))
    size, (low, high) = _size(np.where(bins, 1.0, -1.0), bins, pair)
    assert (size, low, high) == pytest.approx((1.0, 1.0, 1.0))
