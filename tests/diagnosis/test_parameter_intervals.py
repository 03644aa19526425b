"""Intervals of the extended model hold the truth, whatever joint and log do besides."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.parameters import extension_parameters, fitted_parameters
from frictioncli.diagnosis.documents.torque_units import TorqueUnits
from frictioncli.diagnosis.fit.extension import beside_unfitted, extend
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.model.friction import PUBLISHED
from frictioncli.simulator.nuisances.catalogue import requested_nuisances
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.rules_of_names import keeps_the_rules
from tests.simulation.torque_table import simulate_torques

Z95 = 1.96


@pytest.fixture(scope="module")
def joint():
    return problem(1)


@pytest.fixture(scope="module")
def weighted_fit(joint):
    return Step.of(Precomputed.of(joint), []).weighted_fit()


def unnamed(coefficient, variance):
    effect = BY_NAME["torque_delay"]
    return EffectFit(effect, {}, np.array([coefficient]), np.array([[variance]]), 0.0)


def shift(joint, weighted_fit, delay):
    """Return by how much a delay moves what is fitted without it, by fitting its torque."""
    angle = np.radians(joint.table.position)
    slope = np.radians(joint.gravity[1] * np.cos(angle) - joint.gravity[0] * np.sin(angle))
    late = -delay * joint.table.speed * slope
    carried = 2 * joint.parameters.alpha * joint.table.load
    zeros = np.zeros_like(joint.friction_base)
    columns = (
        np.hstack([joint.friction_base, joint.friction_by_gravity]),
        np.hstack([zeros, joint.load_base]),
    )
    return weighted_fit.coefficients(*columns, (late, late * carried))


def test_what_compensates_the_shape_is_not_zero(joint, weighted_fit):
    """Far above the Stribeck velocity only size times exp(-v/vs) shows: the size of a friction
    that is there beyond doubt has an upper bound that is far away, and a lower one above zero.
    """
    effect, shape = BY_NAME["stribeck"], {"velocity": 8.0, "exponent": 1.0, "shift": 0.0}
    there = np.array([12.0])
    torque = joint.basis(effect, shape).friction @ there
    more = replace(joint, friction=joint.friction + torque)
    start = EffectFit(effect, shape, there, np.array([[1.0]]), 0.0)
    extension = extend(more, weighted_fit, [start])
    ((low,), (high,)) = extension.intervals(0)
    place = extension.place(0)
    assert extension.effects[0].coefficients == pytest.approx(there, abs=1.0)
    # if the shape were known the size would be, too; it is not
    assert Z95 * extension.fixed_shape_errors[place][0] < 12.0 < Z95 * extension.errors[place][0]
    assert not extension.may_be_zero(0)
    assert 0 < low < 12.0 < high
    # without any, it may be zero
    nothing = extend(joint, weighted_fit, [start])
    assert nothing.may_be_zero(0)
    assert nothing.intervals(0)[0] < 0 < nothing.intervals(0)[1]


def test_what_the_data_leave_open_ends_at_what_is_possible(joint, weighted_fit):
    """No boundary friction is many times the whole friction, however wide the interval."""
    effect, shape = BY_NAME["stribeck"], {"velocity": 8.0, "exponent": 1.0, "shift": 0.0}
    torque = joint.basis(effect, shape).friction @ np.array([12.0])
    more = replace(joint, friction=joint.friction + torque)
    start = EffectFit(effect, shape, np.array([12.0]), np.array([[1.0]]), 0.0)
    found = extend(more, weighted_fit, [start])
    open_ended = replace(found, errors=20 * found.errors)
    assert open_ended.intervals(0)[1][0] > 10 * np.max(more.friction)
    for extension in (found, open_ended):
        stated = extension_parameters(extension, "stribeck", more, TorqueUnits("N·m", "N·m"))
        low, high = stated["boundary_torque"].ci95
        assert low == extension.intervals(0)[0][0] > 0
        assert stated["boundary_torque"].estimate < high < 4 * np.max(more.friction)


def test_a_delay_that_is_not_named_is_an_error_of_what_it_moves(joint, weighted_fit):
    """Estimated as 20 ms without doubt, and as 0 with a standard error of as much: both alike."""
    alone = extend(joint, weighted_fit, []).errors
    moved = shift(joint, weighted_fit, 0.02)
    for delay, variance in ((0.02, 0.0), (0.0, 0.02**2)):
        allowed = beside_unfitted(joint, weighted_fit, [unnamed(delay, variance)])
        found = extend(joint, allowed, [])
        np.testing.assert_allclose(found.errors**2, alone**2 + moved**2, rtol=1e-6)
        np.testing.assert_allclose(found.changes, extend(joint, weighted_fit, []).changes)
    both = beside_unfitted(joint, weighted_fit, [unnamed(0.02, 0.02**2)])
    np.testing.assert_allclose(
        extend(joint, both, []).errors ** 2, alone**2 + 2 * moved**2, rtol=1e-6
    )


@pytest.mark.long
def test_intervals_of_an_effect_without_a_name_end_at_its_physical_bounds(joint):
    values, errors = np.array([0.1, 60.0, -0.4, 0.5]), np.array([0.2, 15.0, 0.1, 0.1])
    effect, shape = BY_NAME["thermal_lag"], {"time_constant": 600.0}
    fit = EffectFit(effect, shape, values, np.diag(np.square(errors)), 20.0)
    stated = fitted_parameters(fit, joint, TorqueUnits("N·m", "N·m"))
    intervals = {name: one.ci95 for name, one in stated.items()}
    assert intervals["lag_share"] == pytest.approx((0.0, 0.1 + Z95 * 0.2))
    assert intervals["friction_heating"] == pytest.approx((60.0 - Z95 * 15.0, 60.0))
    # what is impossible is said as it was fitted
    assert intervals["housing_share"] == pytest.approx((-0.4 - Z95 * 0.1, -0.4 + Z95 * 0.1))
    assert intervals["housing_lag_share"] == pytest.approx((0.5 - Z95 * 0.1, 0.5 + Z95 * 0.1))


def test_joints_with_nothing_hidden_under_all_nuisances():
    """Ten joints: of 50 intervals of the base 92 % hold the truth; one name at the most."""
    held, offset, named = [], [], []
    for seed in range(60, 70):
        settings = SynthesisSettings(
            seed=seed, joint_kind="plain", nuisances=("all", "friction_zones:0.02")
        )
        diagnosis = diagnose_joint(simulate_torques(settings), "motor", "N·m", DiagnosisSettings())
        keeps_the_rules(diagnosis)
        named += [one.effects for one in diagnosis.causes if not one.fit.effect.measurement][:1]
        extension, base = diagnosis.extension, diagnosis.base
        if extension is None:
            continue
        errors = Z95 * extension.errors
        for name, change, error in zip(extension.names, extension.changes, errors, strict=False):
            away = getattr(base.parameters, name) + change - getattr(PUBLISHED, name)
            held.append(abs(away) <= error)
            # and say something: no parameter is known to less than half its value
            assert error < 0.5 * getattr(PUBLISHED, name), name
        place = len(extension.names) + len(extension.gravity)
        truth = requested_nuisances(settings.nuisances, seed).size("torque_offset")
        for one in extension.effects:
            if one.effect.name == "load_offset":
                offset.append(abs(one.coefficients[0] - truth) <= errors[place])
            place += len(one.coefficients)
    assert len(named) <= 1, named
    assert len(held) >= 40
    assert np.mean(held) >= 0.92
    assert offset
    assert np.mean(offset) >= 0.75
