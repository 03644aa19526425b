"""Faults that were planted in a log are reported with their number; in clean logs none are."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli.inspection.inspect import inspect
from frictioncli.inspection.monitors.log_histogram import LogHistogram
from frictioncli.inspection.remarks import remarks
from frictioncli.logs.settings import IngestSettings

from .faulty import COLUMNS, PERIOD, clean_log, moving, write

TIME, POSITION, VELOCITY, TORQUE, TEMPERATURE = COLUMNS


def look(log, folder, digits=6, **told):
    """Return what is found in one log, and in its joint."""
    path = write(log, folder / "log.csv", digits)
    (found,) = inspect([path], IngestSettings(**told)).files
    assert found.refusal == ""
    return found, found.joints[0]


def kinds(found):
    return {remark.kind for remark in remarks(found)} - {"note"}


@pytest.mark.parametrize("seed", range(30))
def test_a_clean_log_gives_no_false_alarm(tmp_path, seed):
    rng = np.random.default_rng([seed, 1])
    log = clean_log(
        seed,
        speeds=rng.uniform(5, 150, 4),
        reach=rng.uniform(30, 120),
        pause=rng.choice([0.0, 0.3, 3.0]),
        period=rng.choice([0.001, 0.004, 0.012, 0.05]),
        jitter=rng.choice([0.0, 2e-5]),
        noise=rng.choice([0.05, 0.3, 2.0]),
    )
    if seed % 3 == 1:  # rounded as real logs are, torque to 0.01 and position to 0.001
        log[TORQUE], log[POSITION] = log[TORQUE].round(2), log[POSITION].round(3)
    if seed % 3 == 2:  # velocity differentiated from position
        log = log.drop(columns=VELOCITY)
    found, joint = look(log, tmp_path)
    assert kinds(found) == set()
    assert joint.velocity_agreement is None or joint.velocity_agreement == pytest.approx(
        1, abs=0.01
    )


@pytest.mark.parametrize("period", [0.001, 0.004, 0.012, 0.5])
def test_period_and_rate(tmp_path, period):
    found, _ = look(clean_log(period=period, speeds=(10, 10)), tmp_path)
    assert found.sampling.nominal_period_s == pytest.approx(period, rel=1e-6)
    assert found.sampling.rate_hz == pytest.approx(1 / period, rel=1e-6)
    assert found.sampling.jitter_s == 0


def test_jitter_is_measured(tmp_path):
    """Independent times with a deviation s have steps with a deviation of s times sqrt 2."""
    found, _ = look(clean_log(jitter=0.0008), tmp_path)
    assert found.sampling.jitter_s == pytest.approx(0.0008 * np.sqrt(2), rel=0.08)
    assert "jitter" in kinds(found)


def test_a_rate_below_the_usual_step(tmp_path):
    """Each third sample is lost: 66.7 Hz in fact where the usual step means 100."""
    log = clean_log()
    kept = log[np.arange(len(log)) % 3 != 2]
    found, _ = look(kept, tmp_path)
    text = next(remark.text for remark in remarks(found) if remark.kind == "rate")
    assert "66.6" in text or "66.7" in text
    assert "100 Hz" in text


def test_gaps_are_counted_and_the_longest_is_found(tmp_path):
    log = clean_log()
    lost = np.zeros(len(log), bool)
    for start, count in ((200, 30), (700, 80), (1200, 9)):
        lost[start : start + count] = True
    found, _ = look(log[~lost], tmp_path)
    longest = found.sampling.longest_gaps[0]
    assert found.sampling.gaps == 3
    assert found.sampling.gaps_s == pytest.approx((31 + 81 + 10) * PERIOD)
    assert longest.seconds == pytest.approx(81 * PERIOD)
    assert longest.at_s == pytest.approx(699 * PERIOD)
    assert longest.line == 2 + 700 - 30  # the header, and the rows before that are left
    assert found.sampling.missing_samples == 0


def test_samples_missing_between_others(tmp_path):
    log = clean_log()
    found, _ = look(log.drop(index=[300, 301, 640, 900]), tmp_path)
    assert found.sampling.missing_samples == 4
    assert found.sampling.gaps == 0


def test_a_damaged_step_is_no_number_of_missing_samples():
    """1e300 s over a period of 1e-10 s is more than a number can be."""
    steps = LogHistogram()
    steps.add(np.array([1e-10] * 50 + [3e-10, 1e300]))
    assert steps.missing_samples(1e-10, 5e-10) == 2


def test_duplicated_times(tmp_path):
    log = clean_log()
    twice = log.loc[np.repeat(log.index, np.where(np.isin(log.index, [50, 400, 401]), 2, 1))]
    found, _ = look(twice, tmp_path)
    assert found.sampling.duplicated_times == 3
    assert found.rejected == {"duplicate_time": 3}


@pytest.mark.parametrize("count", [1, 3, 7])
def test_held_samples(tmp_path, count):
    log = clean_log()
    rng = np.random.default_rng(count)
    inside = moving(log)[10:-10]
    where = np.sort(rng.choice(inside[::5], count, replace=False))
    for row in where:
        log.loc[row, [POSITION, VELOCITY, TORQUE]] = log.loc[row - 1, [POSITION, VELOCITY, TORQUE]]
    found, joint = look(log, tmp_path)
    assert joint.held_samples == count
    assert joint.held_line == where[0] + 2
    assert "held" in kinds(found)


def test_every_sample_is_there_twice(tmp_path):
    """A logger that asks twice as fast as the controller answers: half of all motion is held."""
    log = clean_log(period=0.02)
    twice = log.loc[np.repeat(log.index, 2)].reset_index(drop=True)
    twice[TIME] = np.arange(len(twice)) * 0.01
    _, joint = look(twice, tmp_path)
    moved = int((np.abs(log[VELOCITY]) > 5).sum())
    assert joint.held_samples == pytest.approx(moved, rel=0.1)


def test_slow_motion_of_a_coarse_position_is_not_held(tmp_path):
    """At 0.5 deg/s a position in steps of 0.1 deg repeats 20 times, and calm torque does too."""
    log = clean_log(speeds=(0.5,), reach=3, noise=0.0)
    log[POSITION], log[VELOCITY] = log[POSITION].round(1), log[VELOCITY].round(0)
    log[TORQUE] = log[TORQUE].round(0)
    path = write(log, tmp_path / "log.csv")
    (found,) = inspect([path]).files
    assert found.joints[0].held_samples == 0


def test_a_clock_that_is_set_back(tmp_path):
    log = clean_log()
    line = 1900
    log.loc[line:, TIME] -= log.loc[line, TIME]
    found, _ = look(log, tmp_path)
    (reset,) = found.sampling.resets
    assert reset.line == line + 2
    assert reset.before_s == pytest.approx((line - 1) * PERIOD)
    assert reset.after_s == pytest.approx(0, abs=1e-9)


def test_wild_times_are_no_reset(tmp_path):
    log = clean_log()
    log.loc[300, TIME] = 99999.0
    log.loc[500, TIME] = 0.0
    found, _ = look(log, tmp_path)
    assert found.sampling.resets == ()
    assert found.sampling.backward_times == 2
    assert "disorder" in kinds(found)


def test_the_clock_of_a_controller(tmp_path):
    log = clean_log()
    log[TIME] += 10578.16
    found, _ = look(log, tmp_path)
    assert found.sampling.begins_s == pytest.approx(10578.16)
    assert "uptime" in kinds(found)


def test_another_clock_that_runs_slow(tmp_path):
    """A second time column in ms loses 0.5 %, and its stamps are 30 ms late at one place."""
    log = clean_log()
    log["timestamp [ms]"] = 4e6 + 995.0 * log[TIME]
    log.loc[700, "timestamp [ms]"] += 30
    found, _ = look(log, tmp_path)
    (clock,) = found.clocks
    assert clock.column == "timestamp [ms]"
    assert clock.rate == pytest.approx(0.995, abs=1e-5)
    assert clock.departs_s == pytest.approx(0.005 * log[TIME].max(), rel=1e-3)
    assert "clocks" in kinds(found)


def test_torque_that_is_cut_off(tmp_path):
    log = clean_log()
    limit = 40.0
    over = (log[TORQUE] > limit) & (log[VELOCITY].abs() > 1)
    log[TORQUE] = log[TORQUE].clip(upper=limit)
    found, joint = look(log, tmp_path)
    (cut,) = joint.limits
    assert cut.torque == limit
    assert cut.samples == pytest.approx(int(over.sum()), rel=0.02)
    runs = over.ne(over.shift()).cumsum()[over]
    assert cut.longest == pytest.approx(int(runs.value_counts().max()), abs=4)
    assert "limit" in kinds(found)


@pytest.mark.parametrize(("channel", "size"), [(POSITION, 3.0), (VELOCITY, 25.0), (TORQUE, 15.0)])
def test_spikes(tmp_path, channel, size):
    log = clean_log()
    where = [320, 777, 1500]
    log.loc[where, channel] += [size, -size, 1.5 * size]
    _, joint = look(log, tmp_path)
    quantity = {POSITION: "position", VELOCITY: "velocity", TORQUE: "torque"}[channel]
    (spikes,) = joint.spikes
    assert (spikes.quantity, spikes.count, spikes.line) == (quantity, 3, 322)
    assert spikes.farthest == pytest.approx(1.5 * size, rel=0.1)


@pytest.mark.parametrize(
    ("channel", "step"),
    [(POSITION, 0.1), (POSITION, 0.025), (TORQUE, 0.5), (VELOCITY, 0.25), (TEMPERATURE, 1.0)],
)
def test_steps_of_rounded_channels(tmp_path, channel, step):
    log = clean_log(speeds=(3, 20, 40))
    if channel == TEMPERATURE:
        log[channel] = 20.0 + np.floor(12 * np.arange(len(log)) / len(log))
    log[channel] = (log[channel] / step).round() * step
    _, joint = look(log, tmp_path)
    found = next(c for c in joint.channels if c.column == channel)
    assert found.grid.step == pytest.approx(step, rel=1e-6)
    assert found.grid.certainty > 0.97


def test_a_brake_that_is_closed(tmp_path):
    """Torque frozen at standstill for 3.0 and 2.0 s, and a stand of 0.5 s that is left as it is."""
    log = clean_log(pause=4.0)
    log.loc[50:349, TORQUE] = 3.21
    second = len(log) - 250
    log.loc[second : second + 199, TORQUE] = 3.21
    found, joint = look(log, tmp_path)
    assert joint.frozen_spans == 2
    assert joint.frozen_s == pytest.approx(5.0, abs=0.05)
    assert "frozen" in kinds(found)


@pytest.mark.parametrize(("open_", "closed"), [(63.0, 0.0), (0.0, 1.0), (1.0, 0.0)])
def test_a_brake_column_means_what_motion_says(tmp_path, open_, closed):
    log = clean_log(pause=2.0)
    shut = np.zeros(len(log), bool)
    shut[20:150] = shut[-120:] = True
    log["BRAKE_SIG"] = np.where(shut, closed, open_)
    _, joint = look(log, tmp_path)
    assert joint.brake_closed_s == pytest.approx(shut.sum() * PERIOD, abs=2 * PERIOD)


def test_stale_first_rows_are_counted(tmp_path):
    log = clean_log(pause=0.5)
    log.loc[:1, POSITION] += 20.0
    found, _ = look(log, tmp_path)
    assert found.rejected == {"stale_first_rows": 2}
    assert "stale first rows" in kinds(found)


def test_a_velocity_that_is_not_the_derivative(tmp_path):
    """7 % off: the units are believed all the same, and it is said."""
    log = clean_log()
    log[VELOCITY] *= 0.93
    found, joint = look(log, tmp_path)
    assert joint.velocity_agreement == pytest.approx(1 / 0.93, rel=0.01)
    assert "velocity" in kinds(found)


def test_a_constant_channel(tmp_path):
    log = clean_log()
    log["load_2 [Nm]"] = 3.0
    found, joint = look(log, tmp_path)
    channel = next(c for c in joint.channels if c.quantity == "load")
    assert channel.constant
    assert "constant" in kinds(found)


@settings(max_examples=12)
@given(size=st.integers(300, 60_000), seed=st.integers(0, 5))
def test_what_is_found_does_not_depend_on_batches(tmp_path_factory, size, seed):
    log = clean_log(seed)
    log.loc[[333, 888], TORQUE] += 20
    log = log.drop(index=[500, 501, 502, 503, 504, 505])
    path = write(log, tmp_path_factory.mktemp("log") / "log.csv")
    whole = inspect([path], IngestSettings(batch_bytes=1 << 24))
    assert inspect([path], IngestSettings(batch_bytes=size)) == whole


def test_windows_carry_what_crosses_their_borders(tmp_path):
    """A log of several windows: faults on both sides of each border are counted once."""
    log = pd.concat([clean_log(seed) for seed in range(40)], ignore_index=True)
    log[TIME] = np.arange(len(log)) * PERIOD
    assert len(log) > 2 * (1 << 15) + 100
    lost = [(1 << 15) + 3 + i for i in range(20)]
    log.loc[[(1 << 15) - 1, (2 << 15) + len(lost)], TORQUE] += 500
    log = log.drop(index=lost)
    found, joint = look(log, tmp_path)
    assert found.sampling.gaps == 1
    assert found.sampling.samples == len(log)
    assert [(s.quantity, s.count, s.line) for s in joint.spikes] == [("torque", 2, (1 << 15) + 1)]
