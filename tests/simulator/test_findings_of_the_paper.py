"""The paper's findings come out of the simulation; none of them is an input."""

import numpy as np
import pytest
from scipy.optimize import curve_fit

from frictioncli.simulator import default_joint
from frictioncli.simulator.paper_protocol import run_program
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.thermal_history import HOUSING, MOTOR
from frictioncli.simulator.thermal_network import Ambient

ASKED = SynthesisSettings()
SPEEDS = default_joint.PROGRAM.cycle_speeds
CORRECTION_SPEED = SPEEDS.index(67.5)


def branches(run: int = 0, motor_heat_share: float | None = None) -> dict[str, dict]:
    """Return time, temperatures and friction at L = 0 of each branch, per series and speed."""
    share = ASKED.motor_heat_share[run] if motor_heat_share is None else motor_heat_share
    joint = default_joint.joint(payload=ASKED.payload, motor_heat_share=share)
    ambient = Ambient(start=ASKED.ambient[run], drift=ASKED.ambient_drift[run])
    history, series = run_program(joint, default_joint.PROGRAM, ambient)
    middle = np.add(default_joint.PROGRAM.trip_begins(joint.servo, SPEEDS), (10.0, 5.0, 3.0, 2.0))
    found = {}
    for phase in ("heat-up", "cool-down"):
        starts = np.array([one.start for one in series if one.phase == phase])
        temperatures = history.at(starts[:, np.newaxis] + middle)
        speed = np.broadcast_to(SPEEDS, temperatures[MOTOR].shape)
        friction = joint.friction(load=0.0, speed=speed, temperatures=temperatures)
        found[phase] = {
            "start": starts,
            "motor": temperatures[MOTOR],
            "housing": temperatures[HOUSING],
            "gear": temperatures["gear"],
            "friction": friction,
        }
    return found


@pytest.fixture(scope="module", params=[0, 1], ids=["day1", "day2"])
def run(request):
    return branches(request.param)


def gap(run, abscissa, at: np.ndarray, speed: int = CORRECTION_SPEED) -> np.ndarray:
    """Return friction while heating less friction while cooling, at equal abscissa."""
    up, down = (
        np.interp(at, *sorted_by(abscissa(run[phase])[:, speed], run[phase]["friction"][:, speed]))
        for phase in ("heat-up", "cool-down")
    )
    return up - down


