"""Figures 9 and 10: friction predicted with corrected temperature."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.report.correction_figures import (
    corrected_friction_figure,
    corrections_text,
    predicted_steps,
)
from tests.report.figure_contents import texts


@pytest.mark.parametrize("phase", ["heat-up", "cool-down"])
def test_every_correction_has_its_line_and_value(two_runs, phase):
    figure = corrected_friction_figure(two_runs, phase)
    schedule = two_runs.schedule
    own = schedule[(schedule["run"] == "day-1") & (schedule["phase"] == phase)]
    own = own.sort_values("time")
    tried = own[own["corrected"]]
    marks = [line for line in figure.axes[0].lines if len(set(line.get_xdata())) == 1]
    assert [line.get_xdata()[0] for line in marks] == pytest.approx(list(tried["time"] / 60))
    shown = texts(figure)
    for row in tried.itertuples():
        value = f"{row.temperature_correction:+.1f} °C".replace("-", "−")
        assert ("failed" if row.failed else value) in shown
    parameter = next(line for line in figure.axes[1].lines if line.get_label() == "T = Tm + ΔT")
    drawn = np.round(np.column_stack([parameter.get_xdata(), parameter.get_ydata()]), 9)
    known = np.round(own[["time", "temperature_parameter"]].to_numpy() / [60.0, 1.0], 9)
    assert {tuple(point) for point in known} <= {tuple(point) for point in drawn}
    # a correction is a step at one instant, not a ramp from the pair before
    change = own["temperature_correction"].diff()[own["corrected"]].iloc[1:]
    steps = [np.diff(drawn[drawn[:, 0] == round(at, 9), 1]) for at in tried["time"].iloc[1:] / 60]
    np.testing.assert_allclose(np.ravel(steps), change, atol=1e-8)


def test_predicted_friction_steps_at_corrections(two_runs):
    schedule = two_runs.schedule
    own = schedule[(schedule["run"] == "day-1") & (schedule["phase"] == "cool-down")]
    own = own.sort_values("time")
    group = own[own["speed"] == 19.1]
    time, friction = predicted_steps(own, group, two_runs)
    known = dict(zip(group["time"], group["friction_predicted"], strict=True))
    for at, value in known.items():
        assert np.min(np.abs(friction[time == at] - value)) < 1e-9
    inner = own.loc[own["corrected"], "time"]
    inner = inner[(inner > group["time"].min()) & (inner <= group["time"].max())]
    assert {at for at in time if (time == at).sum() == 2} == set(inner)


def test_the_number_of_corrections_is_explained_by_the_degrees_between_them(two_runs):
    schedule = two_runs.schedule.assign(criterion="first_degree", k=5.0, tmax=3600.0)
    motor = two_runs.pairs.set_index(["run", "pair"])["motor_temperature"]
    own = schedule[(schedule["phase"] == "heat-up") & schedule["corrected"]].sort_values("time")
    passed = [
        abs(float(step))
        for run, rows in own.groupby("run")
        for step in np.diff([motor[run, pair] for pair in rows["pair"]])
    ]
    said = corrections_text(replace(two_runs, schedule=schedule), "heat-up")
    assert f"after every {np.median(passed):.0f} °C of motor temperature (median)." in said
    assert "The paper has 6 at this k and tmax" in said
    other = corrections_text(replace(two_runs, schedule=schedule.assign(k=7.0)), "heat-up")
    assert other in said
    assert "paper" not in other
    unknown = schedule.assign(criterion="uncertainty")
    assert corrections_text(replace(two_runs, schedule=unknown), "heat-up") == ""
