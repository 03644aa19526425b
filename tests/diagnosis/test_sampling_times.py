"""Whether samples were taken when they are stamped, or by an even clock."""

import numpy as np
import pytest

from frictioncli.diagnosis.ramps.start_windows import sampling_times

PERIOD = 0.01
JITTER = 3e-4
"""Standard deviation of the time of a sample off an even clock. [s]"""


def position(time):
    """Return the angle of a move that speeds up to 80 deg/s in 0.2 s [deg]."""
    return np.where(time < 0.2, 200.0 * np.square(time), 80.0 * time - 8.0)


def moves(generator, *, late):
    """Return true times and stamped moves; samples are taken off the clock, or stamped late."""
    true, stamped = [], []
    for _ in range(20):
        clock = PERIOD * np.arange(60)
        clock = clock[(clock == 0.0) | (generator.random(60) > 0.03)]
        jitter = generator.normal(0.0, JITTER, len(clock))
        taken = clock if late else clock + jitter
        encoder = generator.normal(0.0, 5e-4, len(clock))
        true.append(taken)
        stamped.append((clock + jitter, position(taken) + encoder))
    return true, stamped


def test_stamps_that_scatter_about_an_even_clock_are_put_right():
    true, stamped = moves(np.random.default_rng(1), late=True)
    found = sampling_times(stamped, PERIOD)
    errors = np.concatenate([one - other for one, other in zip(found, true, strict=True)])
    # of the scatter of n stamps a line keeps two parts in n
    assert np.std(errors) == pytest.approx(JITTER * np.sqrt(2 / 58), rel=0.5)


def test_samples_that_are_taken_off_the_clock_keep_their_times():
    true, stamped = moves(np.random.default_rng(2), late=False)
    for one, other in zip(sampling_times(stamped, PERIOD), true, strict=True):
        assert np.array_equal(one, other)
