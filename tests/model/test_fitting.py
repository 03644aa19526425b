"""Known parameters come back, with intervals that hold, and nothing is invented."""

from dataclasses import asdict

import numpy as np
import pytest

from frictioncli import documents
from frictioncli.diagnosis.data.base_models import candidate_bases
from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.equation_16 import SPEEDS, TRUTH, cycle_temperatures, torques

FACTS = {"torque_unit": "N·m", "sign": {"2": -1}}


def fitted(table, **settings):
    return fit_joint(table, FACTS, FitSettings(**settings))


def test_noise_free_data_give_the_parameters_exactly():
    model = fitted(torques(0, point=1e-9, pair=0.0, drift=0.0))
    for name, value in TRUTH.items():
        assert model.parameters[name].estimate == pytest.approx(value, rel=1e-4)
    assert model.n_pairs == 80 * len(SPEEDS)
    assert model.sign == -1


@pytest.mark.parametrize("method", ["joint", pytest.param("paper", marks=pytest.mark.slow)])
def test_known_parameters_come_back_within_their_intervals(method):
    """Four noisy days: of 20 intervals of 95 % at least 17 hold the truth, and none is vast."""
    held = 0
    for seed in range(4):
        model = fitted(torques(seed), method=method)
        for name, value in TRUTH.items():
            entry = model.parameters[name]
            low, high = entry.ci95
            held += low <= value <= high
            assert entry.determined
            assert high - low < value
    assert held >= 17


def test_order_of_rows_does_not_matter():
    table = torques(1)
    shuffled = table.sample(frac=1.0, random_state=4)
    one, other = (asdict(fitted(rows).friction) for rows in (table, shuffled))
    # sums of the same numbers may be rounded in another order
    assert one == pytest.approx(other, rel=1e-10)


def test_scaling_the_torques_scales_the_torque_parameters():
    table = torques(2)
    scaled = table.assign(
        friction_torque=3 * table["friction_torque"], load_torque=3 * table["load_torque"]
    )
    one, three = fitted(table).friction, fitted(scaled).friction
    assert three.tau_c == pytest.approx(3 * one.tau_c, rel=1e-4)
    assert three.gamma == pytest.approx(3 * one.gamma, rel=1e-4)
    assert three.alpha == pytest.approx(one.alpha / 3, rel=1e-4)
    assert three.delta == pytest.approx(one.delta, rel=1e-4)


def test_no_temperature_merges_the_viscous_terms():
    table = torques(3).assign(motor_temperature=np.nan, housing_temperature=np.nan)
    model = fitted(table[table["time"] < 600])
    assert not model.parameters["gamma"].determined
    assert not model.parameters["delta"].determined
    assert "merged with beta" in model.parameters["gamma"].reason
    assert model.parameters["gamma"].ci95 is None
    assert not model.knows_temperature


def test_a_short_temperature_span_merges_the_viscous_terms():
    """Between 25 and 33 °C; at 29 °C the whole coefficient is 3.48 + 15.66 exp(-1.624) = 6.57."""
    temperature, time, phase = (values[:9] for values in cycle_temperatures())
    model = fitted(torques(4, temperatures=(temperature, time, phase)))
    assert "spans 8.0 °C" in model.parameters["delta"].reason
    low, high = model.parameters["beta"].ci95
    assert low < 6.57 < high
    assert high - low < 2.0


def test_what_a_short_temperature_span_could_do_is_no_other_effect():
    """Too few °C for a claim on gamma, but the diagnosis must not seek another cause of its 8 %."""
    temperature, time, phase = (values[:9] for values in cycle_temperatures())
    table = torques(4, temperatures=(temperature, time, phase))
    (base,) = candidate_bases(table.assign(load=np.nan), "motor")
    assert {"gamma", "delta"} < set(base.names)
    p = base.parameters
    fall = p.gamma * (np.exp(-p.delta * 25.0) - np.exp(-p.delta * 33.0))
    assert fall == pytest.approx(15.66 * (np.exp(-0.056 * 25.0) - np.exp(-0.056 * 33.0)), rel=0.1)


@pytest.mark.parametrize("method", ["joint", "paper"])
def test_the_only_temperature_of_a_log_is_that_of_friction(method):
    """A log of the housing alone knows at which temperature it was."""
    motor = torques(6)
    housing = motor.assign(housing_temperature=motor["motor_temperature"], motor_temperature=np.nan)
    model = fitted(housing, method=method)
    assert model.temperature == "housing"
    known = fitted(motor.assign(housing_temperature=np.nan), method=method)
    assert model.friction == known.friction


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_viscous_friction_that_does_not_fall_with_temperature_stays(seed):
    """A strong drift leaves delta vague: gamma takes beta's share, and gives it back."""
    table = torques(seed, drift=6.0)
    falling = TRUTH["gamma"] * np.exp(-TRUTH["delta"] * table["motor_temperature"])
    table["friction_torque"] -= falling * np.sqrt(table["speed"])
    model = fitted(table)
    assert not model.parameters["gamma"].determined
    assert not model.parameters["delta"].determined
    low, high = model.parameters["beta"].ci95
    assert low < TRUTH["beta"] < high
    assert model.parameters["beta"].determined
    # what the model lacks may be the reason: the diagnosis keeps the fall with temperature
    (base,) = candidate_bases(table.assign(load=np.nan), "motor")
    assert base.names == ("tau_c", "alpha", "beta", "gamma", "delta")
    assert base.parameters.gamma > 0


