"""Inertia and a friction deficit after a reversal, estimated from ramps and distinguished."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictioncli import schemas, tables
from frictioncli.diagnosis.data.gravity import GravityForm
from frictioncli.diagnosis.ramps.evidence import (
    MAX_LOG_ODDS,
    RampLog,
    ramp_evidence,
    ramp_logs,
    with_ramp_evidence,
)
from frictioncli.model.friction import PUBLISHED, friction_torque
from frictioncli.provenance import Provenance
from tests import found
from tests.moves import move_sequence, samples

SPEEDS = [15.0, 15.0, 30.0, 30.0, 60.0, 60.0, 100.0, 100.0] * 4
GRAVITY = np.array([90.0, -5.0, 1.0])
INERTIA = 0.12
"""Of the joint in the tests. [N·m/(deg/s²)]"""


def smooth_journey(period):
    """A move_sequence of trapezoids, averaged over 50 ms as a servo would, without any jump."""
    fine = 0.0005
    motion = move_sequence([0, 180] * (len(SPEEDS) // 2) + [0], SPEEDS, period=fine)
    window = np.hanning(101)[1:-1] / np.hanning(101).sum()
    channels = {
        name: np.convolve(np.pad(values, 49, mode="edge"), window, mode="valid")
        for name, values in motion.items()
        if name != "time"
    }
    still = np.abs(channels["velocity"]) < 1e-9
    channels["velocity"][still] = 0.0
    return motion.assign(**channels).iloc[:: round(period / fine)].reset_index(drop=True)


def since_reversal(motion):
    """Angle and time since the move began."""
    position, moving = motion["position"], motion["velocity"] != 0
    begun = (moving & ~moving.shift(fill_value=False)).cumsum()
    first = motion.groupby(begun)[["position", "time"]].transform("first")
    return (position - first["position"]).abs(), motion["time"] - first["time"]


def log(*, deficit=0.0, distance=6.0, delayed=0.0, sign=1, late=0, noise=0.3, seed=0, period=0.004):
    """Ramps of a joint of exactly known friction, gravity, inertia, deficit and delayed inertia."""
    motion = smooth_journey(period)
    angle = np.radians(motion["position"])
    load = GRAVITY @ np.vstack([np.cos(angle), np.sin(angle), np.ones_like(angle)])
    friction = friction_torque(
        PUBLISHED, load=load, speed=motion["velocity"].abs(), temperature=40.0
    )
    travelled, passed = since_reversal(motion)
    friction -= deficit * np.exp(-travelled / distance)
    lagged = motion["velocity"] / 0.3 * np.exp(-passed / 0.3)
    torque = load + sign * np.sign(motion["velocity"]) * friction
    torque += (INERTIA * motion["acceleration"] + delayed * lagged).shift(late, fill_value=0.0)
    torque += np.random.default_rng(seed).normal(0, noise, len(motion))
    frame = samples(motion, friction=0.0, torque=torque)
    return RampLog(found.ramps(frame), sign)


def evidence_of(ramps, **base):
    problem = SimpleNamespace(
        gravity=GRAVITY,
        gravity_form=GravityForm(),
        has_load_channel=False,
        parameters=PUBLISHED,
        runs=("day1",),
    )
    return ramp_evidence(ramps, SimpleNamespace(**(vars(problem) | base)), "motor")


@pytest.mark.parametrize("sign", [1, -1])
def test_inertia_alone_is_measured_and_no_finding(sign):
    found = evidence_of(log(sign=sign))
    assert found.inertia.value == pytest.approx(INERTIA, rel=0.01)
    assert found.inertia.low < INERTIA < found.inertia.high
    assert found.transient < 3
    assert abs(found.log_odds) < 4
    assert found.rms_after < 0.1 * found.rms_before


@pytest.mark.parametrize(("deficit", "distance"), [(3.0, 4.0), (2.0, 8.0)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_friction_deficit_is_measured(deficit, distance, sign):
    found = evidence_of(log(deficit=deficit, distance=distance, sign=sign, noise=0.1))
    assert found.inertia.value == pytest.approx(INERTIA, rel=0.01)
    assert found.deficit.value == pytest.approx(deficit, rel=0.05)
    assert found.distance.value == pytest.approx(distance, rel=0.08)
    assert found.deficit.low < deficit < found.deficit.high
    assert found.distance.low < distance < found.distance.high
    assert found.log_odds == MAX_LOG_ODDS


@pytest.mark.parametrize("delayed", [0.03, -0.03])
def test_inertia_that_acts_late_is_no_friction_deficit(delayed):
    found = evidence_of(log(delayed=delayed))
    assert found.log_odds < -5
    assert found.delayed_inertia.value * delayed > 0


@pytest.mark.parametrize("late", [-2, 1, 2])
def test_a_servo_that_lags_is_seen_through(late):
    found = evidence_of(log(late=late, period=0.008))
    assert found.inertia.value == pytest.approx(INERTIA, rel=0.02)
    assert found.lag == pytest.approx(late, abs=0.25)
    assert found.log_odds < 3


def test_a_wrong_base_is_no_friction_deficit():
    """Friction 15 % too high and gravity 5 % too low: as wrong after a reversal as before one."""
    off = type(PUBLISHED)(tau_c=12.0, alpha=0.0016, beta=4.0, gamma=18.0, delta=0.056)
    found = evidence_of(log(), parameters=off, gravity=0.95 * GRAVITY)
    assert found.inertia.value == pytest.approx(INERTIA, rel=0.02)
    assert found.log_odds < 3
    with_deficit = evidence_of(log(deficit=3.0), parameters=off, gravity=0.95 * GRAVITY)
    assert with_deficit.deficit.value == pytest.approx(3.0, rel=0.1)
    assert with_deficit.log_odds > 5


def test_payload_and_a_load_channel_of_its_own():
    rows = log(deficit=3.0, distance=4.0).rows
    heavy = rows.assign(payload=np.where(rows["move"] % 4 < 2, 0.0, 3.0))
    more = 3.0 * 8.0 * np.cos(np.radians(heavy["position"])) * (heavy["payload"] > 0)
    heavy["torque"] += more
    gravity = np.append(GRAVITY, [8.0, 0.0])
    found = evidence_of(RampLog(heavy, 1), gravity=gravity, gravity_form=GravityForm(payloads=True))
    assert found.inertia.value == pytest.approx(INERTIA, rel=0.02)
    own = rows.assign(load=10.0 * np.cos(np.radians(rows["position"])))
    found = evidence_of(RampLog(own, 1), has_load_channel=True)
    assert found.deficit.value == pytest.approx(3.0, rel=0.1)


def test_ramps_are_read_by_joint_where_there_are_any(tmp_path):
    rows = log().rows
    path = tmp_path / "ramps.parquet"
    assert ramp_logs(path, {"2": 1}) == {}
    tables.write(path, rows, schemas.RAMPS, Provenance("pair", {}, {}))
    (joint,) = (logs := ramp_logs(path, {"2": -1}))
    assert (joint, logs[2].sign, len(logs[2].rows)) == (2, -1, len(rows))
    assert ramp_logs(path, {"3": 1}) == {}
    assert evidence_of(RampLog(logs[2].rows, 1)) == evidence_of(RampLog(rows, 1))


def test_too_few_moves_and_too_slow_a_log_say_nothing():
    whole = log()
    few = whole.rows[whole.rows["move"] < 4]
    assert evidence_of(RampLog(few, 1)) is None
    assert evidence_of(log(period=0.06)) is None
    assert evidence_of(whole, runs=("another day",)) is None


EVIDENCE = {"inertia": 20.0, "reversal_transient": 19.0, "dress_pack": 15.0, "drift": -3.0}


def test_arbitration_moves_only_the_two():
    found = evidence_of(log(deficit=3.0))
    assert found.log_odds > 5
    after = with_ramp_evidence(EVIDENCE, found)
    assert {name: after[name] for name in ("dress_pack", "drift")} == {
        "dress_pack": 15.0,
        "drift": -3.0,
    }
    assert after["reversal_transient"] - after["inertia"] == pytest.approx(
        min(found.transient - found.inertial, MAX_LOG_ODDS) - 1
    )
    together = np.logaddexp(after["inertia"], after["reversal_transient"])
    assert together == pytest.approx(np.logaddexp(20.0, 19.0))


@pytest.mark.parametrize(
    "evidence", [{"drift": 4.0}, {"inertia": 4.0}, {"inertia": 4.0, "reversal_transient": -np.inf}]
)
def test_arbitration_creates_nothing(evidence):
    assert with_ramp_evidence(evidence, evidence_of(log(deficit=3.0))) == evidence
    assert with_ramp_evidence(EVIDENCE, None) == EVIDENCE
