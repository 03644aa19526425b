# ruff: noqa: TID251
"""Measured and simulated torque, and residuals before and after the extension."""

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.patches import Rectangle

from frictioncli.report import style
from frictioncli.report.simulation_figures import gain_figure, simulated_rows, simulation_figure
from tests.report.figure_contents import texts


def test_simulated_torque_is_measured_less_the_misfit(diagnosed, diagnosis):
    rows = simulated_rows(diagnosed, diagnosis).sort_values(["run", "pair", "position"])
    torques = diagnosed.torques.sort_values(["run", "time", "pair", "position"])
    np.testing.assert_allclose(np.sort(rows["forward"]), np.sort(torques["torque_forward"]))
    np.testing.assert_allclose(np.sort(rows["reverse"]), np.sort(torques["torque_reverse"]))
    missed = np.concatenate([one.torque(one.before) for one in (diagnosis.seen, diagnosis.new)])
    shown = np.concatenate(
        [rows[name] - rows[f"{name}_simulated"] for name in ("forward", "reverse")]
    )
    np.testing.assert_allclose(np.sort(shown), np.sort(missed), atol=1e-9)
    with style.style_context():
        figure = simulation_figure(diagnosed, diagnosis=diagnosis)
    shown = texts(figure)
    assert "torque u [N·m]" in shown
    assert "measured − simulated [N·m]" in shown
    assert "time, run after run [h]" in shown
    assert "day-2 (new)" in shown
    first = figure.axes[0].lines[0]
    own = rows[rows["speed"].round(1) == 19.1]
    means = own.groupby(["run", "pair"]).agg(time=("time", "first"), torque=("forward", "mean"))
    np.testing.assert_allclose(first.get_ydata(), means.sort_values("time")["torque"])


def test_gain_shows_the_new_run_and_the_noise_floor(diagnosed, diagnosis):
    with style.style_context():
        figure = gain_figure(
            diagnosed, diagnosis=diagnosis, floor=diagnosis.document.gain.noise_floor
        )
    new = diagnosis.new
    label = next(text for text in texts(figure) if text.startswith("base model"))
    rms = np.sqrt(np.mean(np.square(new.before["friction"]) + np.square(new.before["load"])))
    assert float(re.findall(r"RMS ([\d.]+)", label)[0]) == pytest.approx(rms, rel=5e-3)
    assert "noise floor, 0.700 N·m" in texts(figure)
    left, right = figure.axes
    band = next(patch for patch in left.patches if isinstance(patch, Rectangle))
    assert (band.get_x(), band.get_width()) == pytest.approx((-0.7, 1.4))
    curve = right.lines[0]
    half = np.searchsorted(curve.get_xdata(), 0.5)
    size = np.abs(new.torque(new.before))
    wanted = 100 * np.mean(size > curve.get_xdata()[half])
    assert curve.get_ydata()[half] == pytest.approx(wanted)


def test_a_load_channel_is_no_part_of_the_torque(diagnosed, diagnosis):
    def logged(misfits):
        problem = replace(misfits.problem, has_load_channel=True)
        return replace(misfits, problem=problem)

    both = replace(diagnosis, seen=logged(diagnosis.seen), new=logged(diagnosis.new))
    rms = np.sqrt(np.mean(np.square(both.new.before["friction"])))
    with style.style_context():
        shown = texts(gain_figure(diagnosed, diagnosis=both, floor=0.7))
    label = next(text for text in shown if text.startswith("base model"))
    assert float(re.findall(r"RMS ([\d.]+)", label)[0]) == pytest.approx(rms, rel=5e-3)
    assert "friction's part of torque, measured − simulated [N·m]" in shown
    rows = simulated_rows(diagnosed, both)
    measured = diagnosed.torques["friction_torque"]
    np.testing.assert_allclose(np.sort(rows["forward"]), np.sort(measured))
    np.testing.assert_allclose(rows["reverse"], -rows["forward"])
    np.testing.assert_allclose(rows["reverse_simulated"], -rows["forward_simulated"])
