"""Parameters of the model, correlations, and what the data cannot determine."""

from dataclasses import replace

import pytest
from msgspec import structs

from frictioncli.model.document import ParameterEstimate
from frictioncli.report.parameters import (
    correlation_table,
    correlation_text,
    is_published_joint,
    limitations,
    parameter_rows,
)
from tests.report.diagnosis_documents import cause, diagnosis

AMBIGUOUS = cause(["run_in", "drift"], experiment="Rest a day.")
DIAGNOSIS = structs.replace(
    diagnosis(sets=[], detectable={"stribeck": 0.5, "drift": None}, rmse=5.2),
    causes=(AMBIGUOUS,),
)


@pytest.fixture
def correlated(two_runs):
    known = {
        "tau_c": {"tau_c": 1.0, "beta": -0.954, "delta": 0.004},
        "beta": {"tau_c": -0.954, "beta": 1.0, "delta": 0.5},
        "delta": {"tau_c": 0.004, "beta": 0.5, "delta": 1.0},
    }
    return replace(two_runs, model=replace(two_runs.model, correlation=known))


def test_correlations_stand_once(correlated, two_runs):
    table = correlation_table(correlated)
    assert table.header == ("", "τc", "β", "δ")
    assert table.rows == (
        ("τc", "1", "", ""),
        ("β", "−0.95", "1", ""),
        ("δ", "0", "+0.50", "1"),
    )
    assert correlation_table(two_runs) is None
    assert correlation_text(-0.001) == "0"


def test_limitations_are_stated(correlated, without_temperature):
    vague = ParameterEstimate(estimate=2.0, ci95=(0.5, 3.5), unit="N·m", determined=True)
    parameters = dict(correlated.model.parameters) | {"beta": vague}
    sentences = limitations(
        replace(correlated, model=replace(correlated.model, parameters=parameters)),
        DIAGNOSIS,
    )
    assert sentences == [
        "β is known only roughly: 0.500 to 3.50 N·m.",
        "τc and β are not determined separately (correlation −0.95): they compensate each other.",
        "These data cannot distinguish run-in and drift. Rest a day.",
        "Effects that these data cannot show: drift.",
    ]
    alone = limitations(without_temperature, None)
    assert alone[0] == ("γ is not determined: the log has no temperature; merged into beta.")
    assert "not been diagnosed" in alone[-1]


def test_parameters_are_those_of_the_model(two_runs):
    rows = parameter_rows(two_runs)
    assert [row.estimate for row in rows] == ["10.57", "0.001400", "3.480", "15.66", "0.05600"]
    assert rows[0].interval == "10.0 to 11.1"
    assert [row.published for row in rows] == ["10.57", "0.0014", "3.48", "15.66", "0.056"]
    assert [row.remark for row in rows] == [""] * 5


def test_published_values_stand_only_beside_the_published_joint(two_runs, current_log):
    assert is_published_joint(two_runs, "sample_logs/KR 10 R900/day-1.csv")
    assert not is_published_joint(two_runs, "sample_logs/ur5/day-1.csv")
    assert not is_published_joint(current_log, "kr10")
