"""Pairs of a table of torques as an online corrector meets them: one row each, in time order."""

import numpy as np

from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import stated_gravity
from frictioncli.effects.friction_heat import friction_power
from frictioncli.effects.pair_series import pair_heads


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


def powers(rows, model, extension):
    """Mean friction power from the pair before to each pair, as the batch sees it."""
    gravity = stated_gravity(model.gravity_about)
    _, problem = simulated(rows, "motor", model.about, gravity, model.hidden)
    heads = pair_heads(problem.table)
    level = friction_power(problem.table, heads) * extension.gear.reference_power
    return np.concatenate([[0.0], level])
