"""Torque that is logged late: the delay by pairs, and friction freed of what it adds.

Logs are made move by move from friction and gravity at the earlier angle, not from the derivative.
"""

import numpy as np
import pandas as pd
import pytest

from frictioncli.model.fitting import fit_joint
from frictioncli.model.late_torque import late_column, torque_delay, without_delay
from frictioncli.model.settings import FitSettings

TAU_C, ALPHA, BETA, GAMMA, DELTA = 9.0, 0.0015, 2.0, 8.0, 0.04
GRAVITY = 60.0


def joint(delay, *, low=5.0, high=95.0, speeds=(5.0, 20.0, 50.0, 100.0), days=1, noise=0.05, **law):
    """Return separated torques of a joint whose torque is late by so much.

    ``by_angle`` is friction that belongs to the angle, ``with_speed`` friction of load and speed,
    ``payload`` what is carried in every second pair.
    """
    generator = np.random.default_rng(law.get("seed", 3))
    with_speed = law.get("with_speed", lambda load, speed: 0.0 * load)
    by_angle = law.get("by_angle", lambda angle: 0.0 * angle)
    angle = np.arange(low, high, 6.0)
    rows = []
    for day in range(days):
        for pair, (temperature, speed) in enumerate(
            (t, v) for t in np.linspace(20.0, 50.0, 25) for v in speeds
        ):
            mass = law.get("payload", 0.0) * (pair % 2)

            def torque(q, sign, speed=speed, temperature=temperature, mass=mass):
                load = (GRAVITY + 10.0 * mass) * np.cos(np.radians(q))
                viscous = BETA + GAMMA * np.exp(-DELTA * temperature)
                friction = TAU_C + ALPHA * load**2 + viscous * np.sqrt(speed) + by_angle(q)
                friction = friction + with_speed(load, speed)
                return load + sign * friction

            forward = torque(angle - speed * delay, 1) + noise * generator.normal(size=len(angle))
            reverse = torque(angle + speed * delay, -1) + noise * generator.normal(size=len(angle))
            rows.append(
                pd.DataFrame(
                    {
                        "run": f"day{day}",
                        "joint": 1,
                        "pair": pair,
                        "time": 120.0 * pair,
                        "speed": speed,
                        "position": angle,
                        "friction_torque": (forward - reverse) / 2,
                        "load_torque": (forward + reverse) / 2,
                        "motor_temperature": temperature,
                        "housing_temperature": np.nan,
                        "payload": mass,
                    }
                )
            )
    return pd.concat(rows, ignore_index=True)


@pytest.mark.parametrize("delay", [0.0, 0.012, 0.04])
def test_the_delay_is_that_of_the_log(delay):
    found = torque_delay(joint(delay))
    assert found.interval[0] < delay < found.interval[1]
    assert found.error < 0.004


def test_gravity_of_two_payloads_is_two_gravities():
    found = torque_delay(joint(0.03, payload=4.0))
    assert found.interval[0] < 0.03 < found.interval[1]
    assert found.error < 0.004


@pytest.mark.parametrize(
    "by_angle",
    [
        lambda angle: 2.0 * np.sin(np.radians(7.0 * angle)),
        lambda angle: 5.0 * np.exp(-(((angle - 60.0) / 8.0) ** 2)),
        lambda angle: 0.05 * angle,
    ],
    ids=["ripple", "bump", "slope"],
)
def test_friction_that_belongs_to_the_angle_is_no_delay(by_angle):
    found = torque_delay(joint(0.0, by_angle=by_angle))
    assert found is None or found.interval[0] < 0.0 < found.interval[1]


def of_gear(size, load_power, speed_power):
    """Return friction of a gear that is so large [N·m] at 50 N·m and 50 deg/s."""
    return lambda load, speed: (
        size * (np.abs(load) / 50.0) ** load_power * (speed / 50.0) ** speed_power
    )


@pytest.mark.parametrize("delay", [0.0, 0.027])
@pytest.mark.parametrize(
    "law", [(2.0, 2.0, 0.5), (2.0, 1.0, 1.0), (1.5, 1.7, 0.6), (-1.0, 1.3, 0.4)], ids=str
)
@pytest.mark.parametrize("low", [5.0, -40.0])
def test_friction_that_grows_with_load_and_speed_is_no_delay(low, law, delay):
    """At 100 deg/s 1 N·m of it is as much as 10 ms of gravity's slope, 1 N·m per 0.6 deg."""
    found = torque_delay(joint(delay, low=low, high=low + 120.0, with_speed=of_gear(*law)))
    assert found.interval[0] <= delay <= found.interval[1]
    assert abs(found.value - delay) < 0.006