def test_one_speed_merges_coulomb_and_viscous_friction():
    model = fitted(torques(5, speeds=(67.5,)))
    assert not model.parameters["beta"].determined
    assert "merged into tau_c" in model.parameters["beta"].reason
    # the merged value: 10.57 + 3.48 sqrt(67.5) = 39.16
    low, high = model.parameters["tau_c"].ci95
    assert low < 39.16 < high
    assert model.parameters["delta"].estimate == pytest.approx(0.056, rel=0.3)


def test_without_beta_delta_is_the_rate_of_the_whole_viscous_coefficient():
    """Between 25 and 38 °C: delta times gamma's part of it, 2.68 of 6.16 at 31.5 °C."""
    temperature, time, phase = (values[:14] for values in cycle_temperatures())
    model = fitted(torques(1, drift=1.0, temperatures=(temperature, time, phase)))
    assert "fixed at 0" in model.parameters["beta"].reason
    delta = model.parameters["delta"]
    assert "whole viscous coefficient" in delta.reason
    assert delta.determined
    assert delta.ci95[0] < 0.056 * 2.68 / 6.16 < delta.ci95[1]


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_at_one_speed_beta_does_not_come_back_for_gamma(seed):
    """It was merged into Coulomb friction, not into gamma."""
    table = torques(seed, drift=6.0, speeds=(67.5,))
    falling = TRUTH["gamma"] * np.exp(-TRUTH["delta"] * table["motor_temperature"])
    table["friction_torque"] -= falling * np.sqrt(table["speed"])
    model = fitted(table)
    assert not model.parameters["beta"].determined
    assert "merged into tau_c" in model.parameters["beta"].reason


def test_a_small_load_drops_alpha():
    model = fitted(torques(6, load=2.0))
    assert not model.parameters["alpha"].determined
    assert model.friction.alpha == 0.0
    assert "load spans" in model.parameters["alpha"].reason


@pytest.mark.parametrize("constant", [0.0, 14.0])
def test_noise_of_a_joint_without_gravity_is_no_load(constant):
    """What scatters in one direction of motion is in friction and load alike."""
    table = torques(6, load=2.0)
    one_way = np.random.default_rng(1).exponential(0.5, len(table))
    noisy = table.assign(
        friction_torque=table["friction_torque"] + one_way / 2, load_torque=constant + one_way / 2
    )
    alpha = fitted(noisy).parameters["alpha"]
    assert (alpha.determined, alpha.estimate) == (False, 0.0)


def test_a_parameter_at_its_bound_is_flagged():
    truth = TRUTH | {"beta": -1.5}
    model = fitted(torques(8, truth=truth, drift=0.05))
    assert model.friction.beta == 0.0
    assert not model.parameters["beta"].determined


def test_paper_method_needs_both_branches():
    table = torques(9)
    with pytest.raises(NotEnoughData, match="heating and a cooling branch"):
        fitted(table[table["phase"] == "heat-up"], method="paper")


@pytest.mark.parametrize("load", [0.0, 40.0, 0.1])
@pytest.mark.parametrize("method", ["joint", "paper"])
def test_an_axis_without_gravity_has_no_load_term(method, load):
    """A load of 0 or 40 N·m in all rows, or noise of 0.1 N·m, does not tell alpha."""
    table = torques(7, truth=TRUTH | {"alpha": 0.0})
    noise = np.random.default_rng(7).normal(0.0, load, len(table)) if load == 0.1 else load
    model = fitted(table.assign(load_torque=noise), method=method)
    alpha = model.parameters["alpha"]
    assert (alpha.estimate, alpha.ci95, alpha.determined) == (0.0, None, False)
    assert "the magnitude of the load spans" in alpha.reason
    for name in ("tau_c", "beta", "gamma", "delta"):
        low, high = model.parameters[name].ci95
        assert low < TRUTH[name] < high
        assert high - low < TRUTH[name]


def test_missing_housing_temperature_is_named():
    table = torques(9).assign(housing_temperature=np.nan)
    with pytest.raises(NotEnoughData, match="housing_temperature"):
        fitted(table, temperature="housing")


def test_too_few_pairs_are_named():
    table = torques(9)
    with pytest.raises(NotEnoughData, match="2 pairs of"):
        fitted(table[table["pair"] < 2])


def test_currents_carry_their_unit():
    model = fit_joint(torques(1), {"torque_unit": "A", "load_unit": "N·m"}, FitSettings())
    units = {name: entry.unit for name, entry in model.parameters.items()}
    assert units == {
        "tau_c": "A",
        "alpha": "A/(N·m)²",
        "beta": "A/(deg/s)^0.5",
        "gamma": "A/(deg/s)^0.5",
        "delta": "1/°C",
    }


def test_unknown_methods_are_refused():
    with pytest.raises(OptionError, match="joint, paper"):
        FitSettings(method="magic")


@pytest.mark.parametrize("method", ["joint", pytest.param("paper", marks=pytest.mark.long)])
@pytest.mark.parametrize("seed", range(3))
def test_friction_that_rises_with_temperature_leaves_no_nan_in_the_document(method, seed):
    """Gamma then lies on its bound 0, where delta has no meaning and no interval."""
    model = fitted(torques(seed, truth=TRUTH | {"gamma": -3.0, "beta": 12.0}), method=method)
    assert "NaN" not in documents.to_json(model)
    for name in ("gamma", "delta"):
        entry = model.parameters[name]
        assert not entry.determined
        assert entry.reason
    # 12 - 3 exp(-0.056 T): 11.3 at 30 °C, 11.9 at 60 °C
    assert 11.0 < model.friction.beta < 12.5
