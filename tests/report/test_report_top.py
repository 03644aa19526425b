"""The top of the page: verdict, formula, figures that matter; what the data do not tell."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from frictioncli.diagnosis.documents.document import GainRecord
from frictioncli.model.document import ParameterEstimate
from frictioncli.report.formula import formula_symbols, friction_formula, unit_markup
from frictioncli.report.page_tables import epsilon_tables
from frictioncli.report.parameters import correlation_table, correlation_text, limitations
from frictioncli.report.results import read_results
from frictioncli.report.summary import (
    corrections_needed,
    key_numbers,
    measurement_text,
    summary_text,
)
from tests.report.planted import cause, diagnosis

GAIN = GainRecord(
    basis="new_run",
    rmse_before=5.0,
    rmse_after=1.0,
    reduction=0.8,
    ci95=(0.7, 0.9),
    noise_floor=0.5,
)
OPEN = cause(["run_in", "drift"], experiment="Rest a day.")
DIAGNOSIS = diagnosis(
    sets=[["thermal_lag"]], gain=GAIN, detectable={"stribeck": 0.5, "drift": None}, rmse=5.2
)


def error(results, run, phase):
    """Equation (21) by hand."""
    own = results.schedule[(results.schedule["run"] == run) & (results.schedule["phase"] == phase)]
    missed = [a - b for a, b in zip(own["friction_predicted"], own["friction_smoothed"])]  # noqa: B905
    return (sum(one * one for one in missed) / len(missed)) ** 0.5


def test_formula_has_the_numbers_with_their_units(two_runs, without_temperature):
    assert friction_formula(two_runs).striptags() == (
        "τ = 10.57 N·m + 0.001400/(N·m) · L² + (3.480 N·m/(deg/s)½ + 15.66 N·m/(deg/s)½"
        " · e−0.05600/°C · T) · √v"
    )
    assert friction_formula(without_temperature).striptags() == (
        "τ = 10.57 N·m + 0.001400/(N·m) · L² + 6.500 N·m/(deg/s)½ · √v"
    )
    assert "T: motor temperature Tm in °C" in formula_symbols(two_runs)
    assert "T:" not in formula_symbols(without_temperature)
    assert unit_markup("<b>^2") == "&lt;b&gt;²"


def test_verdict_gives_error_corrections_and_what_they_bring(two_runs):
    text = summary_text(two_runs)
    heating = sorted(error(two_runs, run, "heat-up") for run in two_runs.runs)
    cooling = sorted(error(two_runs, run, "cool-down") for run in two_runs.runs)
    # both made runs have the same zone temperatures
    assert np.ptp(heating) < 1e-9
    assert f"{heating[0]:.3g} N·m in heating (2 corrections)" in text
    assert f"{cooling[0]:.3g} N·m in cooling (5 corrections)" in text
    # the made evaluation has 4 and 5 without any
    assert "against 4.00 N·m in heating and 5.00 N·m in cooling without correction" in text
    assert "gives the friction of joint 2 to 1.13 N·m (RMS)" in text


def test_errors_of_two_models_are_not_set_against_each_other(two_runs):
    text = summary_text(replace(two_runs, simulated_extended=True))
    assert "extended model" in text
    assert "against" not in text


def test_what_was_evaluated_with_the_extended_model_says_so(two_runs):
    extended = replace(two_runs, evaluation_settings={"extended": True})
    assert corrections_needed(extended).context.endswith(", extended model")
    assert epsilon_tables(extended)[0].title.startswith("day-1, extended model: error")
    never = replace(two_runs, schedule=two_runs.schedule.assign(corrected=False, failed=False))
    assert "(0 corrections)" in summary_text(never)
    assert "against" not in summary_text(never)


def test_verdict_tells_the_causes_and_their_worth(two_runs):
    text = summary_text(two_runs, DIAGNOSIS)
    assert "The function lacks thermal lag; extended by that" in text
    assert "on day-2, which it has not seen, by 1.00 N·m instead of 5.00 N·m" in text
    unsure = structs.replace(DIAGNOSIS, gain=structs.replace(GAIN, ci95=(-0.1, 0.9)))
    assert summary_text(two_runs, unsure).endswith("The function lacks thermal lag.")
    unsure = diagnosis(verdict="unnamed", sets=[[]], rmse=5.2)
    assert "No known effect is named, and structure is left" in summary_text(two_runs, unsure)
    silent = diagnosis(verdict="no_evidence", sets=[], rmse=5.2)
    assert "No cause was found" in summary_text(two_runs, silent)


def test_verdict_says_what_is_not_determined(without_temperature):
    assert "do not determine γ and δ" in summary_text(without_temperature)


def test_what_was_measured(two_runs, without_temperature):
    text = measurement_text(two_runs)
    assert "2 runs (day-1 and day-2): 338 pairs" in text
    assert "9 speeds from 2.3 deg/s to 101.2 deg/s" in text
    assert "under loads from −39.8 to 38.6 N·m" in text
    assert "without a motor temperature" in measurement_text(without_temperature)


def test_fewest_corrections_that_suffice(two_runs, tmp_path, write_work):
    """The made evaluation has 4/n N·m in heating and 5/n in cooling, n of 2, 3, 6, 14, 25."""
    assert corrections_needed(two_runs).value == "2 in heating, 3 in cooling"
    poor = replace(two_runs, evaluation=two_runs.evaluation.assign(epsilon=9.0))
    assert corrections_needed(poor).value == "never enough in heating, never enough in cooling"
    current = read_results(write_work(tmp_path, runs=("day-1",), unit="A")).joints[0]
    # in another unit, a quarter of the error without correction: 4/n <= 1, 5/n <= 1.25
    assert corrections_needed(current).value == "6 in heating, 6 in cooling"
    assert "a quarter" in corrections_needed(current).context
    empty = replace(two_runs, evaluation=two_runs.evaluation[:0])
    assert corrections_needed(empty) is None


def test_key_figures_have_units_and_what_to_read_them_with(two_runs, without_temperature):
    names = [figure.name for figure in key_numbers(two_runs, DIAGNOSIS)]
    assert names == [
        "error ε in heating",
        "error ε in cooling",
        "corrections needed",
        "misfit of the fitted function",
        "misfit of the extended model",
    ]
    last = key_numbers(two_runs, DIAGNOSIS)[-1]
    assert last.value == "1.00 N·m"
    assert "on day-2, a run it has not seen; base model 5.00 N·m" in last.context
    assert [figure.name for figure in key_numbers(without_temperature, None)] == [names[3]]


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


def test_unknowns_are_told(correlated, without_temperature):
    vague = ParameterEstimate(estimate=2.0, ci95=(0.5, 3.5), unit="N·m", determined=True)
    parameters = dict(correlated.model.parameters) | {"beta": vague}
    told = limitations(
        replace(correlated, model=replace(correlated.model, parameters=parameters)),
        structs.replace(DIAGNOSIS, causes=(OPEN,)),
    )
    assert told == [
        "β is known only roughly: 0.500 to 3.50 N·m.",
        "τc and β are told only together (correlation −0.95): one may be off if the other is off"
        " with it.",
        "Which of run in and drift is at work: these data cannot tell them apart. Rest a day.",
        "Whether there is drift: these data cannot show it.",
    ]
    alone = limitations(without_temperature, None)
    assert alone[0] == ("γ is not determined: the log has no temperature; merged into beta.")
    assert "has not been judged" in alone[-1]
