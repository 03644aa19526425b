"""The table keeps its tolerance when someone else interpolates it."""

import io

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import RegularGridInterpolator

from frictioncli.deployment.export import export
from frictioncli.deployment.settings import ExportSettings
from frictioncli.errors import OptionError
from frictioncli.model.friction import friction_torque
from tests.deployment.joints import joint

COLUMNS = ["speed [deg/s]", "temperature [°C]", "load [N·m]", "friction [N·m]"]


def table(deployed, **settings):
    return export(deployed, ExportSettings(to="csv", **settings))


def interpolator(text):
    rows = pd.read_csv(io.StringIO(text), comment="#")
    assert list(rows.columns) == COLUMNS
    axes = [np.unique(rows[name]) for name in COLUMNS[:3]]
    values = rows[COLUMNS[3]].to_numpy().reshape([len(axis) for axis in axes])
    return axes, RegularGridInterpolator(axes, values)


@pytest.mark.parametrize("tolerance", [2.0, 0.1, 0.05])
def test_scipy_s_interpolation_of_the_file_keeps_the_tolerance(tolerance):
    """At random points, and the error that is told is nearly reached."""
    deployed = joint()
    done = table(deployed, tolerance=tolerance)
    _, at = interpolator(done.text)
    generator = np.random.default_rng(0)
    points = generator.uniform([2.3, 20.0, 0.0], [101.2, 65.0, 95.0], size=(100_000, 3))
    speed, warm, load = points.T
    wanted = friction_torque(deployed.base, load=load, speed=speed, temperature=warm)
    found = float(np.max(np.abs(at(points) - wanted)))
    told = float(done.notes[0].split("at most ")[1].split()[0])
    assert 0.5 * told < found <= told * 1.02 <= tolerance * 1.02


def test_it_covers_the_data_and_is_no_finer_than_needed():
    axes, _ = interpolator(table(joint(), tolerance=0.5).text)
    assert [(axis[0], axis[-1]) for axis in axes] == [(2.3, 101.2), (20.0, 65.0), (0.0, 95.0)]
    finer, _ = interpolator(table(joint(), tolerance=0.05).text)
    # linear interpolation: a tenth of the error takes about three times the knots
    for coarse, fine in zip(axes, finer, strict=True):
        assert 2 * len(coarse) < len(fine) < 5 * len(coarse)


def test_by_default_a_thousandth_of_the_greatest_friction():
    greatest = friction_torque(joint().base, load=95.0, speed=101.2, temperature=20.0)
    assert f"({greatest / 1000:.3g} allowed)" in table(joint()).notes[0]


def test_without_a_temperature_two_knots_do():
    axes, _ = interpolator(table(joint(gamma=0.0, delta=0.0)).text)
    assert len(axes[1]) == 2


def test_a_table_that_nobody_can_hold_is_refused():
    with pytest.raises(OptionError, match="50000 rows"):
        table(joint(), tolerance=1e-6)
