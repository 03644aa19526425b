"""Joints that move together, with the dynamics of the whole arm by another simulator."""

import sys

import mujoco
import numpy as np
import pyarrow as pa
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.provenance import Provenance
from frictioncli.regression.arm_dynamics import ArmModel
from frictioncli.regression.separation import torques_by_regression
from tests.command_line import invoke
from tests.regression import programmes

LINKS = (
    # axis, offset of the joint, mass, centre of mass, moments of inertia
    ("0 0 1", "0 0 0.3", 8.0, "0 0.01 0.1", (0.2, 0.2, 0.1)),
    ("0 1 0", "0 0 0.2", 6.0, "0.2 0 0.02", (0.05, 0.2, 0.2)),
    ("0 1 0", "0.5 0 0", 4.0, "0.15 0.02 0", (0.03, 0.1, 0.1)),
)
FRICTION = ((9.0, 2.0), (6.0, 1.5), (4.0, 1.0))
"""tau_c [N·m] and beta [N·m/(deg/s)^0.5] by joint."""


def urdf(masses=(1.0, 1.0, 1.0)):
    """The arm as URDF; its inertial parameters may be scaled by link."""
    parts = ['<robot name="arm"><link name="base"/>']
    parent = "base"
    for number, ((axis, offset, mass, centre, moments), factor) in enumerate(
        zip(LINKS, masses, strict=True), start=1
    ):
        xx, yy, zz = (factor * one for one in moments)
        parts.append(
            f'<link name="link{number}"><inertial><origin xyz="{centre}"/>'
            f'<mass value="{factor * mass}"/><inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0"'
            ' ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint{number}" type="revolute"><parent link="{parent}"/>'
            f'<child link="link{number}"/><origin xyz="{offset}"/><axis xyz="{axis}"/>'
            '<limit lower="-3" upper="3" effort="1000" velocity="10"/></joint>'
        )
        parent = f"link{number}"
    return "\n".join([*parts, "</robot>"])


def arm_motions(generator, duration):
    """Sines of three joints at once, and the torques [N·m] of MuJoCo's inverse dynamics."""
    motions = [
        programmes.sines(duration, generator, centre=10.0 * joint, amplitude=35.0)
        for joint in range(3)
    ]
    model = mujoco.MjModel.from_xml_string(urdf())
    data = mujoco.MjData(model)
    states = np.radians([[channel for channel in motion[1:]] for motion in motions])
    torques = np.empty((states.shape[2], 3))
    for row in range(len(torques)):
        data.qpos[:], data.qvel[:], data.qacc[:] = states[:, :, row].T
        mujoco.mj_inverse(model, data)
        torques[row] = data.qfrc_inverse
    return motions, torques


def arm_log(seed=0, duration=120):
    """Samples of three joints in sines at once, with friction and noise."""
    generator = np.random.default_rng(seed)
    motions, torques = arm_motions(generator, duration)
    parts = []
    for joint, (motion, (tau_c, beta)) in enumerate(zip(motions, FRICTION, strict=True)):
        velocity = motion[2]
        friction = np.sign(velocity) * (tau_c + beta * np.sqrt(np.abs(velocity)))
        noise = programmes.autoregressive(generator, len(velocity), 0.3, 0.5)
        parts.append(
            programmes.samples(
                motion,
                torques[:, joint] + friction + noise,
                joint=np.full(len(velocity), joint + 1, dtype=np.int16),
                other_speed=np.full(len(velocity), 10.0),
            )
        )
    return pa.concat_tables(parts)


@pytest.fixture(scope="module")
def log():
    return arm_log()


@pytest.fixture(scope="module")
def description(tmp_path_factory):
    """A description with wrong masses: they must not matter."""
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(urdf(masses=(2.0, 0.5, 3.0)), encoding="utf-8")
    return path


def test_friction_of_joints_that_move_together(log, description):
    found = torques_by_regression(log.to_batches, urdf=description)
    assert sorted(found.facts) == [1, 2, 3]
    for joint, (tau_c, beta) in enumerate(FRICTION, start=1):
        for one in found.facts[joint]["friction"]:
            low, high = one["ci95"]
            truth = tau_c + beta * np.sqrt(one["speed"])
            assert one["estimate"] == pytest.approx(truth, rel=0.01)
            assert low - (high - low) < truth < high + (high - low)
        rows = found.table[found.table["joint"] == joint]
        error = rows["friction_torque"] - tau_c - beta * np.sqrt(rows["speed"])
        assert abs(error.mean()) < 0.1
        assert error.std() < 0.5


def test_without_the_arm_the_same_log_is_refused_or_wrong(log):
    """What the others add is several newton metres: the test above does not pass by itself."""
    with pytest.raises(NotEnoughData, match="give --urdf"):
        torques_by_regression(log.to_batches, doubtful=False)
    alone = torques_by_regression(log.to_batches)
    assert alone.facts[2]["held_out"] > 4 * 0.3


def test_base_parameters_are_as_many_as_the_arm_has(log, description):
    """A chain z, y, y: the torque of a joint depends on its own link and those behind it."""
    model = ArmModel(description)
    state = np.random.default_rng(1).uniform(-90, 90, (300, 3, 3))
    numbers = [model.columns(joint, state).torque.shape[1] for joint in (1, 2, 3)]
    assert numbers[2] < numbers[1] <= numbers[0] + 4
    assert numbers[2] <= 8
    columns = model.columns(3, state)
    assert np.linalg.matrix_rank(columns.torque) == columns.torque.shape[1]


def test_gravity_columns_are_those_at_rest(description):
    model = ArmModel(description)
    state = np.random.default_rng(2).uniform(-90, 90, (50, 3, 3))
    still = state.copy()
    still[:, :, 1:] = 0.0
    moving = model.columns(2, state)
    assert not np.allclose(moving.torque, moving.gravity)
    assert np.linalg.matrix_rank(model.columns(2, still).torque) <= moving.torque.shape[1]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (None, "no such file"),
        ("<robot", "cannot be read as URDF"),
        (urdf().replace("revolute", "prismatic"), "joints that turn about one axis"),
    ],
)
def test_an_unusable_description_is_named(tmp_path, text, told):
    path = tmp_path / "arm.urdf"
    if text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(OptionError, match=told):
        ArmModel(path)


def test_without_pinocchio_the_message_says_what_to_install(monkeypatch, description):
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    with pytest.raises(OptionError, match=r"pip install 'frictioncli\[dynamics\]'"):
        ArmModel(description)


def test_the_option_reaches_the_regression(log, description, tmp_path):
    facts = {"torque_unit": "N·m"}
    tables.write(tmp_path / "samples.parquet", log, schemas.SAMPLES, Provenance("ingest"), facts)
    # without pairs the way need not be told
    done = invoke("separate", "-w", tmp_path, "--urdf", description)
    assert done.stdout.count("base parameters") == 3
    document = tables.metadata(tmp_path / "torques.parquet")
    assert document["settings"]["urdf"] == str(description)
    assert set(document["facts"]["separated_by"].values()) == {"regression"}