def test_intervals_hold_the_delay_of_nineteen_joints_in_twenty():
    """Joints whose stroke, delay and law of load and speed are drawn; half have no such law."""
    generator = np.random.default_rng(17)
    held = []
    for seed in range(40):
        low = generator.uniform(-80.0, 50.0)
        delay = generator.uniform(0.0, 0.05)
        law = generator.uniform((0.5, 1.2, 0.4), (2.0, 2.3, 1.0)) * (seed % 2, 1.0, 1.0)
        high = low + generator.uniform(60.0, 140.0)
        rows = joint(delay, low=low, high=high, noise=0.2, seed=seed, with_speed=of_gear(*law))
        found = torque_delay(rows)
        held += [] if found is None else [found.interval[0] <= delay <= found.interval[1]]
    assert len(held) > 30
    assert np.mean(held) >= 0.9


def test_a_joint_without_such_friction_keeps_its_precision():
    """The error is less than 3 ms; of free columns it would be several times as large."""
    assert torque_delay(joint(0.02, low=5.0, high=175.0, noise=0.2)).error < 0.003


def test_a_few_bins_do_not_tell_a_delay():
    rows = joint(0.03, speeds=(20.0, 100.0))
    assert torque_delay(rows[(rows["pair"] < 2) & (rows["position"] < 20.0)]) is None


def test_without_gravity_or_with_one_speed_nothing_tells_a_delay():
    flat = joint(0.03)
    flat["load_torque"] = 1.0
    assert torque_delay(flat) is None
    assert torque_delay(joint(0.03, speeds=(50.0,))) is None


def test_no_log_is_late_by_a_second():
    assert torque_delay(joint(-0.2, speeds=(5.0, 10.0, 20.0))) is None


@pytest.mark.parametrize("delay", [0.0, 0.03])
def test_the_intervals_of_a_fit_hold_the_friction_of_a_joint_whose_torque_is_late(delay):
    """Over 5 to 95 deg, 30 ms at 100 deg/s are 2.5 N·m of friction that is none."""
    model = fit_joint(joint(delay), {}, FitSettings())
    for name, truth in zip(
        ("tau_c", "alpha", "beta", "gamma", "delta"),
        (TAU_C, ALPHA, BETA, GAMMA, DELTA),
        strict=True,
    ):
        low, high = model.parameters[name].ci95
        assert low <= truth <= high, name
    assert model.parameters["alpha"].estimate == pytest.approx(ALPHA, rel=0.08)
    assert model.delay.ci95[0] <= delay <= model.delay.ci95[1]
    assert any("lags the position" in note for note in model.notes) == (delay > 0)


def test_where_no_moves_tell_a_delay_the_intervals_allow_for_one():
    """Fast moves below 50 deg and slow ones above: no angle has both speeds."""
    rows = joint(0.015, speeds=(20.0, 100.0))
    rows = rows[(rows["speed"] > 50.0) == (rows["position"] < 50.0)]
    model = fit_joint(rows, {}, FitSettings())
    assert model.delay is None
    for name, truth in (("tau_c", TAU_C), ("alpha", ALPHA), ("beta", BETA)):
        low, high = model.parameters[name].ci95
        assert low <= truth <= high, name
    assert any("do not tell whether the torque lags" in note for note in model.notes)


def test_the_paper_s_method_takes_torques_as_they_are():
    up = joint(0.03)
    down = up.assign(pair=up["pair"] + 1000, time=1e5 - up["time"])
    rows = pd.concat([up.assign(phase="heat-up"), down.assign(phase="cool-down")])
    rows["motor_temperature_reading"] = np.nan
    assert fit_joint(rows, {}, FitSettings(method="paper")).delay is None


def test_freed_friction_is_that_of_a_log_without_delay():
    late, early = joint(0.02, noise=0.0), joint(0.0, noise=0.0)
    added = late["friction_torque"] - early["friction_torque"]
    freed = without_delay(late, 0.02)["friction_torque"] - early["friction_torque"]
    assert np.sqrt(np.mean(freed**2)) < 0.05 * np.sqrt(np.mean(added**2))
    assert without_delay(late, None) is late
    assert len(without_delay(late.iloc[:0], 0.02)) == 0


def test_a_load_that_does_not_change_along_the_angle_has_no_late_torque():
    rows = joint(0.0).assign(load_torque=3.0)
    np.testing.assert_allclose(late_column(rows), 0.0, atol=1e-9)


def test_friction_that_does_not_oppose_the_motion_is_doubted():
    rows = joint(0.0)
    rows.loc[rows["pair"] % 2 == 0, "friction_torque"] *= -1.0
    (note,) = fit_joint(rows, {}, FitSettings()).notes
    assert "50 % of the pairs only" in note
    assert not fit_joint(joint(0.0), {}, FitSettings()).notes
