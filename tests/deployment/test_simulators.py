"""URDF and MJCF load in the real simulators and give there the friction that was promised."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from frictioncli.deployment.export import export
from frictioncli.deployment.operating_conditions import operating_conditions
from frictioncli.deployment.settings import ExportSettings
from frictioncli.deployment.simplified_friction import simplified_friction
from frictioncli.errors import OptionError
from frictioncli.model.friction import PUBLISHED, friction_torque
from tests.deployment.joints import joint

SPEEDS = np.array([2.3, 10.0, 33.0, 67.5, 101.2])
"""[deg/s]"""
AT = {"temperature": 35.0, "load": 20.0}


def promised(speed, deployed=None):
    """The straight line by another route: numpy's polynomial fit in deg/s, at 35 °C and 20 N·m."""
    grid = np.linspace(2.3, 101.2, 400)
    law = friction_torque(PUBLISHED, speed=grid, **AT)
    return np.polynomial.Polynomial.fit(grid, law, 1)(speed)


@pytest.fixture
def pendulum(tmp_path):
    """A MuJoCo model of 5 kg·m² without gravity that includes the file."""
    mujoco = pytest.importorskip("mujoco")
    done = export(joint(), ExportSettings(to="mjcf", **AT))
    (tmp_path / done.name).write_text(done.text, encoding="utf-8")
    (tmp_path / "robot.xml").write_text(
        f'<mujoco><include file="{done.name}"/><option gravity="0 0 0" timestep="0.001"/>'
        '<worldbody><body><joint name="j2" class="friction_joint2" axis="0 0 1"/>'
        '<inertial pos="0 0 0" mass="5" diaginertia="5 5 5"/></body></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    return mujoco, model, mujoco.MjData(model)


def test_mujoco_s_inverse_dynamics_need_the_friction_promised(pendulum):
    mujoco, model, data = pendulum
    for sign in (1, -1):
        for speed, wanted in zip(SPEEDS, promised(SPEEDS), strict=True):
            data.qvel[0], data.qacc[0] = sign * np.radians(speed), 0.0
            mujoco.mj_inverse(model, data)
            assert data.qfrc_inverse[0] == pytest.approx(sign * wanted, rel=1e-4)
    assert model.dof_armature[0] == 0.0


def test_the_polynomial_of_mujoco_4_is_nearer_to_the_law():
    mujoco = pytest.importorskip("mujoco", minversion="4.0")
    done = export(joint(), ExportSettings(to="mjcf", **AT))
    (note,) = (note for note in done.notes if note.startswith("MuJoCo 4"))
    attributes = " ".join(re.findall(r'\w+="[^"]*"', note))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><body><joint axis="0 0 1" {attributes}/>'
        '<inertial pos="0 0 0" mass="5" diaginertia="5 5 5"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    speeds = np.linspace(2.3, 101.2, 400)
    missed = []
    for speed in speeds:
        data.qvel[0], data.qacc[0] = np.radians(speed), 0.0
        mujoco.mj_inverse(model, data)
        law = float(friction_torque(PUBLISHED, speed=speed, **AT))
        missed.append(data.qfrc_inverse[0] - law)
    rms = np.sqrt(np.mean(np.square(missed)))
    stated = float(re.search(r"loses ([\d.]+) N·m", note)[1])
    assert rms == pytest.approx(stated, rel=0.01)
    assert rms < 0.3 * np.sqrt(
        np.mean(np.square(promised(speeds) - friction_torque(PUBLISHED, speed=speeds, **AT)))
    )


@pytest.mark.parametrize("speed", [10.0, 67.5])
def test_mujoco_keeps_a_speed_that_a_motor_of_that_torque_drives(pendulum, speed):
    """Two seconds: from 20 % below, the joint comes to the speed whose friction the torque is."""
    mujoco, model, data = pendulum
    data.qvel[0] = 0.8 * np.radians(speed)
    data.qfrc_applied[0] = promised(speed)
    while data.time < 2.0:
        mujoco.mj_step(model, data)
    assert np.degrees(data.qvel[0]) == pytest.approx(speed, rel=1e-3)


def test_the_mjcf_file_loads_alone(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    mujoco.MjModel.from_xml_string(export(joint(), ExportSettings(to="mjcf")).text)


def test_pinocchio_reads_the_friction_promised(tmp_path):
    pinocchio = pytest.importorskip("pinocchio")
    done = export(joint(), ExportSettings(to="urdf", **AT))
    path = tmp_path / done.name
    path.write_text(done.text, encoding="utf-8")
    model = pinocchio.buildModelFromUrdf(str(path))
    assert model.names[1] == "joint2"
    found = model.upperDryFrictionLimit[0] + model.damping[0] * np.radians(SPEEDS)
    np.testing.assert_allclose(found, promised(SPEEDS), rtol=1e-4)
    assert model.lowerDryFrictionLimit[0] == -model.upperDryFrictionLimit[0]


def test_the_loss_that_is_told_is_the_loss():
    """RMS and greatest miss, here on a grid of its own; elsewhere the corners of the data."""
    deployed, settings = joint(), ExportSettings(to="urdf", **AT)
    where = operating_conditions(deployed, settings)
    form = simplified_friction(deployed, where, None)
    grid = np.linspace(2.3, 101.2, 5001)
    miss = promised(grid) - friction_torque(PUBLISHED, speed=grid, **AT)
    assert form.rms == pytest.approx(np.sqrt(np.mean(miss**2)), rel=0.01)
    assert form.worst == pytest.approx(np.max(np.abs(miss)), rel=1e-3)
    assert form.worst_speed == pytest.approx(2.3)
    load, warm = np.meshgrid(np.linspace(-95, 90, 40), np.linspace(20, 65, 40))
    everywhere = friction_torque(
        PUBLISHED, load=load, speed=grid[::50, None, None], temperature=warm
    )
    worst = np.max(np.abs(everywhere - promised(grid[::50])[:, None, None]))
    assert form.worst_in_range == pytest.approx(worst, rel=1e-3)
    # middles of equal cells, for a mean over the whole range
    load, warm = np.meshgrid(np.linspace(-95, 90, 61)[1::2], np.linspace(20, 65, 61)[1::2])
    inside = friction_torque(PUBLISHED, load=load, speed=grid[::50, None, None], temperature=warm)
    squares = np.square(inside - promised(grid[::50])[:, None, None])
    assert form.rms_in_range == pytest.approx(np.sqrt(np.mean(squares)), rel=0.01)
    text = export(deployed, settings)
    everywhere = f"{form.rms_in_range:.3g} N·m RMS"
    for shown in (f"{form.rms:.3g} N·m RMS", everywhere, f"up to {form.worst_in_range:.3g} N·m"):
        assert shown in " ".join(text.text.split())
        assert any(shown in line for line in text.notes)


def test_where_it_fits_by_default_is_the_middle_of_the_data():
    where = operating_conditions(joint(), ExportSettings(to="urdf"))
    assert where.speeds == (2.3, 101.2)
    assert where.temperature == pytest.approx(42.5)
    # evenly spread from -95 to 90: the mean square is (90³ + 95³)/3/185
    assert where.load == pytest.approx(np.sqrt((90**3 + 95**3) / 3 / 185))
    assert not where.remarks


def test_leaving_the_data_is_said():
    settings = ExportSettings(to="urdf", temperature=90.0, highest=200.0)
    said = export(joint(), settings).notes
    assert "speed 200 deg/s is outside the range of the data, 2.3 to 101.2" in said
    assert "temperature 90 °C is outside the range of the data, 20 to 65" in said


def test_neither_part_is_negative():
    """Friction that hardly grows: a line would slope upwards from below zero elsewhere."""
    form = simplified_friction(
        joint(tau_c=0.0, beta=30.0, gamma=0.0, delta=0.0),
        operating_conditions(
            joint(), ExportSettings(to="urdf", lowest=0.001, highest=0.01, load=0.0)
        ),
        None,
    )
    assert form.dry >= 0
    assert form.damping >= 0


def test_a_current_needs_a_torque_constant():
    with pytest.raises(OptionError, match=r"in A at the joint.*--torque-constant"):
        export(joint(unit="A"), ExportSettings(to="mjcf"))
    plain = simplified_friction(
        joint(), operating_conditions(joint(), ExportSettings(to="urdf", **AT)), None
    )
    scaled = simplified_friction(
        joint(unit="A"), operating_conditions(joint(unit="A"), ExportSettings(to="urdf", **AT)), 0.5
    )
    assert scaled.dry == pytest.approx(0.5 * plain.dry)
    assert scaled.damping == pytest.approx(0.5 * plain.damping)


def test_a_torque_in_newton_metres_needs_none():
    with pytest.raises(OptionError, match="leave it out"):
        export(joint(), ExportSettings(to="urdf", torque_constant=2.0))


@pytest.mark.parametrize("target", ["urdf", "mjcf"])
def test_no_remark_can_end_the_comment(target):
    """Two hyphens are not allowed in a comment of XML."""
    done = export(joint(), ExportSettings(to=target, temperature=-1.0))
    ET.fromstring(done.text.encode())


def test_an_empty_range_of_speeds_is_refused():
    with pytest.raises(OptionError, match="no range of speeds"):
        export(joint(), ExportSettings(to="urdf", lowest=300.0))
