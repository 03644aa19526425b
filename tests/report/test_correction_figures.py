"""Figures 9 and 10: friction predicted with corrected temperature."""

import numpy as np
import pytest

from frictioncli.report.correction_figures import corrected_friction_figure
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
    np.testing.assert_allclose(parameter.get_ydata(), own["temperature_parameter"])
