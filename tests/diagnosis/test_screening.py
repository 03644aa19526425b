"""Which shapes of a hypothesis count."""

import numpy as np

from frictioncli.diagnosis.search.screening import Screened, of_size


def found(coefficients, gain):
    """Return a hypothesis with one coefficient at each of its shapes."""
    count = len(gain)
    ones = np.ones((count, 1, 1))
    return Screened(
        coefficients=np.array(coefficients)[:, np.newaxis],
        gain=np.array(gain),
        free=np.ones((count, 1), bool),
        covariance=0.01 * ones,
        inner=100.0 * ones,
        whole=np.full((count, 1), 100.0),
    )


RMS = np.array([[0.7], [0.7], [1.4]])


def test_a_shape_of_little_torque_does_not_hide_one_of_much():
    """0.05 N·m explains most, but 0.9 N·m is the one that matters."""
    kept = of_size(found([0.07, -1.3, 0.1], [300.0, 20.0, 50.0]), RMS, least=0.2)
    assert kept.gain.tolist() == [0.0, 20.0, 0.0]
    assert np.argmax(kept.gain) == 1


def test_all_shapes_stay_where_none_matters():
    kept = of_size(found([0.07, -0.1, 0.05], [300.0, 20.0, 50.0]), RMS, least=0.2)
    assert kept.gain.tolist() == [300.0, 20.0, 50.0]
