"""Nuisances: requests, true values, and that bins and traces show the same of each."""

import json

import numpy as np
import pandas as pd
import pytest

from frictioncli.errors import OptionError
from frictioncli.simulator.nuisances.catalogue import NUISANCES, requested_nuisances
from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.nuisances.motion_and_torque import filtered
from frictioncli.simulator.settings import SynthesisSettings
from frictioncli.simulator.synthesize import synthesize
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from frictioncli.workfiles import TORQUES
from tests.simulation.torque_table import simulate_torques, simulate_world
from tests.studies.blind_truth import delay_and_filter

SHORT = {"runs": 1, "seed": 3, "lowest": 25, "highest": 27, "joint_kind": "plain"}
CHANNELS = ("friction_torque", "load_torque")

ON_TORQUE = {
    "torque_delay": 0.018,
    "torque_filter": 0.04,
    "gravity_constant": 4.0,
    "torque_offset": -3.0,
    "speed_ripple": 0.2,
    "backlash": 0.2,
    "friction_zones": 0.08,
    "other_joint": 8.0,
    "ambient_breathing": 2.0,
    "speed_offset": 2.0,
    "stroke_side": 2.0,
    "angle_bump": 2.0,
    "grease_wave": 2.0,
}
"""Size of each nuisance that changes torque in a bin; the others are tested one by one."""

ON_OTHERS = {
    "move_noise",
    "velocity_scale",
    "sensor_lag",
    "sensor_step",
    "ambient_swing",
    "tooth_mesh",
}


def settings(*nuisances: str, **changes: object) -> SynthesisSettings:
    given = {"noise_scale": 0.0, **SHORT, **changes}
    return SynthesisSettings(nuisances=nuisances, **given)


@pytest.fixture(scope="module")
def traced(tmp_path_factory):
    known: dict[SynthesisSettings, pd.DataFrame] = {}

    def of(chosen: SynthesisSettings) -> pd.DataFrame:
        if chosen not in known:
            folder = tmp_path_factory.mktemp("traces")
            synthesize(folder / "logs", chosen)
            ingest([folder / "logs"], folder / "work")
            pair(folder / "work")
            separate(folder / "work")
            known[chosen] = pd.read_parquet(folder / "work" / TORQUES)
        return known[chosen]

    return of


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def change(with_it: pd.DataFrame, without: pd.DataFrame) -> pd.DataFrame:
    """Return what a nuisance changes in each bin."""
    both = with_it.merge(without, on=["pair", "position"], suffixes=("", "_without"))
    assert len(both) >= 0.98 * len(without)
    changes = {name: both[name] - both[f"{name}_without"] for name in CHANNELS}
    return both[["pair", "position", "speed"]].assign(**changes)


def test_every_nuisance_is_compared():
    assert set(ON_TORQUE) | ON_OTHERS == set(NUISANCES)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if number % 4 == 0 else pytest.mark.long)
        for number, name in enumerate(ON_TORQUE)
    ],
)
def test_bins_show_the_change_of_torque_that_traces_show(traced, name):
    chosen = settings(f"{name}:{ON_TORQUE[name]}")
    of_traces = change(traced(chosen), traced(settings()))
    of_bins = change(simulate_torques(chosen), simulate_torques(settings()))
    both = of_traces.merge(of_bins, on=["pair", "position"], suffixes=("", "_bins"))
    size = np.hypot(*(rms(both[name]) for name in CHANNELS))
    away = np.hypot(*(rms(both[name] - both[f"{name}_bins"]) for name in CHANNELS))
    assert size > 0.03
    assert away < 0.12 * size + 0.006


def test_teeth_finer_than_a_bin_are_as_loud_in_bins(traced):
    # which samples fall into a bin decides about each, so only the size can agree
    chosen = settings("tooth_mesh:4")
    of_traces = change(traced(chosen), traced(settings()))
    of_bins = change(simulate_torques(chosen), simulate_torques(settings()))
    slow = [rms(one.loc[one["speed"] < 25, "friction_torque"]) for one in (of_bins, of_traces)]
    assert slow[0] == pytest.approx(slow[1], rel=0.25)
    fast = [rms(one["friction_torque"]) for one in (of_bins, of_traces)]
    assert fast[0] == pytest.approx(fast[1], rel=0.35)


