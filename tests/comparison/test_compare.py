"""Whole comparisons of joints whose change is known."""

import msgspec
import numpy as np
import pytest

from frictioncli.comparison.compare import compare_runs
from frictioncli.comparison.from_comparison import comparison_document
from frictioncli.comparison.run_history import ComparedFolder, run_history_of
from frictioncli.comparison.settings import ComparisonSettings, Threshold, threshold_of
from frictioncli.comparison.text import comparison_text
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.equation_16 import DAILY_TRUTH, daily_torques, friction
from tests.studies.wear_world import Life, torques_of


def compared(table, **settings):
    first = table[table["run"] == table["run"].min()]
    model = fit_joint(first, {}, FitSettings())
    folder = ComparedFolder(name="joint", torques=table, model=model, started_at={}, ambient={})
    return compare_runs(run_history_of([folder]), ComparisonSettings(**settings))


@pytest.fixture(scope="module")
def worn():
    table = daily_torques(8, share=np.linspace(0, 0.08, 8), day_to_day=0.1, seed=5)
    return compared(table, fail_above=Threshold(3.0, "%"))


def test_wear_is_found_with_its_size(worn):
    # 8 % of the first run's friction, stated against the mean of all, which have 4 % more
    assert worn.trend.low < 8 / 1.04 < worn.trend.high
    assert worn.trend.high - worn.trend.low < 4
    assert worn.verdict == "changed"
    assert worn.exceeded
    assert worn.causes[0].effects[0] == "drift"


def test_wear_shows_at_every_condition_as_its_share_of_the_friction_there(worn):
    assert {one.temperature for one in worn.conditions} == {20.0, 40.0, 60.0}
    for one in worn.conditions:
        truth = float(
            friction(DAILY_TRUTH, load=one.load, speed=one.speed, temperature=one.temperature)
        )
        assert one.change.low < 8 / 1.04 < one.change.high
        if one.temperature < 50:  # measured up to 48 °C
            assert one.friction == pytest.approx(1.04 * truth, rel=0.02)
        assert one.extrapolated == (one.temperature != 40.0)


def test_the_document_says_the_same_in_both_units(worn):
    document = msgspec.to_builtins(comparison_document(worn))
    trend = document["trend"]
    assert trend["change"] == pytest.approx(
        trend["percent"]["estimate"] * document["mean_friction"]["estimate"] / 100
    )
    assert trend["per_run"]["estimate"] == pytest.approx(trend["percent"]["estimate"] / 7)
    assert trend["per_1000_h"] is None  # without dates
    assert document["threshold"] == {"value": 3.0, "unit": "%", "exceeded": True}
    assert [run["run"] for run in document["runs"]] == [f"d{n:02d}" for n in range(1, 9)]


def test_the_text_says_what_and_how_sure(worn):
    text = comparison_text(worn)
    assert "joint 2, 8 runs" in text
    assert "changed" in text.splitlines()[0]
    assert "looks like drift" in text
    assert "threshold 3 %: a change above it was found" in text


def test_an_unchanged_joint_gives_no_finding():
    found = compared(daily_torques(8, day_to_day=0.1, seed=6), fail_above=Threshold(1.0, "%"))
    assert found.trend.low < 0 < found.trend.high
    assert not found.causes
    assert not found.exceeded


def test_a_threshold_in_torque_is_one_of_the_mean_friction():
    found = compared(daily_torques(3, seed=7), fail_above=Threshold(2.0, "torque"))
    assert found.margin == pytest.approx(200 / found.mean_friction)


def test_two_runs_are_weak_and_do_not_claim_a_small_change():
    found = compared(daily_torques(2, share=[0, 0.03], seed=8))
    assert found.weak
    assert found.last_run is None
    assert found.verdict == "undetermined"
    assert "weak:" in comparison_text(found)


def test_two_runs_show_what_no_day_makes():
    found = compared(daily_torques(2, share=[0, 0.4], seed=8))
    assert found.verdict == "changed"
    assert set(found.causes[0].effects) == {"drift", "step_change"}


def test_all_torques_greater_by_a_share_are_the_scale_of_the_log():
    found = compared(daily_torques(6, logged=np.linspace(0, 0.1, 6), seed=9))
    assert found.causes[0].effects == ("torque_constant",)
    assert found.load.low < 100 * 0.1 / 1.05 < found.load.high


def test_runs_apart_in_temperature_are_refused():
    cold, hot = np.linspace(15, 20, 8), np.linspace(40, 45, 8)
    with pytest.raises(NotEnoughData, match=r"d02: measured at 40 to 45 °C, where no other run"):
        compared(daily_torques(3, warmth=[cold, hot, cold]))


def test_a_run_of_two_pairs_is_refused():
    table = daily_torques(3)
    short = (table["run"] == "d02") & (table["pair"] > 1)
    with pytest.raises(NotEnoughData, match="d02: 2 pairs of"):
        compared(table[~short])


@pytest.mark.parametrize(
    ("text", "threshold"),
    [
        ("3%", Threshold(3.0, "%")),
        (" .5 % ", Threshold(0.5, "%")),
        ("1.5", Threshold(1.5, "torque")),
    ],
)
def test_thresholds_are_a_share_or_a_torque(text, threshold):
    assert threshold_of(text) == threshold


@pytest.mark.parametrize("text", ["", "x", "-1", "3 N·m", "1e3", "nan"])
def test_other_thresholds_are_refused(text):
    with pytest.raises(OptionError, match="--fail-above"):
        threshold_of(text)


def test_a_joint_of_three_zones_is_not_blamed_for_the_weather():
    """Days of 10 to 35 °C move the friction of the simulated joint by a tenth and more."""
    found = compared(torques_of(Life(kind="unchanged", runs=5, seed=77)))
    assert np.ptp(found.history.ambient) > 8
    assert found.trend.low < 0 < found.trend.high
    assert found.verdict != "changed"
