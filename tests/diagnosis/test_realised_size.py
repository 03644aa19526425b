"""Sizes of random functions as they were in the log."""

import numpy as np
import pytest

from frictioncli.diagnosis.search.realised_size import realised


def test_size_and_interval_are_those_of_functions_drawn_at_random():
    generator = np.random.default_rng(4)
    columns = generator.normal(size=(200, 30))
    mean = generator.normal(size=30)
    root = 0.1 * generator.normal(size=(30, 30))
    drawn = mean + generator.normal(size=(20000, 30)) @ root.T
    squares = np.mean(np.square(drawn @ columns.T), axis=1)
    size, interval = realised(columns.T @ columns / len(columns), mean, root @ root.T)
    assert size == pytest.approx(np.sqrt(np.mean(squares)), rel=0.01)
    reach = 1.96 * np.std(squares)
    expected = np.sqrt(np.mean(squares) + np.array([-reach, reach]))
    assert interval == pytest.approx(tuple(expected), rel=0.02)