@pytest.mark.parametrize("kind", ["zones", "network"])
def test_all_together_are_the_same_in_bins(traced, kind):
    # teeth finer than a bin depend on which samples fall into it, see below
    chosen = settings("all", "tooth_mesh:0", joint_kind=kind, seed=8)
    world = simulate_world(chosen)
    both = traced(chosen).merge(world.torques, on=["pair", "position"], suffixes=("", "_bins"))
    assert len(both) >= 0.97 * len(world.torques)
    for name, most in (*((name, 0.08) for name in CHANNELS), ("speed", 0.02)):
        assert rms(both[name] - both[f"{name}_bins"]) < most
    assert rms(both["motor_temperature"] - both["motor_temperature_bins"]) < 0.4
    assert (world.nuisances.size("friction_zones") == 0.0) is (kind == "zones")


def test_noise_along_a_move_is_the_same_in_bins(traced):
    spreads, memories = [], []
    loud = settings("move_noise:2", noise_kind="white", noise_scale=1.0)
    for table, quiet in (
        (traced(loud), traced(settings())),
        (simulate_torques(loud), simulate_torques(settings())),
    ):
        noise = change(table, quiet).sort_values(["pair", "position"])
        fast = noise[noise["speed"] > 60.0]
        following = fast.groupby("pair")["load_torque"].shift(-1)
        spreads.append(rms(noise["load_torque"]))
        memories.append(
            float(np.corrcoef(fast["load_torque"][:-1], following[:-1].fillna(0))[0, 1])
        )
    assert spreads[0] == pytest.approx(spreads[1], rel=0.15)
    assert memories[0] > 0.3
    assert memories[0] == pytest.approx(memories[1], abs=0.2)


def test_clock_that_runs_slow_scales_the_velocity(traced):
    for speeds in (
        traced(settings("velocity_scale:0.5"))["speed"] / traced(settings())["speed"].iloc[-1],
        simulate_torques(settings("velocity_scale:0.5"))["speed"] / 101.2,
    ):
        assert speeds.iloc[-1] == pytest.approx(1.005, abs=3e-4)


def test_slow_sensor_is_behind_in_both(traced):
    # heating at about 0.4 K/min: the joint is warmer than it seems, so it has less friction
    chosen, noiseless = settings("sensor_lag:120"), settings()
    for slow, fast in (
        (traced(chosen), traced(noiseless)),
        (simulate_torques(chosen, rebuilt=False), simulate_torques(noiseless, rebuilt=False)),
    ):
        at = [
            table[(table["speed"] > 90) & (table["phase"].astype(str) == "heat-up")]
            for table in (slow, fast)
        ]
        warmer = at[0]["friction_torque"].mean() - at[1]["friction_torque"].mean()
        assert -4.5 < warmer < -0.3


def test_finer_step_of_the_sensor_is_registered(traced):
    readings = traced(settings("sensor_step:0.1"))["motor_temperature_reading"]
    tenths = np.mod(np.round(readings * 10), 10)
    assert len(np.unique(tenths)) > 4
    coarse = simulate_torques(settings("sensor_step:0.5"), rebuilt=False)["motor_temperature"]
    assert set(np.unique(np.mod(coarse, 1.0))) == {0.0, 0.5}


def test_ambient_changes_over_the_day():
    calm = simulate_world(settings(highest=45))
    swing = simulate_world(settings("ambient_swing:6", highest=45))
    assert swing.torques["time"].max() != pytest.approx(calm.torques["time"].max(), rel=0.01)


def test_three_zones_leave_about_one_per_cent_of_equation_16():
    table = simulate_torques(settings("friction_zones:0.07", highest=65))
    load, speed, warmth, friction = (
        table[name].to_numpy(float)
        for name in ("load_torque", "speed", "motor_temperature", "friction_torque")
    )
    misfits = []
    for delta in np.linspace(0.02, 0.12, 51):
        root = np.sqrt(speed)
        columns = np.column_stack(
            [np.ones(len(speed)), load**2, root, root * np.exp(-delta * warmth)]
        )
        fitted = columns @ np.linalg.lstsq(columns, friction, rcond=None)[0]
        misfits.append(rms(friction - fitted))
    assert 0.003 < min(misfits) / friction.mean() < 0.02


def test_filter_is_an_exponential():
    slow = requested_nuisances(("torque_filter:0.04",), seed=0)
    time = np.arange(200) * 0.012
    ramp = filtered(time, 0.012, slow)
    assert ramp == pytest.approx(time - 0.04 * (1 - np.exp(-time / 0.04)), abs=1e-12)


