"""What is true of a world of the blind study, and what of it can be seen at all."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import base_rows
from tests.simulation.torque_table import simulate_world
from tests.studies.blind_worlds import World

TEMPERATURE = "motor"
GRAVITY = 9.80665

COUNTERPARTS: Mapping[str, tuple[str, Callable[[Any], float]]] = {
    # planted m (sqrt(v² + r²) - r) / 100, fitted kv v: equal from twice the rounding on
    "linear_viscous": ("viscous_coefficient", lambda one: one.magnitude / 100.0),
    # planted m (sqrt(L² + r²) - r) / 50, fitted al |L|
    "load_linear": ("load_share", lambda one: one.magnitude / 50.0),
    # planted and fitted: torque at rest
    "stribeck": ("boundary_torque", lambda one: one.magnitude),
    # planted m (x + c x³) with x in quarter turns, fitted k (x + c x³) with x in rad
    "dress_pack": ("stiffness", lambda one: one.magnitude * 2.0 / np.pi),
    # gravity of the mass gained at 0 deg
    "payload_change": (
        "cosine",
        lambda one: GRAVITY * one.parameters["way"] * one.magnitude * one.parameters["along"],
    ),
    # planted with a width of up to two minutes, fitted without
    "step_change": ("change", lambda one: one.parameters["way"] * one.magnitude),
}
"""Coefficients of the catalogue that mean what a planted parameter means, and its value."""

LEAVES_BASE = (
    "stribeck",
    "linear_viscous",
    "load_linear",
    "thermal_lag",
    "rest_recovery",
    "step_change",
    "direction_asymmetry",
    "payload_change",
    "dress_pack",
    "position_ripple",
    "inertia",
    "reversal_transient",
)
"""Effects beside which the base parameters keep their meaning: others count from a temperature,
a load or a time that the catalogue sets elsewhere, which shifts tau_c, alpha, beta or gamma."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """A world with what is true of it.

    Attributes
    ----------
    torques : DataFrame
        What the diagnosis is given.
    before : float
        RMS misfit of the base on the held-out run. [N·m]
    oracle : float
        The same where nothing is hidden: what is left to one who knows all that is. [N·m]
    raw, visible : float
        RMS of what is hidden in the run seen, and of what the base's columns leave of it; of
        several effects those of the one of which least is left. [N·m]
    coefficient : str
        Coefficient of the catalogue that has a planted counterpart; empty without one.
    value : float
        What was planted of it.
    """

    torques: pd.DataFrame
    before: float
    oracle: float
    raw: float
    visible: float
    coefficient: str
    value: float


def truth_of(world: World) -> Truth:
    """Simulate a world with and without what is hidden in it."""
    simulated = simulate_world(world.settings(world.names))
    torques = simulated.torques
    seen, new = problems(torques)
    oracle, raw, visible = _rms_misfit(new), 0.0, 0.0
    if world.names:
        oracle = _rms_misfit(problems(_without(world, torques, world.names))[1])
        signals = [_signal(seen, _without(world, torques, (name,))) for name in world.names]
        raw, visible = min(
            ((_rms(signal), _rms(_off_base(seen, signal))) for signal in signals),
            key=lambda sizes: sizes[1],
        )
    coefficient, value = "", float("nan")
    if world.kind == "single" and world.hidden in COUNTERPARTS:
        coefficient, planted = COUNTERPARTS[world.hidden]
        value = planted(simulated.planted.effects[0].effect)
    return Truth(
        torques=torques,
        before=_rms_misfit(new),
        oracle=oracle,
        raw=raw,
        visible=visible,
        coefficient=coefficient,
        value=value,
    )


def problems(torques: pd.DataFrame) -> tuple[Problem, Problem]:
    """Return the problem of the runs seen, and that of the last run, as diagnosis does."""
    seen, new = build_problems(torques, TEMPERATURE, str(max(torques["run"].unique())))
    assert new is not None  # two runs are simulated
    return seen, new


def _without(world: World, torques: pd.DataFrame, names: Sequence[str]) -> pd.DataFrame:
    """Return a world's torques without some of what is hidden in it."""
    left = [name for name in world.names if name not in names]
    found = simulate_world(world.settings(left)).torques
    _same_but_torque(torques, found)
    return found


def _signal(seen: Problem, without: pd.DataFrame) -> Array:
    """Return what is missing from torques, friction above load, in the problem's rows. [N·m]."""
    rows = without[without["run"].isin(seen.runs)]
    rows = rows.sort_values(["run", "time", "pair", "position"])
    friction = seen.friction - rows["friction_torque"].to_numpy(float)
    return np.concatenate([friction, seen.load - rows["load_torque"].to_numpy(float)])


def _same_but_torque(torques: pd.DataFrame, clean: pd.DataFrame) -> None:
    """Raise if anything but torques differs: then the difference is not what is hidden alone."""
    torque = {"torque_forward", "torque_reverse", "friction_torque", "load_torque"}
    others = [name for name in torques if name not in torque]
    if not torques[others].equals(clean[others]):
        raise ValueError("without what is hidden, the world has another motion or temperature")


def _rms_misfit(problem: Problem) -> float:
    """Return the RMS misfit of both moves' torque. [N·m]."""
    return _rms(np.concatenate([problem.friction_misfit, problem.load_misfit]))


def _rms(both: Array) -> float:
    """Return the RMS torque of friction above load: mean square is friction's plus load's."""
    return float(np.sqrt(2.0 * np.mean(np.square(both))))


def _off_base(problem: Problem, signal: Array) -> Array:
    """Return what the base's columns leave of a signal, friction above load."""
    base = np.vstack(base_rows(problem))
    base = base / np.linalg.norm(base, axis=0)
    return np.asarray(signal - base @ np.linalg.lstsq(base, signal, rcond=1e-10)[0])
