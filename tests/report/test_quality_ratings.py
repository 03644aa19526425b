"""Ratings of data quality: good, fair and poor, and why."""

from dataclasses import replace

import pytest

from frictioncli.diagnosis.documents.remainder_record import RemainderRecord
from frictioncli.model.document import ParameterEstimate
from frictioncli.report.quality_ratings import (
    FAIR,
    GOOD,
    POOR,
    IngestCounts,
    model_rating,
    pairs_rating,
    parameters_rating,
    quality_ratings,
    reading_rating,
    runs_rating,
    speeds_rating,
    temperature_rating,
    time_rating,
)
from tests.report.diagnosis_documents import cause, diagnosis

CLEAN = IngestCounts(
    rows=10_000, rejected=0, files=8, unusable_files=0, time_known=True, warnings=0
)


@pytest.mark.parametrize(
    ("changed", "level"),
    [
        ({}, GOOD),
        ({"rejected": 10}, GOOD),
        ({"rejected": 11}, FAIR),
        ({"rejected": 500}, FAIR),
        ({"rejected": 501}, POOR),
        ({"unusable_files": 1}, FAIR),
    ],
)
def test_reading_goes_by_the_share_of_rejected_rows(changed, level):
    assert reading_rating(replace(CLEAN, **changed)).level == level


def test_reading_tells_its_numbers():
    told = reading_rating(replace(CLEAN, rejected=11, unusable_files=2)).reason
    assert told == "11 of 10,000 rows in 8 files rejected; 2 files could not be used at all."


def test_an_unknown_clock_is_poor_and_a_warning_fair():
    assert time_rating(CLEAN).level == GOOD
    assert time_rating(replace(CLEAN, warnings=1)).level == FAIR
    poor = time_rating(replace(CLEAN, time_known=False))
    assert (poor.level, "manifest.csv" in poor.reason) == (POOR, True)


def test_runs_pairs_and_speeds(two_runs, without_temperature):
    assert runs_rating(two_runs).level == GOOD
    assert runs_rating(without_temperature).level == FAIR
    assert pairs_rating(two_runs).level == GOOD
    assert pairs_rating(replace(two_runs, pairs=two_runs.pairs[:99])).level == FAIR
    assert pairs_rating(replace(two_runs, pairs=two_runs.pairs[:29])).level == POOR
    assert speeds_rating(two_runs).level == GOOD
    styles = two_runs.styles
    near = replace(two_runs, styles={s: styles[s] for s in (30.0, 43.0, 67.5, 85.0)})
    assert speeds_rating(near).level == FAIR
    one = replace(two_runs, styles={30.0: styles[30.0]})
    assert speeds_rating(one).level == POOR
    assert speeds_rating(one).reason.startswith("30 deg/s; good from 4 speeds")


def test_temperature_goes_by_span_and_by_phases(two_runs, without_temperature):
    good = temperature_rating(two_runs)
    assert good.level == GOOD
    assert "in heating and cooling" in good.reason
    pairs = two_runs.pairs
    heated = replace(two_runs, pairs=pairs[pairs["phase"] != "cool-down"])
    assert temperature_rating(heated).level == FAIR
    assert "Only heating was measured" in temperature_rating(heated).reason
    warm = replace(two_runs, pairs=pairs[pairs["motor_temperature"].between(30.0, 45.0)])
    assert temperature_rating(warm).level == FAIR
    tepid = replace(two_runs, pairs=pairs[pairs["motor_temperature"].between(30.0, 35.0)])
    assert temperature_rating(tepid).level == POOR
    assert "no motor temperature" in temperature_rating(without_temperature).reason
    swept = replace(two_runs, pairs=pairs[pairs["phase"] == "sweep"])
    assert "No heating or cooling" in temperature_rating(swept).reason


def test_parameters(two_runs, without_temperature):
    assert parameters_rating(two_runs).level == GOOD
    wide = ParameterEstimate(estimate=2.0, ci95=(0.9, 3.1), unit="N·m", determined=True)
    model = two_runs.model
    rough = replace(model, parameters=dict(model.parameters) | {"tau_c": wide})
    rating = parameters_rating(replace(two_runs, model=rough))
    assert (rating.level, "but τc to no better than" in rating.reason) == (FAIR, True)
    rating = parameters_rating(without_temperature)
    assert (rating.level, rating.reason) == (POOR, "The data do not determine γ and δ.")


@pytest.mark.parametrize(
    ("verdict", "effects", "level", "word"),
    [
        ("no_evidence", [], GOOD, "No cause"),
        ("named", ["thermal_lag"], FAIR, "lacks thermal lag"),
        ("ambiguous", ["run_in", "drift"], FAIR, "lacks run-in or drift"),
        ("unnamed", [], POOR, "no known effect"),
    ],
)
def test_model_goes_by_the_verdict(two_runs, verdict, effects, level, word):
    document = diagnosis(verdict=verdict, sets=(effects,), rmse=3.0)
    rating = model_rating(two_runs, document)
    assert rating.level == level
    assert word in rating.reason
    assert "3.00 N·m (RMS)" in rating.reason


def test_model_that_leaves_something_on_a_new_run_is_not_good(two_runs):
    left = RemainderRecord(
        basis="new_run",
        rmse=1.4,
        noise_floor=0.7,
        size=1.2,
        axis="time",
        channel="friction",
        axis_size=1.0,
    )
    rating = model_rating(two_runs, diagnosis(verdict="no_evidence", remainder=left))
    assert rating.level == FAIR
    assert (
        "On a new run its error is still 1.40 N·m, where noise alone is 0.700 N·m." in rating.reason
    )


def test_measurement_is_no_fault_of_the_equation(two_runs):
    delay = cause(["torque_delay"], kind="measurement")
    reason = model_rating(two_runs, diagnosis(causes=(delay,))).reason
    assert "Equation (16) does not account for torque delay in the measurement: alone" in reason


def test_every_rating_has_a_reason(two_runs):
    found = quality_ratings(two_runs, CLEAN, None)
    assert len(found) == 8
    assert all(rating.level in (GOOD, FAIR, POOR) for rating in found)
    assert all(rating.reason.endswith(".") for rating in found)
    unread = quality_ratings(two_runs, replace(CLEAN, files=0, time_known=None), None)
    assert len(unread) == 6
