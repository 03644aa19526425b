"""Pairs of a table of torques as an online corrector meets them: one row each, in time order."""

from typing import NamedTuple

import numpy as np

from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import stated_gravity
from frictioncli.effects.thermal_lag import ThermalInputs


def pairs_of(rows, added):
    """One row per pair: its means, its effective load, and what warms the gear before it."""
    squared = rows["load_torque"] ** 2
    grouped = rows.assign(squared=squared, added=added).groupby(["run", "pair"], sort=True)
    means = grouped[["time", "speed", "motor_temperature", "housing_temperature"]].first()
    means["registered"] = grouped["motor_temperature_reading"].first()
    means["phase"] = grouped["phase"].first()
    means[["friction", "squared", "added"]] = grouped[
        ["friction_torque", "squared", "added"]
    ].mean()
    return means.reset_index()


class Instant(NamedTuple):
    """What a controller knows at a moment; the power is the mean since the moment before."""

    time: float
    motor: float
    housing: float
    power: float


def instants_before(rows, model, extension):
    """The moments after the pair before, up to each pair itself, as the batch sees them."""
    gravity = stated_gravity(model.gravity_about)
    _, problem = simulated(rows, "motor", model.about, gravity, model.hidden)
    inputs = ThermalInputs.of(problem.table)
    power = np.append(0.0, inputs.power) * extension.gear.reference_power
    columns = (inputs.time, inputs.motor, inputs.housing, power)
    moments = [Instant(*map(float, one)) for one in zip(*columns, strict=True)]
    begins = np.append(0, inputs.pairs[:-1] + 1)
    return [moments[i : j + 1] for i, j in zip(begins, inputs.pairs, strict=True)]
