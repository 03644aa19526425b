"""Residuals: measured minus modelled friction torque."""

from dataclasses import replace

import numpy as np

from frictioncli.report.residual_figure import residuals
from tests.report.figure_contents import FIGURE_SPECS, at_zero_load


def test_residuals_vanish_where_the_model_holds(two_runs):
    torques = two_runs.torques
    exact = at_zero_load(torques["speed"], torques["motor_temperature"])
    exact = exact + 0.0014 * torques["load_torque"] ** 2
    ideal = replace(two_runs, torques=torques.assign(friction_torque=exact))
    np.testing.assert_allclose(residuals(ideal)["residual"], 0.0, atol=1e-9)
    measured = residuals(two_runs)
    np.testing.assert_allclose(
        measured["residual"], (torques["friction_torque"] - exact).to_numpy(), atol=1e-9
    )


def test_residuals_need_the_temperature_of_the_model(two_runs):
    unknown = replace(two_runs, pairs=two_runs.pairs.assign(temperature=np.nan))
    assert "motor temperature Tm, which no pair has" in FIGURE_SPECS["residuals"].missing(unknown)