def test_all_has_every_nuisance_in_an_ordinary_size():
    everything = requested_nuisances(("all",), seed=5)
    assert {one.name for one in everything.present} == set(NUISANCES)
    again, other = (requested_nuisances(("all",), seed=seed) for seed in (5, 6))
    assert everything == again != other
    for seed in range(20):
        drawn = requested_nuisances(("all",), seed=seed)
        assert 0.0 < drawn.size("torque_delay") < 0.018
        assert abs(drawn.size("gravity_constant")) < 4.0
        assert 0.1 < drawn.parameter("move_noise", "correlation_time") < 0.5
    without = requested_nuisances(("all", "backlash:0", "torque_delay:0.01"), seed=5)
    assert without.size("backlash") == 0.0
    assert without.size("torque_delay") == 0.01
    assert without.size("sensor_lag") == everything.size("sensor_lag")


def test_disturbances_have_their_share_of_the_mean_friction():
    clean = simulate_torques(settings(highest=40))
    world = simulate_world(settings("angle_bump:0.5", "grease_wave:0.4", highest=40))
    shares = {one.effect.name: one.rms for one in world.planted.disturbances}
    mean = clean["friction_torque"].mean()
    assert shares["angle_bump"] == pytest.approx(0.005 * mean, rel=0.02)
    assert shares["grease_wave"] == pytest.approx(0.004 * mean, rel=0.02)
    assert world.planted.effects == ()


def test_truth_tells_the_true_values(tmp_path):
    chosen = settings("all", "torque_delay:0.012", highest=26)
    summary = synthesize(tmp_path / "logs", chosen)
    truth = json.loads((tmp_path / "logs" / "truth.json").read_text(encoding="utf-8"))
    told = {one["name"]: one for one in truth["nuisances"]}
    assert set(told) == set(NUISANCES)
    assert told["torque_delay"] | {"description": ""} == {
        "name": "torque_delay",
        "description": "",
        "size": 0.012,
        "unit": "s",
        "parameters": {},
    }
    assert truth["settings"]["nuisances"] == ["all", "torque_delay:0.012"]
    assert "nuisance torque_delay, 0.012 s" in str(summary)
    world = simulate_world(chosen)
    assert world.nuisances.truth() == truth["nuisances"]


def test_an_effect_has_the_same_size_with_nuisances():
    quiet = settings("all", effects=(), highest=35)
    hidden = settings("all", effects=("stroke_bump:1",), highest=35)
    one, other = simulate_torques(hidden), simulate_torques(quiet)
    assert np.array_equal(one["motor_temperature"], other["motor_temperature"])
    added = one[["torque_forward", "torque_reverse"]] - other[["torque_forward", "torque_reverse"]]
    assert rms(added) == pytest.approx(1.0, rel=0.05)


def test_nothing_asked_for_is_nothing():
    assert not requested_nuisances((), seed=1)
    assert not requested_nuisances(("torque_delay:0",), seed=1)
    assert Nuisances().size("backlash") == 0.0


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        (("gremlins",), "expected all or one of torque_delay, .*grease_wave"),
        (("torque_delay:late",), "expected a number from 0 to 0.1 s"),
        (("backlash:-0.1",), "from 0 to 1 deg"),
        (("backlash:nan",), "from 0 to 1 deg"),
        (("all", "all"), "2 times"),
    ],
)
def test_wrong_nuisances_are_refused(texts, told):
    with pytest.raises(OptionError, match=told):
        requested_nuisances(texts, seed=0)


def test_delay_and_filter_follow_from_the_moments_of_their_response():
    """The density is that of an exponential response that begins after the delay."""
    delay, time_constant = 0.012, 0.04
    time = np.linspace(delay, delay + 30 * time_constant, 200_001)
    density = np.exp(-(time - delay) / time_constant) / time_constant
    mean, second = (float(np.trapezoid(density * time**n, time)) / n for n in (1, 2))
    found = delay_and_filter(
        {"torque_delay": {"delay": mean}, "torque_filter": {"second_moment": second}}
    )
    assert found == pytest.approx({"delay": delay, "time_constant": time_constant}, rel=1e-5)


def test_without_a_filter_all_of_the_response_is_delay():
    found = delay_and_filter({"torque_delay": {"delay": 0.02}})
    assert found == {"delay": 0.02, "time_constant": 0.0}
