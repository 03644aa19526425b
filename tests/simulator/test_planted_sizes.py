"""Planted effects have the size that is asked for, in tables computed without traces."""

import numpy as np
import pytest

from frictioncli import schemas
from frictioncli.errors import OptionError
from frictioncli.simulator.planted.catalogue import EFFECTS, requested_effects
from frictioncli.simulator.settings import NOISE_KINDS, SynthesisSettings
from tests.simulation.torque_table import simulate_torques, simulate_world

BOTH = ["torque_forward", "torque_reverse"]


def settings(**changes: object) -> SynthesisSettings:
    plain = {"runs": 1, "seed": 7, "noise_scale": 0.0, "joint_kind": "plain"}
    return SynthesisSettings(**{**plain, **changes})


@pytest.fixture(scope="module")
def clean():
    return simulate_torques(settings())


def added(clean, **changes):
    table = simulate_torques(settings(**changes))
    assert np.array_equal(table["position"], clean["position"])
    return table[BOTH].to_numpy() - clean[BOTH].to_numpy()


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("name", EFFECTS)
def test_root_mean_square_is_the_size(clean, name):
    counted = np.ones((len(clean), 2), dtype=bool)
    if EFFECTS[name].at_reversal:
        position = clean["position"].to_numpy()
        counted = np.column_stack([position < 20.0, position > 160.0])
    for size in (0.4, 1.6):
        assert rms(added(clean, effects=(f"{name}:{size}",))[counted]) == pytest.approx(
            size, rel=0.05
        )


def test_two_effects_add_and_a_weak_magnet_multiplies_both(clean):
    ripple = added(clean, effects=("position_ripple:1",))
    pack = added(clean, effects=("dress_pack:1",))
    assert added(clean, effects=("dress_pack:1", "position_ripple:1")) == pytest.approx(
        ripple + pack
    )
    world = simulate_world(settings(effects=("torque_constant:1", "dress_pack:3")))
    assert [one.effect.name for one in world.planted.effects] == ["dress_pack", "torque_constant"]
    assert [one.rms for one in world.planted.effects] == pytest.approx([3.0, 1.0], rel=0.001)


def test_size_is_drawn_where_none_is_given():
    sizes = [
        simulate_world(settings(seed=seed, effects=("drift",))).planted.effects[0].rms
        for seed in range(4)
    ]
    assert len(set(sizes)) == 4
    assert all(0.49 < size < 2.01 for size in sizes)


def test_loop_of_a_hidden_gear_has_both_signs():
    signs = set()
    for seed in range(6):
        table = simulate_torques(settings(seed=seed, effects=("thermal_lag:2",)))
        bare = simulate_torques(settings(seed=seed))
        extra = table["friction_torque"] - bare["friction_torque"]
        warm = table["motor_temperature"].between(40.0, 50.0)
        heating = extra[warm & (table["phase"] == "heat-up")].mean()
        cooling = extra[warm & (table["phase"] == "cool-down")].mean()
        signs.add(np.sign(heating - cooling))
    assert signs == {-1.0, 1.0}


def test_table_is_that_of_the_stage(clean):
    assert tuple(clean.columns) == schemas.TORQUES.names
    assert clean.duplicated(["run", "pair", "position"]).sum() == 0
    assert clean["load"].isna().all()
    assert clean.groupby("pair")["time"].first().is_monotonic_increasing


def test_plain_joint_is_equation_16_exactly(clean):
    velocity_part = 3.48 + 15.66 * np.exp(-0.056 * clean["motor_temperature"])
    expected = 10.57 + 0.0014 * clean["load_torque"] ** 2 + velocity_part * np.sqrt(clean["speed"])
    # What is left: the square of the load within a bin, and the seconds between both directions.
    assert rms(clean["friction_torque"] - expected) < 0.03


@pytest.mark.parametrize("kind", NOISE_KINDS)
def test_noise_kinds(clean, kind):
    table = simulate_torques(settings(noise_scale=1.0, noise_kind=kind))
    error = table["friction_torque"] - clean["friction_torque"]
    slow, fast = (rms(error[mask]) for mask in (clean["speed"] < 20.0, clean["speed"] > 60.0))
    assert 0.05 < slow < fast < 1.0
    pairs = error.groupby(table["pair"]).mean()
    memory = float(np.corrcoef(pairs[11:-1], pairs[12:])[0, 1])
    if kind == "white":
        assert rms(pairs) < 0.1
    if kind.startswith("drift"):
        assert memory > 0.25
    if kind in ("white", "pair", "outliers"):
        assert abs(memory) < 0.25
    if kind == "heteroscedastic":
        assert fast > 1.6 * slow


def test_enriched_protocol_mixes_speeds_loads_and_cycles():
    table = simulate_torques(settings(protocol="enriched"))
    pairs = table.drop_duplicates("pair").sort_values("pair")
    assert pairs["speed"].nunique() == 10
    orders = {tuple(part) for part in np.split(pairs["speed"].to_numpy(), len(pairs) // 10)}
    assert len(orders) == len(pairs) // 10
    amplitudes = table.groupby(["pair"])["load_torque"].max().round(-1).nunique()
    assert amplitudes >= 3
    phases = pairs["phase"].astype(str).to_numpy()
    changes = phases[np.append(True, phases[1:] != phases[:-1])].tolist()
    assert changes == ["sweep", "heat-up", "cool-down", "heat-up", "cool-down"]


def test_motor_temperature_is_rebuilt_or_raw():
    rebuilt = simulate_torques(settings(noise_scale=1.0))
    raw = simulate_torques(settings(noise_scale=1.0), rebuilt=False)
    assert np.array_equal(raw["motor_temperature"], raw["motor_temperature"].round())
    assert 0.2 < rms(rebuilt["motor_temperature"] - raw["motor_temperature"]) < 0.6


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        (("gremlins",), "expected one of stribeck, .*load_band"),
        (("step_change@sometimes:1",), "expected one of lasting, vanishing, recurring"),
        (("drift@recurring",), "expected none, as it is no change"),
        (("drift:none",), "expected N·m above 0"),
        (("drift:0",), "expected N·m above 0"),
        (("drift:nan",), "expected N·m above 0"),
        (("drift", "drift:2"), "2 times"),
    ],
)
def test_wrong_effects_are_refused(texts, told):
    with pytest.raises(OptionError, match=told):
        requested_effects(texts)


@pytest.mark.parametrize(
    "wrong",
    [{"joint_kind": "x"}, {"noise_kind": "drift"}, {"protocol": "best"}, {"thin": 0}],
)
def test_wrong_kinds_are_refused(wrong):
    with pytest.raises(OptionError, match="expected"):
        simulate_torques(settings(**wrong))
