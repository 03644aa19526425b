"""Real logs against figures of scripts that share no code with the program."""

from pathlib import Path

import numpy as np
import pytest

from frictioncli import tables
from frictioncli.errors import NotEnoughData
from frictioncli.logs.settings import IngestSettings
from frictioncli.model.document import read_models
from frictioncli.pairs.settings import SeparationSettings
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.separate import separate
from tests.logs.logs import REAL

REGRESSION = SeparationSettings(by="regression")

pytestmark = pytest.mark.skipif(
    not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}"
)


def friction_of(work, speed):
    """Friction without load of the fitted model at its own temperature."""
    fit(work)
    model = max(read_models(work / "model.json"), key=lambda one: one.n_pairs).friction
    return model.tau_c + model.beta * np.sqrt(speed)


def test_sines_of_a_ur10e(tmp_path):
    """Least squares of all samples by hand: 0.42 + 0.40 sqrt(v) A."""
    columns = Path("time=1:s,position=2:rad,velocity=8:rad/s,torque=14:A,joint=1")
    ingest([REAL / "ur10e-j1"], tmp_path, IngestSettings(map_file=columns))
    assert "by regression of" in str(separate(tmp_path))
    for speed in (10.0, 25.0, 40.0, 55.0):
        assert friction_of(tmp_path, speed) == pytest.approx(0.42 + 0.40 * np.sqrt(speed), rel=0.03)
    (found,) = tables.facts(tmp_path / "torques.parquet")["regression"].values()
    assert found["rmse"] < 0.118
    assert found["held_out"] < 1.15 * found["rmse"]


def test_the_staircase_of_a_bench_motor(tmp_path):
    """Means of the holds by hand: 0.0771 + 0.00324 sqrt(v) N·m."""
    ingest([REAL / "damiao-5"], tmp_path)
    separate(tmp_path, REGRESSION)
    for speed in (60.0, 200.0, 450.0):
        by_hand = 0.0771 + 0.00324 * np.sqrt(speed)
        assert friction_of(tmp_path, speed) == pytest.approx(by_hand, rel=0.05)


def test_a_load_channel_of_an_xarm(tmp_path):
    """Half sums of the current over the load channel by hand: 0.174 A/(N·m)."""
    folder = REAL / "xarm6-j3"
    ingest([folder], tmp_path, IngestSettings(map_file=folder / "map.toml"))
    separate(tmp_path, REGRESSION)
    (found,) = tables.facts(tmp_path / "torques.parquet")["regression"].values()
    assert found["parameters"]["load"]["estimate"] == pytest.approx(0.174, rel=0.02)


def test_joints_that_all_move_are_refused(tmp_path):
    ingest([REAL / "nist-ur5"], tmp_path)
    with pytest.raises(NotEnoughData, match="give --urdf"):
        separate(tmp_path)
