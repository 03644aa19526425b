"""A search that is repeated about the temperature of the gear: which estimate stays."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.diagnosis.thermal import lag_search
from frictioncli.effects import EFFECTS, MEASUREMENT_EFFECTS
from frictioncli.effects.sensor_lag import EFFECT as SENSOR_LAG
from frictioncli.workfiles import TORQUES
from tests.diagnosis.thermal_joint import Network, torques

MEASURED, FIRST = "measured temperature", "first estimate"
SECOND, THIRD = "beside the causes of the first", "beside those of the second"


def found(*names):
    causes = [
        SimpleNamespace(
            fit=SimpleNamespace(effect=SimpleNamespace(name=name)), visible_interval=(1.0, 2.0)
        )
        for name in names
    ]
    return SimpleNamespace(causes=causes)


@pytest.fixture
def searched(monkeypatch):
    """Return the causes and the estimate that a search ends with, from what it finds about each."""

    def about(causes):
        def estimated(problem, new, accepted=(), measurement=()):
            names = {one.effect.name for one in accepted}
            of = THIRD if "stribeck" in names else SECOND if accepted else FIRST
            return SimpleNamespace(problem=of, estimate=None)

        monkeypatch.setattr(lag_search, "_is_far_off", lambda problem: True)
        monkeypatch.setattr(lag_search, "_explains_most", lambda estimate: True)
        monkeypatch.setattr(lag_search, "refine_thermal", estimated)
        monkeypatch.setattr(lag_search, "_as_refined", lambda result, refined: result)
        monkeypatch.setattr(lag_search, "_left_of_lag", lambda found, measured: 1.0)
        result, lag = lag_search.search_with_lag(
            MEASURED, None, EFFECTS, lambda problem, effects: found(*causes[problem])
        )
        return [cause.fit.effect.name for cause in result.causes], lag.problem

    return about


def test_the_second_estimate_is_beside_the_causes_of_the_first(searched):
    both = ("thermal_lag", "step_change")
    assert searched({FIRST: both, SECOND: both}) == (list(both), SECOND)


def test_other_causes_about_the_second_estimate_ask_for_a_third(searched):
    step, stribeck = ("thermal_lag", "step_change"), ("thermal_lag", "stribeck")
    found = searched({FIRST: step, SECOND: stribeck, THIRD: stribeck})
    assert found == (list(stribeck), THIRD)


def test_a_third_estimate_about_which_the_lag_is_impossible_is_not_taken(searched):
    step, stribeck = ("thermal_lag", "step_change"), ("thermal_lag", "stribeck")
    found = searched({FIRST: step, SECOND: stribeck, THIRD: ("drift",)})
    assert found == (list(stribeck), SECOND)


def test_an_estimate_about_which_the_lag_is_impossible_is_not_taken(searched):
    """A drift that was fitted beside the lag took it the wrong way."""
    both = ("thermal_lag", "drift")
    assert searched({FIRST: both, SECOND: ("drift", "step_change")}) == (list(both), FIRST)


def test_a_lag_that_is_found_alone_needs_no_second_estimate(searched):
    assert searched({FIRST: ("thermal_lag",)}) == (["thermal_lag"], FIRST)


@pytest.mark.long
def test_a_gear_that_leads_the_motor_may_be_a_sensor_that_lags():
    """Friction warms the gear more than the motor: friction is lower while heating, as with a
    sensor that lags. The sensor takes so much of it that less than the margin is surely left.
    """
    joint, _ = torques(Network(motor_heat=0.2, motor_gear=20.0, gear=2500.0))
    diagnosis = diagnose_joint(joint, "motor", "N·m", DiagnosisSettings(margin=0.4))
    assert [cause.effects for cause in diagnosis.causes] == [("thermal_lag", "sensor_lag")]
    assert diagnosis.verdict == "ambiguous"
    assert sum(diagnosis.causes[0].probabilities.values()) == pytest.approx(1.0)
    assert diagnosis.thermal is not None
    # noise of a bin, of a pair, and the drift
    assert diagnosis.gain.after < 1.1 * (0.25**2 + 0.125**2 + 0.1**2 + 0.25**2) ** 0.5


@pytest.mark.parametrize("unlogged", [0.0, 9000.0])
def test_a_lag_is_given_up_where_what_warmed_the_gear_of_the_held_out_run_is_not_logged(unlogged):
    """It would predict that run from a gear as cold as the motor; nothing else takes its place."""
    network = Network(motor_heat=0.3)
    joint, _ = torques(network, highest=45.0, unlogged=unlogged)
    diagnosis = diagnose_joint(joint, "motor", "N·m", DiagnosisSettings())
    assert [one.effects for one in diagnosis.causes] == ([] if unlogged else [("thermal_lag",)])
    if unlogged:
        (lag,) = (one for one in diagnosis.visible if one.fit.effect.name == "thermal_lag")
        assert "misfit on the held-out run" in lag.reason


@pytest.mark.long
def test_a_drift_does_not_hide_a_lag_of_many_degrees(sample_run, tmp_path):
    """Beside the drift alone the lag would ask for more than is physically possible.

    On a single day friction that recovers in the rests of the cooling phase may look like a drift.
    """
    torques = tables.read(sample_run(tmp_path / "work") / TORQUES, schemas.TORQUES)
    torques = torques[torques["run"] == "day1"].copy()
    torques["friction_torque"] += torques["time"] / 3600.0
    diagnosis = diagnose_joint(torques, "motor", "N·m", DiagnosisSettings())
    lag, drift = diagnosis.causes
    assert lag.effects == ("thermal_lag",)
    assert drift.fit.effect.name == "drift"
    assert set(drift.effects) <= {"drift", "rest_recovery"}
    assert drift.fit.coefficients == pytest.approx([1.0], abs=0.25)
    assert diagnosis.gain.after < 1.5 * diagnosis.floor


def lags(interval=None, late=60.0):
    """Return a search that may find a lag of so much, and the lag of a sensor beside the base."""
    result = found() if interval is None else found("thermal_lag")
    for cause in result.causes:
        cause.visible_interval, cause.visible = interval, sum(interval) / 2
    fit = SimpleNamespace(effect=SENSOR_LAG, coefficients=[late], covariance=np.array([[100.0]]))
    result.measurement = [SimpleNamespace(fit=fit)]
    return result


@pytest.mark.parametrize(
    ("beside", "without", "estimate", "expected"),
    [
        (lags((0.5, 0.7)), None, FIRST, "beside"),
        (lags((0.1, 0.3)), lags((0.5, 0.7)), FIRST, "without"),
        (lags((0.1, 0.3)), lags((0.15, 0.3)), FIRST, "beside"),
        (lags((0.1, 0.3)), lags((0.5, 0.7)), None, "beside"),
        (lags(), None, FIRST, "beside"),
        (lags(late=135.0), None, FIRST, "beside"),
        (lags(late=150.0), lags((0.5, 0.7)), FIRST, "without"),
        (lags(late=150.0), lags((0.1, 0.3)), FIRST, "beside"),
    ],
    ids=[
        "clear beside the sensor",
        "clear without it",
        "clear never",
        "no hidden temperature",
        "none beside the sensor",
        "none beside one that may be a sensor",
        "none beside one that is too slow",
        "too slow, and none without it",
    ],
)
def test_the_lag_of_a_sensor_is_left_out_only_where_it_hides_one_of_the_gear(
    monkeypatch, beside, without, estimate, expected
):
    def searched(problem, effects, search, refine, margin):
        measurement = search()["measurement"]
        if "sensor_lag" in [one.name for one in measurement]:
            return beside, "own"
        assert without is not None, "searched again without need"
        return without, estimate

    monkeypatch.setattr(lag_search, "_searched", searched)
    monkeypatch.setattr(lag_search, "_lag_or_sensor", lambda cause, share: "the set")
    monkeypatch.setattr(
        lag_search, "_left_of_lag", lambda found, measured: found.causes[0].visible_interval[0]
    )
    monkeypatch.setattr(lag_search, "replace", lambda one, **changed: SimpleNamespace(**changed))

    def search(measurement=MEASUREMENT_EFFECTS):
        return {"measurement": measurement}

    result, lag = lag_search.search_with_lag(MEASURED, None, EFFECTS, search, 0.2)
    if expected == "beside":
        assert (result, lag) == (beside, "own")
    else:
        assert (result.causes, lag) == (("the set",), FIRST)


@pytest.mark.parametrize(
    ("interval", "expected"), [((0.1, 0.3), 0.5), ((0.0, 0.05), 0.5), ((0.4, 0.6), 0.95)]
)
def test_the_share_of_the_gear_is_that_with_which_it_is_worth_a_name(interval, expected):
    assert lag_search._share_of_lag(lags(interval), 0.2) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(("late", "expected"), [(60.0, 0.5), (130.0, 0.8413), (190.0, 0.95)])
def test_a_sensor_that_lags_by_minutes_is_more_probably_the_gear(late, expected):
    """With an error of 10 s; up to 120 s a sensor in a winding may lag."""
    assert lag_search._share_beyond(lags(late=late)) == pytest.approx(expected, abs=1e-4)
