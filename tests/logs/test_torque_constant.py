"""Torque constants: found from a torque beside the current, given, or refused; results in N·m."""

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import LogError, MappingError, NotEnoughData, OptionError
from frictioncli.logs.channels.shared_load import ChannelPair
from frictioncli.logs.channels.torque_constant import estimate_constant
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.model.document import read_models
from frictioncli.stages.fit import fit
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate

from .logs import REAL, write

CONSTANT = 8.0


def motion(seconds=160.0, period=0.02, gravity=30.0, inertia=2.0, seed=0):
    """Return time, angle, and load with and without inertia, and friction of a joint in motion.

    It moves at constant speeds there and back, with smooth reversals.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, period)
    rate = np.repeat([15.0, 30.0, 60.0, 30.0], len(time) // 4)
    # a rounded triangle of 80 deg: its phase runs at the speed of the move
    phase = np.cumsum(rate) * period / 160 * 2 * np.pi
    angle = 80 / np.pi * np.arcsin(0.98 * np.sin(phase)) + 20
    velocity = np.gradient(angle, period)
    load = gravity * np.cos(np.radians(angle))
    inertial = inertia * np.radians(np.gradient(velocity, period))
    friction = np.tanh(velocity) * (5 + 0.8 * np.sqrt(np.abs(velocity)))
    return time, angle + rng.normal(0, 2e-3, len(time)), load, inertial, friction


def channels(constant=CONSTANT, share=0.3, delay=2, seed=0, noise=0.3, **kinds):
    """Return time, angle, current and a torque that holds a share of the friction, later."""
    rng = np.random.default_rng([seed, 1])
    time, angle, load, inertial, friction = motion(seed=seed, **kinds)
    current = (load + inertial + friction) / constant + 0.4
    torque = np.roll(load + 0.9 * inertial + share * friction, delay) + 2.0
    count = len(time)
    return (
        time,
        angle,
        current + rng.normal(0, noise / abs(constant), count),
        torque + rng.normal(0, noise, count),
    )


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("constant", [8.0, -110.0])
def test_the_constant_is_that_of_the_load(constant, share):
    """Friction, offset, delay and inertia of the channels differ; the ratio of the loads counts."""
    found = estimate_constant([[ChannelPair(*channels(constant, share))]])
    assert found.seen_by == "gravity"
    assert found.ci95[0] < constant < found.ci95[1]
    assert abs(found.value / constant - 1) < 0.02
    assert (found.ci95[1] - found.ci95[0]) / abs(constant) < 0.1


def test_without_regard_to_friction_the_constant_would_be_another():
    """A plain regression of the torque on the current is far off: the current holds friction."""
    time, angle, current, torque = channels(share=0.0)
    plain = np.polyfit(current, torque, 1)[0]
    found = estimate_constant([[ChannelPair(time, angle, current, torque)]])
    assert abs(plain / CONSTANT - 1) > 0.1 > 5 * abs(found.value / CONSTANT - 1)


def test_noise_of_the_current_does_not_make_it_smaller():
    found = estimate_constant([[ChannelPair(*channels(noise=8.0))]])
    assert found.ci95[0] < CONSTANT < found.ci95[1]
    assert found.value == pytest.approx(CONSTANT, rel=0.05)


def test_a_payload_of_another_run_does_not_matter():
    """Twice the gravity in the second run; each run is its own comparison."""
    runs = [[ChannelPair(*channels(gravity=g, seed=n))] for n, g in enumerate((20.0, 40.0))]
    found = estimate_constant(runs)
    assert found.ci95[0] < CONSTANT < found.ci95[1]
    assert found.value == pytest.approx(CONSTANT, rel=0.02)


def test_a_vertical_axis_is_told_by_its_inertia():
    """Without gravity; both channels then must see the same inertia."""
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 60.0, 0.01)
    angle = 40 * np.sin(3 * time) + 15 * np.sin(7.3 * time)
    rate = np.gradient(angle, 0.01)
    inertial = 3 * np.radians(np.gradient(rate, 0.01))
    current = (inertial + 4 * np.sign(rate)) / CONSTANT + rng.normal(0, 0.02, len(time))
    torque = inertial + rng.normal(0, 0.1, len(time))
    found = estimate_constant([[ChannelPair(time, angle, current, torque)]])
    assert found.seen_by == "inertia"
    assert found.ci95[0] < CONSTANT < found.ci95[1]


def test_channels_without_a_common_load_tell_none():
    time, angle, current, _ = channels(gravity=0.0, inertia=0.0)
    torque = np.random.default_rng(2).normal(0, 1, len(time))
    with pytest.raises(NotEnoughData, match=r"gravity explains only .* inertia explains only"):
        estimate_constant([[ChannelPair(time, angle, current, torque)]])
    still = np.full(len(time), 3.0)
    with pytest.raises(NotEnoughData, match="hardly moves"):
        estimate_constant([[ChannelPair(time, still, current, torque)]])


def log(path, *, target=False, **kinds):
    """Write a log of joint 2 with a current, and with a torque that is freed of friction."""
    time, angle, current, torque = channels(share=0.0, **kinds)
    name = "target_moment_2" if target else "torque_2"
    columns = {"time": time, "actual_q_2 [deg]": angle, "current_2": current, name: torque}
    return write(path, columns)


@pytest.mark.parametrize("target", [False, True])
def test_auto_gives_torque_with_interval_and_reason(target, tmp_path):
    path = log(tmp_path / "logs" / "log.csv", target=target)
    work = tmp_path / "work"
    summary = ingest([path], work, IngestSettings(torque_constant="auto"))
    assert (summary.torque_unit, summary.torque_side) == ("N·m", "joint")
    plain = ingest([path], tmp_path / "plain")
    assert plain.torque_unit == "A"
    in_a, in_nm = (
        tables.read(w / "samples.parquet", schemas.SAMPLES) for w in (tmp_path / "plain", work)
    )
    fact = tables.facts(work / "samples.parquet")["torque_constant"]["2"]
    np.testing.assert_allclose(in_nm["torque"], fact["estimate"] * in_a["torque"], rtol=1e-9)
    low, high = fact["ci95"]
    assert low < CONSTANT < high
    assert (high - low) / CONSTANT < 0.1
    assert fact["unit"] == "N·m/A"
    assert "gravity that current_2 and" in fact["reason"]
    assert ("the robot's own model" in fact["reason"]) == target
    assert any("all torque-like results share its error" in note for note in summary.notes)


def test_the_intervals_of_the_fit_hold_the_constants_error(tmp_path):
    """Viscous friction of 0.8 N·m/(deg/s)^0.5; a constant known to 10 % widens its interval."""
    work = tmp_path / "work"
    ingest([log(tmp_path / "log.csv")], work, IngestSettings(torque_constant="auto"))
    pair(work)
    separate(work)
    fit(work)
    facts = tables.facts(work / "torques.parquet")
    (one,) = facts["torque_constant"].values()
    relative = (one["ci95"][1] - one["ci95"][0]) / 2 / one["estimate"]
    (model,) = read_models(work / "model.json")
    tau = model.parameters["beta"]
    assert model.torque_unit == "N·m"
    assert (tau.ci95[1] - tau.ci95[0]) / 2 >= relative * tau.estimate


def test_auto_without_a_torque_beside_the_current_is_refused(tmp_path):
    time, angle, current, _ = channels()
    path = write(tmp_path / "log.csv", {"time": time, "q_2 [deg]": angle, "current_2 [A]": current})
    with pytest.raises(
        LogError, match=r"no torque in N·m at the joint from which the torque constant of current_2"
    ):
        ingest([path], tmp_path / "work", IngestSettings(torque_constant="auto"))
    assert not (tmp_path / "work").exists()


def test_a_constant_that_is_given(tmp_path):
    path = log(tmp_path / "log.csv", target=True)
    summary = ingest([path], tmp_path / "work", IngestSettings(torque_constant=-12.5))
    table = tables.read(tmp_path / "work" / "samples.parquet", schemas.SAMPLES)
    ingest([path], tmp_path / "plain")
    plain = tables.read(tmp_path / "plain" / "samples.parquet", schemas.SAMPLES)
    np.testing.assert_allclose(table["torque"], -12.5 * plain["torque"], rtol=1e-9)
    fact = tables.facts(tmp_path / "work" / "samples.parquet")["torque_constant"]["2"]
    assert (fact["estimate"], fact["ci95"], fact["reason"]) == (-12.5, None, "as given")
    assert summary.torque_unit == "N·m"


def test_a_map_gives_the_constant(tmp_path):
    path = log(tmp_path / "log.csv")
    map_file = tmp_path / "map.toml"
    channels_text = 'time = "time"\nposition = "actual_q_2"\ntorque = "current_2"\n'
    joint = "number = 2\ntorque_constant = {}\n"
    for text, unit in (("7.5", "N·m"), ('"auto"', "N·m")):
        load = 'load = "torque_2"\n' if "auto" in text else ""
        body = f'[channels]\n{channels_text}{load}[units]\ntorque = "A"\n[joint]\n'
        map_file.write_text(body + joint.format(text))
        summary = ingest([path], tmp_path / "work", IngestSettings(map_file=map_file))
        assert summary.torque_unit == unit
    map_file.write_text(body + joint.format("0"))
    with pytest.raises(MappingError, match=r"torque_constant = 0; expected 'auto', or N·m/A"):
        ingest([path], tmp_path / "work", IngestSettings(map_file=map_file))


def test_a_constant_without_a_current_is_told_to_have_no_use(tmp_path):
    time, angle, _, torque = channels(share=1.0)
    path = write(tmp_path / "log.csv", {"time": time, "q_2 [deg]": angle, "torque_2 [Nm]": torque})
    summary = ingest([path], tmp_path / "work", IngestSettings(torque_constant=3.0))
    assert any("torque constant of joint 2 is not used" in one for one in summary.warnings)
    summary = ingest([path], tmp_path / "work", IngestSettings(torque_constant="auto"))
    assert "no torque constant is needed: no torque is a motor current" in summary.notes


def test_one_constant_for_several_joints_is_refused(tmp_path):
    time, angle, current, _ = channels()
    columns = {"time": time}
    for joint in (1, 2):
        columns |= {f"q_{joint} [deg]": angle, f"current_{joint} [A]": current}
    path = write(tmp_path / "log.csv", columns)
    with pytest.raises(OptionError, match="currents of joints 1, 2"):
        ingest([path], tmp_path / "work", IngestSettings(torque_constant=3.0))
    summary = ingest([path], tmp_path / "work", IngestSettings(torque_constant=3.0, joints=(2,)))
    assert summary.torque_unit == "N·m"


@pytest.mark.parametrize("wrong", [0.0, float("nan"), float("inf"), "any"])
def test_wrong_constants(wrong):
    with pytest.raises(OptionError, match="torque constant"):
        IngestSettings(torque_constant=wrong)


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
@pytest.mark.parametrize(
    ("folder", "joint", "by_hand"),
    [("xarm6-j3", 3, 5.75), ("xarm6-j2", 2, 6.7), ("nist-ur5", 2, 12.6)],
)
def test_real_currents(folder, joint, by_hand, tmp_path):
    """By hand: half sums of both channels in angle bins (xArm), all samples (UR5)."""
    settings = IngestSettings(joints=(joint,), torque_constant="auto")
    assert ingest([REAL / folder], tmp_path, settings).torque_unit == "N·m"
    fact = tables.facts(tmp_path / "samples.parquet")["torque_constant"][str(joint)]
    assert fact["estimate"] == pytest.approx(by_hand, rel=0.03)
    low, high = fact["ci95"]
    assert (high - low) / 2 < 0.02 * by_hand


def test_a_current_beside_a_torque_tells_how_to_get_newton_metres(tmp_path):
    summary = ingest([log(tmp_path / "log.csv")], tmp_path / "work")
    assert summary.torque_unit == "A"
    assert any("with --torque-constant auto they are in N·m" in note for note in summary.notes)