def sorted_by(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(x)
    return x[order], y[order]


def test_durations_of_the_paper(run):
    top = run["cool-down"]["start"][0]
    assert (top - run["heat-up"]["start"][0]) / 60.0 == pytest.approx(100.0, rel=0.2)
    assert (run["cool-down"]["start"][-1] - top) / 60.0 == pytest.approx(300.0, rel=0.2)


def test_a_series_at_each_degree(run):
    registered = {phase: np.floor(run[phase]["motor"] + 0.5)[:, 0] for phase in run}
    assert len(registered["heat-up"]) == len(registered["cool-down"]) == 40
    assert np.all(np.diff(registered["heat-up"]) >= 0.0)
    assert np.all(np.diff(registered["cool-down"]) <= 0.0)


def test_motor_is_hottest_and_housing_coolest_measured_point(run):
    for phase in run.values():
        assert np.all(phase["motor"] > phase["housing"])


def test_friction_falls_by_up_to_half_over_the_heat_up(run):
    ratio = run["cool-down"]["friction"][0] / run["heat-up"]["friction"][0]
    assert np.all(ratio > 0.5)
    assert np.all(ratio < 0.7)


@pytest.mark.parametrize("weight", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_branches_differ_for_every_linear_mix_of_both_temperatures(run, weight):
    def mix(phase):
        return weight * phase["motor"] + (1.0 - weight) * phase["housing"]

    ends = [(mix(phase).min(), mix(phase).max()) for phase in run.values()]
    low, high = max(e[0] for e in ends), min(e[1] for e in ends)
    assert high > low + 5.0
    assert np.abs(gap(run, mix, np.linspace(low, high, 50))).max() > 1.0


def left_by_refit(run, temperature) -> float:
    """Return the RMS at L = 0 that equation (16), fitted to both branches, leaves [N·m].

    At L = 0 alpha has no part. For each delta the other three parameters are linear; they have no
    sign here, which can only lower the RMS.
    """
    speed = np.concatenate(
        [np.broadcast_to(SPEEDS, p["motor"].shape).ravel() for p in run.values()]
    )
    warmth = np.concatenate([temperature(phase).ravel() for phase in run.values()]) - 40.0
    friction = np.concatenate([phase["friction"].ravel() for phase in run.values()])
    root = np.sqrt(speed)
    left = []
    for delta in np.geomspace(0.002, 0.4, 120):
        design = np.column_stack([np.ones_like(root), root, root * np.exp(-delta * warmth)])
        found, *_ = np.linalg.lstsq(design, friction, rcond=None)
        left.append(np.sqrt(np.mean(np.square(design @ found - friction))))
    return float(min(left))


def test_no_mix_of_both_temperatures_explains_the_friction_but_the_gears_own_does(run):
    left = [
        left_by_refit(run, lambda phase, w=w: w * phase["motor"] + (1.0 - w) * phase["housing"])
        for w in np.linspace(-0.3, 1.3, 33)
    ]
    assert min(left) > 2.0
    assert left_by_refit(run, lambda phase: phase["gear"]) < min(left) / 2.0


def test_motor_heated_joint_has_more_friction_while_heating_and_gear_heated_less():
    middle = np.array([35.0, 45.0, 55.0])
    for share, sign in ((0.8, 1.0), (0.0, -1.0)):
        loop = gap(branches(motor_heat_share=share), lambda phase: phase["motor"], middle)
        assert np.all(sign * loop > 0.5)


def law(inputs, tau_c, beta, gamma, delta):
    """Return friction at L = 0 by the published law."""
    speed, temperature = inputs
    return tau_c + (beta + gamma * np.exp(-delta * temperature)) * np.sqrt(speed)


def test_means_of_both_branches_follow_the_published_law(run):
    mean = {phase: (run[phase]["motor"] + run[phase]["housing"]) / 2.0 for phase in run}
    speeds, temperatures, friction = [], [], []
    for number, speed in enumerate(SPEEDS):
        low = max(mean[phase][:, number].min() for phase in run)
        high = min(mean[phase][:, number].max() for phase in run)
        at = np.linspace(low, high, 40)
        both = [
            np.interp(at, *sorted_by(mean[phase][:, number], run[phase]["friction"][:, number]))
            for phase in run
        ]
        speeds.append(np.full(40, speed))
        temperatures.append(at)
        friction.append(np.mean(both, axis=0))
    inputs = np.concatenate(speeds), np.concatenate(temperatures)
    measured = np.concatenate(friction)
    found, _ = curve_fit(law, inputs, measured, p0=(10.0, 3.0, 15.0, 0.05))
    # Published: 10.57, 3.48, 15.66 and 0.056.
    assert found[0] == pytest.approx(10.57, rel=0.25)
    assert found[1] == pytest.approx(3.48, rel=0.25)
    assert found[2] == pytest.approx(15.66, rel=0.25)
    assert 0.045 <= found[3] <= 0.067
    assert np.sqrt(np.mean((law(inputs, *found) - measured) ** 2)) < 1.0


def corrected(phase, k: float = 5.0, longest: float = 3600.0) -> list[int]:
    """Return the series at which Algorithm 3 corrects, by the first-degree reading."""
    registered = np.floor(phase["motor"][:, 0] + 0.5)
    chosen = [0]
    first_degree = None
    for number in range(1, len(registered)):
        passed = phase["start"][number] - phase["start"][chosen[-1]]
        if first_degree is None and abs(registered[number] - registered[chosen[-1]]) >= 1.0:
            first_degree = passed
        if passed > min(longest if first_degree is None else k * first_degree, longest):
            chosen.append(number)
            first_degree = None
    return chosen


def error(phase, parameters, chosen: list[int]) -> float:
    """Return the error of friction estimated with corrections at the chosen series."""
    tau_c, beta, gamma, delta = parameters
    estimates = []
    correction = 0.0
    for number, (friction, motor) in enumerate(zip(phase["friction"], phase["motor"], strict=True)):
        if number in chosen:
            viscous = (friction[CORRECTION_SPEED] - tau_c) / np.sqrt(67.5) - beta
            correction = -np.log(viscous / gamma) / delta - motor[CORRECTION_SPEED]
        estimates.append(law((np.array(SPEEDS), motor + correction), *parameters))
    return float(np.sqrt(np.mean((np.array(estimates) - phase["friction"]) ** 2)))


def test_about_seven_corrections_keep_the_error_within_2_newton_metres(run):
    inputs = tuple(
        np.concatenate([values.ravel() for values in pair])
        for pair in (
            [np.broadcast_to(SPEEDS, phase["motor"].shape) for phase in run.values()],
            [phase["motor"] for phase in run.values()],
        )
    )
    measured = np.concatenate([phase["friction"].ravel() for phase in run.values()])
    parameters, _ = curve_fit(law, inputs, measured, p0=(10.0, 3.0, 15.0, 0.05))
    for phase in run.values():
        chosen = corrected(phase)
        assert 4 <= len(chosen) <= 8
        assert 0.8 < error(phase, parameters, chosen) < 2.0
        assert error(phase, parameters, []) > 1.5 * error(phase, parameters, chosen)


def test_friction_of_a_cold_joint_follows_the_square_root_down_to_the_slowest_sweep():
    joint = default_joint.joint(payload=ASKED.payload, motor_heat_share=ASKED.motor_heat_share[0])
    speed = np.array(default_joint.PROGRAM.sweep_speeds)
    cold = dict.fromkeys(joint.network.names, 20.0)
    friction = joint.friction(load=0.0, speed=speed, temperatures=cold)
    fast = speed >= min(SPEEDS)
    slope, tau_c = np.polyfit(np.sqrt(speed[fast]), friction[fast], 1)
    assert np.abs(tau_c + slope * np.sqrt(speed) - friction).max() < 2.0
    assert np.all(np.diff(friction) > 0.0)  # no Stribeck rise
