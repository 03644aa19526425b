"""``extended-model.json`` as other versions may have written it."""

import pytest

from frictioncli.diagnosis.documents.extended_model import FittedEffect
from frictioncli.errors import TableError

COEFFICIENTS = {"initial_excess": 2.0}


def test_an_effect_is_read_as_it_is_stated():
    found = FittedEffect.of("run_in", {"distance": 1e5}, COEFFICIENTS)
    assert found.effect.name == "run_in"
    assert found.shape == {"distance": 1e5}
    assert found.coefficients.tolist() == [2.0]


@pytest.mark.parametrize("shape", [{}, {"distance": 1e5, "carried_over": 0.5}, {"way": 1e5}])
def test_a_shape_of_another_version_is_refused_by_name(shape):
    with pytest.raises(TableError, match=r"run_in has the shape parameters .* \['distance'\]"):
        FittedEffect.of("run_in", shape, COEFFICIENTS)
