"""Bodies of an arm: physically possible or not, and what a payload weighs, against MuJoCo."""

import mujoco
import numpy as np
import pandas as pd
import pinocchio
import pyarrow as pa
import pytest

from frictioncli import schemas, tables
from frictioncli.provenance import Provenance
from frictioncli.regression.arm_dynamics import ArmModel
from frictioncli.regression.inertial_bodies import (
    JointTorques,
    body_mass,
    fit_bodies,
    pseudo_inertia,
)
from frictioncli.regression.separation import torques_by_regression
from tests.command_line import invoke
from tests.regression import programmes
from tests.regression.test_arm import FRICTION, urdf

PAYLOAD = 4.5


def carrying(mass):
    """The arm as MuJoCo model; a ball of 0.1 m hangs 0.35 m along the last link."""
    spec = mujoco.MjSpec.from_string(urdf())
    if mass:
        ball = spec.body("link3").add_body(name="ball", pos=[0.35, 0, 0.05])
        ball.mass, ball.explicitinertial = mass, True
        ball.inertia = [0.4 * mass * 0.01] * 3
    return spec.compile()


def loaded_log(payloads, duration=60, seed=0):
    """Samples of three joints in sines at once, a recording for each payload."""
    generator = np.random.default_rng(seed)
    parts = []
    for number, payload in enumerate(payloads):
        motions = [
            programmes.sines(duration, generator, centre=10.0 * joint, amplitude=35.0)
            for joint in range(3)
        ]
        model = carrying(payload)
        data = mujoco.MjData(model)
        states = np.radians([list(motion[1:]) for motion in motions])
        torques = np.empty((states.shape[2], 3))
        for row in range(len(torques)):
            data.qpos[:], data.qvel[:], data.qacc[:] = states[:, :, row].T
            mujoco.mj_inverse(model, data)
            torques[row] = data.qfrc_inverse
        for joint, (motion, (tau_c, beta)) in enumerate(zip(motions, FRICTION, strict=True)):
            velocity = motion[2]
            friction = np.sign(velocity) * (tau_c + beta * np.sqrt(np.abs(velocity)))
            noise = programmes.autoregressive(generator, len(velocity), 0.3, 0.5)
            one = programmes.samples(
                (motion[0] + number * (duration + 10), *motion[1:]),
                torques[:, joint] + friction + noise,
                joint=np.full(len(velocity), joint + 1, dtype=np.int16),
                other_speed=np.full(len(velocity), 10.0),
            )
            name = pa.array([f"log{number}"] * len(velocity)).dictionary_encode()
            parts.append(one.set_column(1, "recording", name))
    parts.sort(key=lambda part: part["joint"][0].as_py())
    return pa.concat_tables(parts, promote_options="default").unify_dictionaries()


def manifest(payloads):
    keys = [("day1", f"log{number}") for number in range(len(payloads))]
    index = pd.MultiIndex.from_tuples(keys, names=["run", "recording"])
    return pd.DataFrame({"phase": None, "payload": payloads}, index=index)


