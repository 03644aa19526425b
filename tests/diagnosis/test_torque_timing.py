"""Delay and filter of the torque: planted in moves by formulas, and into a real log."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from scipy.signal import lfilter

from frictioncli import schemas, tables
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.gravity import GravityForm
from frictioncli.diagnosis.ramps.evidence import RampLog, ramp_logs
from frictioncli.diagnosis.ramps.logged_response import responded
from frictioncli.diagnosis.ramps.timing import torque_timing
from frictioncli.logs.ingest import IngestSettings, ingest
from frictioncli.model.friction import FrictionParameters, friction_torque
from frictioncli.pairs.pair_tables import start_rows
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from frictioncli.workfiles import RAMPS, SAMPLES, STARTS, TORQUES
from tests.found import NO_MANIFEST, segments
from tests.logs.logs import REAL
from tests.moves import move_sequence

FINE = 0.001
FRICTION = FrictionParameters(tau_c=8.0, alpha=0.001, beta=2.0, gamma=0.0, delta=0.05)
GRAVITY = np.array([60.0, 10.0, 3.0])
PROBLEM = SimpleNamespace(
    runs=("day1",),
    gravity=GRAVITY,
    gravity_form=GravityForm(),
    has_load_channel=False,
    parameters=FRICTION,
)


SPEEDS = (20.0, 45.0, 80.0, 110.0)


def logged(
    *,
    delay=0.0,
    time_constant=0.0,
    sign=1,
    every=12,
    noise=0.3,
    seed=0,
    speeds=SPEEDS,
    onset=0.0,
    inertia=0.1,
):
    """Moves at four speeds, sampled at 1 kHz, and logged every 12 ms; friction builds up late.

    ``onset`` is the angle in which friction after a start reaches 63 %, from 40 % on. [deg]
    """
    speeds = np.tile(speeds, 5)
    motion = move_sequence([0, 100] * 10 + [0], speeds, period=FINE, rest=0.4)
    velocity = motion["velocity"].to_numpy()
    angle = np.radians(motion["position"].to_numpy())
    gravity = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle)]) @ GRAVITY
    friction = friction_torque(FRICTION, load=gravity, speed=np.abs(velocity), temperature=30.0)
    # over the first 0.01 deg or so, as the contact deforms
    friction = lfilter([0.2], [1.0, -0.8], np.sign(velocity) * friction)
    if onset:
        position = motion["position"].to_numpy()
        begins = np.append(True, np.diff(np.sign(velocity)) != 0)
        start = np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))
        friction = friction * (1 - 0.6 * np.exp(-np.abs(position - position[start]) / onset))
    torque = gravity + sign * friction + inertia * motion["acceleration"].to_numpy()
    late = round(delay / FINE)
    torque = np.concatenate([np.full(late, torque[0]), torque[: len(torque) - late]])
    if time_constant:
        memory = np.exp(-FINE / time_constant)
        # at 1 ms the filter's mean delay is half a sample less
        torque = lfilter([1 - memory], [1, -memory], torque, zi=[memory * torque[0]])[0]
    generator = np.random.default_rng(seed)
    rows = motion.iloc[::every].drop(columns="acceleration")
    return rows.assign(
        run="day1",
        recording="log",
        joint=2,
        torque=torque[::every] + generator.normal(0, noise, len(rows)),
        motor_temperature=30.0,
    )


def starts(frame):
    with segments(frame) as found:
        return pa.concat_tables(list(start_rows(found, NO_MANIFEST["payload"]))).to_pandas()


def timing(frame, *, sign=1, problem=PROBLEM):
    log = RampLog(pd.DataFrame(), sign, starts(frame))
    return torque_timing(log, problem, "motor")


@pytest.mark.parametrize("sign", [1, -1])
def test_a_clean_log_is_neither_late_nor_filtered(sign):
    found = timing(logged(sign=sign), sign=sign)
    assert found.best == "none"
    assert found.delay.value == pytest.approx(0.0, abs=2e-4)
    assert found.time_constant.value == pytest.approx(0.0, abs=2e-4)
    assert found.shift.value == pytest.approx(0.0, abs=0.001)
    assert found.starts == 20
    # the acceleration steps by 40 N·m between two samples
    assert found.rms < 1.2


@pytest.mark.parametrize(("delay", "sign"), [(0.012, 1), (0.012, -1), (0.03, 1)])
def test_a_late_torque_is_a_delay_of_as_much(delay, sign):
    found = timing(logged(delay=delay, sign=sign), sign=sign)
    assert found.best == "torque_delay"
    assert found.delay.low < delay < found.delay.high
    assert found.delay.high - found.delay.low < 0.01
    assert found.time_constant.value == pytest.approx(0.0, abs=3e-4)
    assert found.log_odds < -3


@pytest.mark.parametrize("onset", [0.03, 0.06])
@pytest.mark.parametrize("slow", [3.0, 5.0])
def test_friction_that_builds_up_over_a_few_hundredths_of_a_degree_is_no_filter(slow, onset):
    """A light arm, so that friction tells more than inertia, and moves as slow as that."""
    found = timing(
        logged(
            delay=0.012,
            every=10,
            noise=0.02,
            inertia=0.0175,
            speeds=(slow, 2.5 * slow, 25.0, 20 * slow),
            onset=onset,
        )
    )
    assert found.best == "torque_delay"
    assert found.shift.low < 0.012 < found.shift.high
    assert found.shift.value == pytest.approx(0.012, abs=0.002)


@pytest.mark.parametrize("time_constant", [0.02, 0.04])
def test_a_filtered_torque_is_a_filter_of_as_much(time_constant):
    found = timing(logged(time_constant=time_constant))
    assert found.best == "torque_filter"
    assert found.time_constant.low < time_constant < found.time_constant.high
    assert found.time_constant.high - found.time_constant.low < 0.5 * time_constant
    assert found.delay.value == pytest.approx(0.0, abs=3e-4)
    assert found.log_odds > 3


def test_a_delay_behind_a_filter_is_both():
    found = timing(logged(delay=0.02, time_constant=0.03))
    assert found.best == "both"
    assert found.delay.low < 0.02 < found.delay.high
    assert found.time_constant.low < 0.03 < found.time_constant.high
    assert found.shift.value == pytest.approx(0.05, abs=0.003)


@pytest.mark.long
def test_a_fast_log_tells_the_delay_to_a_fraction_of_a_millisecond():
    found = timing(logged(delay=0.003, every=2))
    assert found.best == "torque_delay"
    assert found.delay.value == pytest.approx(0.003, abs=5e-4)
    assert found.delay.high - found.delay.low < 0.005


def test_gravity_in_another_unit_than_torque_is_found_on_the_way():
    """A load channel in N·m beside a motor current: gravity is not known in A."""
    problem = SimpleNamespace(**vars(PROBLEM) | {"has_load_channel": True, "gravity": 9 * GRAVITY})
    found = timing(logged(delay=0.012), problem=problem)
    assert found.best == "torque_delay"
    assert found.delay.low < 0.012 < found.delay.high


def test_slow_or_few_samples_say_nothing():
    slow = logged(every=50)
    assert starts(slow).empty
    assert timing(slow) is None
    few = logged()
    assert timing(few[few["time"] < 9.0]) is None
    assert torque_timing(RampLog(pd.DataFrame(), 1), PROBLEM, "motor") is None


@pytest.mark.parametrize(("delay", "time_constant"), [(0.013, 0.0), (0.0, 0.02), (0.011, 0.03)])
def test_a_response_is_that_of_differential_equation_and_shift(delay, time_constant):
    """A ramp behind the filter is a ramp later by the time constant; a delay adds its own."""
    time = 0.004 * np.arange(300)
    ramp = np.maximum(time - 0.1, 0.0)[np.newaxis]
    found = responded(ramp, 0.004, delay=delay, time_constant=time_constant)[0]
    since = np.maximum(time - 0.1 - delay, 0.0)
    expected = since
    if time_constant:
        expected = since + time_constant * np.expm1(-since / time_constant)
    # the kink lies between two samples
    assert found == pytest.approx(expected, abs=4e-4)


@pytest.mark.parametrize("time_constant", [0.002, 0.02])
@pytest.mark.parametrize("delay", [0.0, 0.0062])
def test_every_fourth_sample_of_a_smooth_signal_tells_its_response(delay, time_constant):
    """Of 1 kHz: a cosine that begins at a crest, behind a differential equation and a shift."""
    frequency = 30.0
    time = 0.004 * np.arange(200)
    since = np.maximum(time - 0.2, 0.0)
    found = responded(
        1 - np.cos(frequency * since)[np.newaxis],
        0.001,
        delay=delay,
        time_constant=time_constant,
        stride=4,
    )[0]
    since = np.maximum(time - 0.2 - delay, 0.0)
    turn = frequency * time_constant
    wave = (np.cos(frequency * since) + turn * np.sin(frequency * since)) / (1 + turn**2)
    start = np.exp(-since / time_constant) * (1 - 1 / (1 + turn**2))
    # linear between these samples it would miss by 0.0012
    assert found == pytest.approx(1 - wave - start, abs=3e-4)


@pytest.mark.long
def test_delay_and_filter_of_a_log_of_1_khz_are_those_of_its_every_fourth_sample():
    """The motion is smooth enough for either; at 1 kHz four times as many samples are logged."""
    fast, slow = (
        timing(logged(delay=0.006, time_constant=0.01, every=every, noise=noise))
        for every, noise in ((1, 0.3), (4, 0.15))
    )
    error = (fast.shift.high - fast.shift.low) / 4
    assert fast.starts == slow.starts
    assert fast.shift.low < 0.016 < fast.shift.high
    assert fast.shift.value == pytest.approx(slow.shift.value, abs=2 * error)
    assert fast.time_constant.low < 0.01 < fast.time_constant.high


@pytest.mark.skipif(not REAL.is_dir(), reason=f"no real logs beside the project: {REAL}")
def test_what_is_planted_into_a_real_log_is_found(tmp_path):
    """KUKA KR3: seven moves at 46 to 320 deg/s, 12 ms."""
    ingest([REAL / "kuka-kr3" / "PTP_Vel"], tmp_path, IngestSettings(joints=(3,)))
    pair(tmp_path)
    separate(tmp_path)
    torques = tables.read(tmp_path / TORQUES, schemas.TORQUES)
    problem, _ = build_problems(torques, "motor")
    (log,) = ramp_logs(tmp_path / RAMPS, tables.facts(tmp_path / TORQUES)["sign"]).values()
    samples = tables.read(tmp_path / SAMPLES, schemas.SAMPLES)
    assert (tmp_path / STARTS).exists()

    def planted(delay, time_constant):
        torque = samples.groupby("recording", observed=True)["torque"].transform(
            lambda values: responded(
                values.to_numpy()[np.newaxis], 0.012, delay=delay, time_constant=time_constant
            )[0]
        )
        changed = samples[["recording", "time"]].assign(torque=torque)
        rows = log.starts.drop(columns="torque").merge(changed, on=["recording", "time"])
        assert len(rows) == len(log.starts)
        return torque_timing(replace(log, starts=rows), problem, "motor")

    own, late, filtered = planted(0.0, 0.0), planted(0.012, 0.0), planted(0.0, 0.04)
    # its torque is half a sample late
    assert own.best == late.best == "torque_delay"
    assert late.shift.value - own.shift.value == pytest.approx(0.012, abs=0.002)
    assert filtered.log_odds > 3
    assert filtered.time_constant.low < 0.04 < filtered.time_constant.high
    assert filtered.shift.value - own.shift.value == pytest.approx(0.04, abs=0.004)
