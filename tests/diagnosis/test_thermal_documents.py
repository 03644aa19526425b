"""The extended model with a hidden temperature: the same in memory, in JSON, on a controller."""

import numpy as np
import pytest

from frictioncli.deployment.extension import deployable_extension
from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import stated_gravity
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument, extended_model
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.documents.reload import reload
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.documents import decode, to_json
from frictioncli.model.friction import friction_torque
from tests.correction.models import published_model
from tests.diagnosis.thermal_joint import Network, torques


@pytest.fixture(scope="module")
def rows():
    return torques(Network(motor_heat=1.0))[0]


@pytest.fixture(scope="module")
def diagnosis(rows) -> Diagnosis:
    return diagnose_joint(rows, "motor", "N·m", DiagnosisSettings())


@pytest.fixture(scope="module")
def model(diagnosis) -> ExtendedModel:
    document = extended_document(diagnosis, published_model())
    return extended_model(decode(to_json(document).encode(), ExtendedDocument))


def test_the_lag_is_named_with_its_network(diagnosis):
    assert [cause.effects for cause in diagnosis.causes] == [("thermal_lag",)]
    record = diagnosis_document(diagnosis, DiagnosisSettings()).causes[0]
    assert record.statement.startswith("The gear follows the motor (")
    assert set(record.parameters) >= {"time_constant", "lag_share", "housing_lag_share"}
    for name, stated in record.parameters.items():
        assert stated.ci95 is not None, name
        assert stated.ci95[0] <= stated.estimate <= stated.ci95[1], name
    assert record.parameters["time_constant"].estimate == pytest.approx(7500 / 4.5, rel=0.2)


def test_the_extended_model_keeps_the_network_that_was_estimated(diagnosis, model):
    """A free refit would move along combinations that one run hardly tells apart."""
    assert diagnosis.thermal is not None
    assert model.hidden is not None
    estimated = diagnosis.thermal.chosen.fit
    np.testing.assert_allclose(model.hidden.coefficients, estimated.coefficients)
    np.testing.assert_allclose(model.effects[0].coefficients, estimated.coefficients)
    assert model.parameters.delta == pytest.approx(estimated.delta, rel=0.05)
    assert diagnosis.gain.after < 1.25 * diagnosis.gain.floor


def test_the_model_that_is_read_back_misses_as_much_as_was_said(rows, diagnosis, model):
    document = diagnosis_document(diagnosis, DiagnosisSettings())
    document = decode(to_json(document).encode(), DiagnosisDocument)
    new = reload(rows, document, model).new
    assert new is not None
    after = np.sqrt(np.mean(new.after["friction"] ** 2 + new.after["load"] ** 2))
    assert after == pytest.approx(diagnosis.gain.after, rel=1e-9)
    before = np.sqrt(np.mean(new.before["friction"] ** 2 + new.before["load"] ** 2))
    assert before == pytest.approx(diagnosis.gain.before, rel=1e-9)
    # without its term, the lag is all missed again
    lacking = np.sqrt(np.mean(new.without(0, "friction") ** 2))
    assert lacking > 3 * np.sqrt(np.mean(new.after["friction"] ** 2))


def test_a_controller_has_the_friction_of_the_model(rows, model):
    """The excess of the gear told, its torque is that of the model to the last digits."""
    _, problem = simulated(rows, "motor", model.about, stated_gravity(model.gravity_about))
    extension = deployable_extension(rows, model, None)
    table = problem.table
    assert model.hidden is not None
    excess = model.hidden.applied(table).temperature - table.motor_temperature
    added = extension.added_friction(
        load=table.load, speed=table.speed, temperature=table.motor_temperature, excess=excess
    )
    gravity = stated_gravity(model.gravity, problem.gravity_form) - problem.gravity
    beyond = model.beyond(problem).friction - problem.friction_by_gravity @ gravity
    np.testing.assert_allclose(added, beyond, atol=1e-9)
    warm = friction_torque(
        model.parameters,
        load=table.load,
        speed=table.speed,
        temperature=table.motor_temperature + excess,
    )
    np.testing.assert_allclose(added + table.friction, warm, atol=1e-9)


def test_parameters_have_the_intervals_of_the_sentence(diagnosis):
    record = diagnosis_document(diagnosis, DiagnosisSettings()).causes[0]
    for name, stated in diagnosis.thermal.estimates.items():
        assert record.parameters[name].estimate == stated.value
        assert record.parameters[name].ci95 == (stated.low, stated.high)