@pytest.fixture(scope="module")
def description(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(urdf(masses=(2.0, 0.5, 3.0)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def log():
    return loaded_log([0.0, PAYLOAD])


def test_a_pseudo_inertia_is_the_second_moment_of_mass():
    """Of points with masses: the sum of m (x, 1)(x, 1)', by way of pinocchio's parameters."""
    generator = np.random.default_rng(3)
    points, masses = generator.normal(size=(7, 3)), generator.uniform(0.5, 2, 7)
    inertia = pinocchio.Inertia.Zero()
    for point, mass in zip(points, masses, strict=True):
        inertia = inertia + pinocchio.Inertia(mass, point, np.zeros((3, 3)))
    extended = np.hstack([points, np.ones((7, 1))])
    expected = extended.T @ (masses[:, np.newaxis] * extended)
    np.testing.assert_allclose(pseudo_inertia(inertia.toDynamicParameters()), expected, rtol=1e-9)


def torques_of(description, parameters, noise=0.1):
    """Torques that a set of parameters of the links makes, and their columns."""
    model = ArmModel(description)
    generator = np.random.default_rng(5)
    state = np.stack([generator.uniform(-a, a, (400, 3)) for a in (90, 90, 300)], axis=2)
    joints = []
    for joint in (1, 2, 3):
        columns = model.columns(joint, state).bodies
        clean = columns @ np.concatenate([parameters.reshape(-1), np.zeros(3)])
        torque = clean + generator.normal(0, noise, len(clean))
        joints.append(JointTorques(columns=columns, torque=torque, deviation=noise))
    return joints, model


def true_bodies():
    """Parameters of the links."""
    inertias = list(pinocchio.buildModelFromXML(urdf()).inertias)[1:]
    return np.array([one.toDynamicParameters() for one in inertias])


def test_torques_of_bodies_are_consistent_and_those_of_none_are_not(description):
    """A second link whose moments no body has: 0.4 kg·m² less about y than 0.24 of its mass."""
    bodies = true_bodies()
    joints, model = torques_of(description, bodies)
    found = fit_bodies(joints, model.start(0))
    assert found.is_consistent
    assert found.excess < 0.03
    assert found.rmse == pytest.approx(0.1, rel=0.05)
    impossible = bodies.copy()
    impossible[1, 6] -= 2.0
    assert np.linalg.eigvalsh(pseudo_inertia(impossible[1])).min() < -0.5
    joints, model = torques_of(description, impossible)
    found = fit_bodies(joints, model.start(0))
    assert not found.is_consistent
    assert found.chance < 1e-6
    assert found.excess > 0.1
    assert found.rmse == pytest.approx(0.1, rel=0.05)


def test_the_mass_of_a_body_only_where_the_motion_tells_it(description):
    """Of a chain of links only combinations of masses are told; a payload's mass stands alone."""
    joints, _ = torques_of(description, true_bodies())
    assert all(body_mass(joints, body) is None for body in range(3))


def test_the_payload_is_weighed_and_friction_is_right_with_it(log, description):
    found = torques_by_regression(
        log.to_batches, urdf=description, manifest=manifest([0.0, PAYLOAD])
    )
    assert found.arm["physically_consistent"]
    assert found.arm["excess"] < 0.2 * found.arm["rmse"]
    (payload,) = found.arm["payloads"]
    low, high = payload["ci95"]
    assert low < PAYLOAD < high
    assert high - low < 0.6
    for joint, (tau_c, beta) in enumerate(FRICTION, start=1):
        for one in found.facts[joint]["friction"]:
            truth = tau_c + beta * np.sqrt(one["speed"])
            assert one["estimate"] == pytest.approx(truth, rel=0.02)
    assert any("kg by the torques" in text for text in found.texts)


def test_a_payload_that_contradicts_the_manifest_is_said(log, description):
    found = torques_by_regression(log.to_batches, urdf=description, manifest=manifest([0.0, 2.0]))
    (text,) = (text for text in found.texts if text.startswith("payload"))
    assert "payload of 2 kg, 2 kg more than the lightest: 4." in text
    assert text.endswith("which contradicts the manifest")


def test_wrong_lengths_show_as_bodies_that_cannot_be(log, tmp_path):
    path = tmp_path / "wrong.urdf"
    path.write_text(urdf().replace('xyz="0.5 0 0"', 'xyz="-0.1 0 0.6"'), encoding="utf-8")
    found = torques_by_regression(log.to_batches, urdf=path, manifest=manifest([0.0, PAYLOAD]))
    assert not found.arm["physically_consistent"]
    (text,) = (text for text in found.texts if text.startswith("arm:"))
    assert "no bodies can have the inertial parameters" in text
    assert "not forced" in text


def test_the_metadata_hold_what_is_told_of_the_bodies(log, description, tmp_path):
    facts = {"torque_unit": "N·m"}
    tables.write(tmp_path / "samples.parquet", log, schemas.SAMPLES, Provenance("ingest"), facts)
    done = invoke("separate", "-w", tmp_path, "--urdf", description)
    told = tables.facts(tmp_path / "torques.parquet")["arm"]
    assert told["joints"] == [1, 2, 3]
    assert told["unit"] == "N·m"
    assert "arm: " in done.stdout
