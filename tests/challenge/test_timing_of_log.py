"""How late planted torque is, from what the diagnosis of the log says of its delay."""

import pytest

from frictioncli.challenge.planting import LogTiming
from frictioncli.challenge.subject import timing_of
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from tests.report.diagnosis_documents import cause, diagnosis

PARAMETERS = {"delay": ParameterRecord(estimate=0.012, ci95=(0.01, 0.014), unit="s")}


@pytest.mark.parametrize(
    ("effects", "standing", "delay"),
    [
        (["torque_delay"], "named", 0.012),
        (["torque_delay", "torque_filter"], "named", 0.012),
        (["torque_delay"], "visible", 0.012),
        (["torque_delay"], "undetermined", 0.0),
        (["torque_delay", "inertia"], "named", 0.0),
        ([], "visible", 0.0),
    ],
)
def test_planted_torque_is_as_late_as_the_log(effects, standing, delay):
    known = cause(effects, kind="measurement", standing=standing, parameters=PARAMETERS)
    assert timing_of(diagnosis(causes=(known,))) == LogTiming(delay=delay)
