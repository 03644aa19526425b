"""Top of the page: the result in a paragraph, key numbers, what was measured."""

from dataclasses import replace

import numpy as np
from msgspec import structs

from frictioncli.diagnosis.documents.document import GainRecord
from frictioncli.report.figures import FIGURES
from frictioncli.report.page_tables import epsilon_tables, pairs_table
from frictioncli.report.quality_ratings import pairs_rating
from frictioncli.report.summary import (
    corrections_needed,
    key_numbers,
    measurement_text,
    summary_text,
)
from tests.report.diagnosis_documents import cause, diagnosis

GAIN = GainRecord(
    basis="new_run",
    rmse_before=5.0,
    rmse_after=1.0,
    reduction=0.8,
    ci95=(0.7, 0.9),
    noise_floor=0.5,
)
DIAGNOSIS = diagnosis(
    sets=[["thermal_lag"]], gain=GAIN, detectable={"stribeck": 0.5, "drift": None}, rmse=5.2
)


def error(results, run, phase):
    """Equation (21) by hand."""
    own = results.schedule[(results.schedule["run"] == run) & (results.schedule["phase"] == phase)]
    missed = [a - b for a, b in zip(own["friction_predicted"], own["friction_smoothed"])]  # noqa: B905
    return (sum(one * one for one in missed) / len(missed)) ** 0.5


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
    assert "predicts the friction of joint 2 to within 1.13 N·m (RMS)" in text


def test_corrections_that_make_it_worse_are_said_to(two_runs):
    assert "worse" not in summary_text(two_runs)
    table = two_runs.evaluation
    none = (table["criterion"] == "none") & (table["phase"] == "heat-up")
    # one of two runs is enough
    better = table.assign(epsilon=table["epsilon"].mask(none & (table["run"] == "day-2"), 0.01))
    said = summary_text(replace(two_runs, evaluation=better))
    assert " In heating, corrections make the prediction worse." in said


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
    assert "The function does not model thermal lag; with that added" in text
    assert "on day-2, not used for fitting, is 1.00 N·m instead of 5.00 N·m" in text
    unsure = structs.replace(DIAGNOSIS, gain=structs.replace(GAIN, ci95=(-0.1, 0.9)))
    assert summary_text(two_runs, unsure).endswith("The function does not model thermal lag.")
    unsure = diagnosis(verdict="unnamed", sets=[[]], rmse=5.2)
    assert "No known effect is named, and there is structure" in summary_text(two_runs, unsure)
    silent = diagnosis(verdict="no_evidence", sets=[], rmse=5.2)
    assert "No cause was found" in summary_text(two_runs, silent)
    seen = structs.replace(silent, visible=(cause(["drift"], standing="negligible"),))
    assert "No cause is named" in summary_text(two_runs, seen)
    delay = cause(["torque_delay"], kind="measurement")
    logged = diagnosis(causes=(delay,))
    assert summary_text(two_runs, logged).endswith("The measurement adds torque delay.")
    both = diagnosis(causes=(cause(["stribeck"]), delay))
    assert summary_text(two_runs, both).endswith(
        "The function does not model Stribeck friction, and the measurement adds torque delay."
    )


def test_verdict_says_what_is_not_determined(without_temperature):
    assert "do not determine γ and δ" in summary_text(without_temperature)


def test_what_was_measured(two_runs, without_temperature):
    text = measurement_text(two_runs)
    assert "2 runs (day-1 and day-2): 338 pairs" in text
    assert "9 speeds from 2.3 deg/s to 101.2 deg/s" in text
    assert "under loads from −39.8 to 38.6 N·m" in text
    assert "without a motor temperature" in measurement_text(without_temperature)


def test_fewest_corrections_that_suffice(two_runs):
    """The made evaluation has 4/n N·m in heating and 5/n in cooling, n of 2, 3, 6, 14, 25."""
    assert corrections_needed(two_runs).value == "2 in heating, 3 in cooling"
    poor = replace(two_runs, evaluation=two_runs.evaluation.assign(epsilon=9.0))
    assert (
        corrections_needed(poor).value
        == "no number suffices in heating, no number suffices in cooling"
    )
    # 4 % of 17.5 N·m: 4/n <= 0.7, 5/n <= 0.7
    small = replace(two_runs, torques=two_runs.torques.assign(friction_torque=17.5))
    assert corrections_needed(small).value == "6 in heating, 14 in cooling"
    assert "0.7 N·m, 4 % of the mean friction" in corrections_needed(small).context
    exact = replace(two_runs, evaluation=two_runs.evaluation.assign(epsilon=0.5))
    assert corrections_needed(exact).value == "0 in heating, 0 in cooling"
    empty = replace(two_runs, evaluation=two_runs.evaluation[:0])
    assert corrections_needed(empty) is None


def test_key_numbers_have_units_and_what_to_read_them_with(two_runs, without_temperature):
    names = [number.name for number in key_numbers(two_runs, DIAGNOSIS)]
    assert names == [
        "error ε in heating",
        "error ε in cooling",
        "corrections needed",
        "misfit of the fitted function",
        "misfit of the extended model",
    ]
    last = key_numbers(two_runs, DIAGNOSIS)[-1]
    assert last.value == "1.00 N·m"
    assert "on day-2, a run not used for fitting; base model 5.00 N·m" in last.context
    assert [number.name for number in key_numbers(without_temperature, None)] == [names[3]]


def test_what_a_regression_measured_is_not_called_pairs(two_runs):
    count = len(two_runs.pairs)
    assert f"{count} pairs of counter-directed moves" in measurement_text(two_runs)
    regressed = replace(two_runs, model=replace(two_runs.model, separated_by="regression"))
    text = measurement_text(regressed)
    assert f"{count} groups of samples at one speed" in text
    assert "pair" not in text
    assert "pair" not in two_runs.model.table().replace("pair 0.2", "").replace("298 pairs", "")
    assert "over 298 groups; noise: point 0.61, group 0.2" in regressed.model.table()
    for name, caption in [(figure.name, figure.caption(regressed)) for figure in FIGURES]:
        assert "pair" not in caption, name
    assert pairs_table(regressed).title == "Groups per speed and phase"
    assert pairs_rating(regressed).name == "Groups"
