"""What is true of a joint of the blind study, and what of it can be seen at all."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.effects import MEASUREMENT_EFFECTS
from frictioncli.effects.base import applicable
from frictioncli.simulator.nuisances.definition import Nuisances
from frictioncli.simulator.planted.effect import PlantedEffect
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.torque_table import simulate_world
from tests.studies.blind_worlds import CHANGES, TWELVE, World

TEMPERATURE = "motor"
GRAVITY = 9.80665

TORQUE = ["friction_torque", "load_torque"]

PRESENT = 0.3
"""A change is there where its torque is more than this share of its greatest."""

PAIRS = 12
"""Least number of pairs that the program diagnoses."""

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

LATE = ("torque_delay", "torque_filter")
"""Effects of the measurement that say by how much the torque is late."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """One effect that is hidden in a joint.

    Attributes
    ----------
    name : str
        Its name.
    raw, left : float
        RMS of its torque in the runs seen, and of what the base and the columns of the measurement
        leave of it. [N·m]
    on_new_run : float
        RMS of its torque on the day kept out. [N·m]
    coefficient : str
        Coefficient of the catalogue that means the same; empty without one.
    value : float or None
        What was planted of it.
    stretches : tuple of (float, float)
        Of a change: when it is there, as shares of all pairs in order of time.
    """

    name: str
    raw: float = 0.0
    left: float = 0.0
    on_new_run: float = 0.0
    coefficient: str = ""
    value: float | None = None
    stretches: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """A joint with what is true of it.

    Attributes
    ----------
    torques : DataFrame
        Its torques per angle bin.
    hidden : tuple of Hidden
        What is hidden in it.
    nuisances : mapping of str to mapping
        True values of what the catalogue calls measurement, by effect and parameter.
    nuisance : float
        RMS that base and columns of the measurement leave of all nuisances together on the day
        seen, without noise. [N·m]
    margin : float
        Smallest size worth a name by the rule of the diagnosis. [N·m]
    share_seen : float
        Share of all pairs that are in the runs seen.
    before : float
        RMS misfit of the base on the day kept out. [N·m]
    floor : float
        RMS of the noise on that day, which no model can predict. [N·m]
    reachable : float
        RMS misfit on that day of base and measurement, fitted to the day seen without what is
        hidden. [N·m]
    seen : Problem
        The runs seen.
    signals : tuple of ndarray, shape (2 * rows,)
        Torque of each effect there, friction above load. [N·m]
    """

    torques: pd.DataFrame
    hidden: tuple[Hidden, ...]
    nuisances: Mapping[str, Mapping[str, float]]
    nuisance: float
    margin: float
    share_seen: float
    before: float
    floor: float
    reachable: float
    seen: Problem
    signals: tuple[Array, ...]

    def left_beside(self, given_up: Collection[str]) -> list[float]:
        """Return what the base and the measurement leave of each effect [N·m].

        Parameters
        ----------
        given_up : collection of str
            Effects of the measurement that the diagnosis did not set beside the base.
        """
        span = base_and_measurement(self.seen, given_up)
        return [_rms(_off(span, signal)) for signal in self.signals]


def truth_of(world: World) -> Truth:
    """Simulate a joint with and without what is hidden in it, and without noise."""
    simulated = simulate_world(world.settings(world.names))
    torques = _chosen(world, simulated.torques)
    without = {name: _without(world, torques, (name,)) for name in world.names}
    if len(world.names) > 1:
        bare = _without(world, torques, world.names)
    else:
        bare = next(iter(without.values()), torques)
    quiet = _same(torques, world, world.settings((), noise_scale=0.0))
    seen, new = problems(torques)
    judged = new or seen
    base = base_and_measurement(seen)
    simulated_base = np.concatenate([seen.table.friction, seen.load_base @ seen.gravity])
    planted = {one.effect.name: one.effect for one in simulated.planted.effects}
    signals = {name: _signal(seen, one) for name, one in without.items()}
    return Truth(
        torques=torques,
        hidden=tuple(
            replace(
                _hidden(world, torques, without[name], planted[name]),
                raw=_rms(signal),
                left=_rms(_off(base, signal)),
                on_new_run=0.0 if new is None else _rms(_signal(new, without[name])),
            )
            for name, signal in signals.items()
        ),
        nuisances=_nuisances(simulated.nuisances),
        nuisance=_rms(_off(base, _torque(seen, quiet) - simulated_base)),
        margin=max(0.1, 0.005 * float(np.mean(np.abs(seen.friction)))),
        share_seen=_pairs(seen) / (_pairs(seen) + (0 if new is None else _pairs(new))),
        before=_rms_misfit(judged),
        floor=_rms(_torque(judged, bare) - _torque(judged, quiet)),
        reachable=_reachable(seen, judged, bare),
        seen=seen,
        signals=tuple(signals.values()),
    )


def _hidden(
    world: World, torques: pd.DataFrame, without: pd.DataFrame, planted: PlantedEffect
) -> Hidden:
    """Return what is true of one effect but its sizes, from the torques with and without it."""
    name = planted.name
    coefficient, value = "", None
    if name in COUNTERPARTS and not world.history:
        coefficient, counterpart = COUNTERPARTS[name]
        value = counterpart(planted)
    return Hidden(
        name=name,
        coefficient=coefficient,
        value=value,
        stretches=_stretches(torques, without) if name in CHANGES else (),
    )


def problems(torques: pd.DataFrame) -> tuple[Problem, Problem | None]:
    """Return the problem of the runs seen, and that of the last of several, as diagnosis does."""
    runs = sorted(torques["run"].unique())
    return build_problems(torques, TEMPERATURE, str(runs[-1]) if len(runs) > 1 else None)


def _chosen(world: World, torques: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that the diagnosis is given: all, or a few pairs of the first day."""
    if world.hidden != TWELVE:
        return torques
    first = torques[torques["run"] == min(torques["run"].unique())]
    pairs = first["pair"].unique()
    kept = pairs[np.linspace(0, len(pairs) - 1, PAIRS).round().astype(int)]
    return first[first["pair"].isin(kept)].reset_index(drop=True)


def _nuisances(nuisances: Nuisances) -> dict[str, dict[str, float]]:
    """Return what is true of the measurement, by effect of the catalogue and parameter.

    A filter delays by its time constant, and its moments are those of filter and delay together.
    """
    delay, lag = (nuisances.size(name) for name in LATE)
    true = {
        "torque_delay": {"delay": delay + lag},
        "torque_filter": {"second_moment": lag**2 + lag * delay + delay**2 / 2} if lag else {},
        "load_offset": {"not_carried": nuisances.size("torque_offset")},
        "backlash": {"play": nuisances.size("backlash")},
        "sensor_lag": {"time_constant": nuisances.size("sensor_lag")},
        "other_joint": {"torque": nuisances.size("other_joint")},
    }
    return {name: values for name, values in true.items() if any(values.values())}


def delay_and_filter(nuisances: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Return the true delay and time constant of the filter [s] from the moments of both.

    Parameters
    ----------
    nuisances : mapping of str to mapping
        As in :class:`Truth`.
    """
    late, filtered = (nuisances.get(name, {}) for name in LATE)
    mean = late.get("delay", 0.0)
    second = filtered.get("second_moment", mean**2 / 2)
    time_constant = math.sqrt(max(2 * second - mean**2, 0.0))
    return {"delay": mean - time_constant, "time_constant": time_constant}


def _without(world: World, torques: pd.DataFrame, names: Sequence[str]) -> pd.DataFrame:
    """Return a joint's torques without some of what is hidden in it."""
    left = [name for name in world.names if name not in names]
    return _same(torques, world, world.settings(left))


def _same(torques: pd.DataFrame, world: World, settings: SynthesisSettings) -> pd.DataFrame:
    """Return the same joint simulated otherwise.

    Raises
    ------
    ValueError
        If the motion differs: then the difference of torques is not what was asked for.
    """
    found = _chosen(world, simulate_world(settings).torques)
    motion = ["run", "pair", "time", "speed", "position", "n_forward"]
    if not torques[motion].equals(found[motion]):
        raise ValueError("without what is hidden, the joint moves otherwise")
    return found


def _signal(seen: Problem, without: pd.DataFrame) -> Array:
    """Return what is missing from torques, friction above load, in the problem's rows. [N·m]."""
    return np.concatenate([seen.friction, seen.load]) - _torque(seen, without)


def _torque(problem: Problem, torques: pd.DataFrame) -> Array:
    """Return torques, friction above load, in the problem's rows. [N·m]."""
    rows = torques[torques["run"].isin(problem.runs)]
    rows = rows.sort_values(["run", "time", "pair", "position"])
    return np.concatenate([rows[name].to_numpy(float) for name in TORQUE])


def _stretches(torques: pd.DataFrame, without: pd.DataFrame) -> tuple[tuple[float, float], ...]:
    """Return when a change is there, as shares of all pairs."""
    size = np.sqrt(np.square(torques[TORQUE] - without[TORQUE]).sum(axis=1))
    by_pair = size.groupby([torques["run"], torques["time"]], observed=True).mean().to_numpy()
    there = np.concatenate([[False], by_pair > PRESENT * by_pair.max(), [False]]).astype(int)
    edges = np.flatnonzero(np.diff(there)) / len(by_pair)
    return tuple(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _pairs(problem: Problem) -> int:
    return len(np.unique(problem.layout.row_pair))


def _rms_misfit(problem: Problem) -> float:
    """Return the RMS misfit of both moves' torque. [N·m]."""
    return _rms(np.concatenate([problem.friction_misfit, problem.load_misfit]))


def _rms(both: Array) -> float:
    """Return the RMS torque of friction above load: mean square is friction's plus load's."""
    return float(np.sqrt(2.0 * np.mean(np.square(both))))


def _reachable(seen: Problem, judged: Problem, bare: pd.DataFrame) -> float:
    """Return what base and measurement, fitted to some rows by least squares, miss of others."""

    def missed(problem: Problem) -> Array:
        base = np.concatenate([problem.table.friction, problem.load_base @ seen.gravity])
        return np.asarray(_torque(problem, bare) - base)

    columns = _columns(seen)
    fitted = np.linalg.lstsq(columns, missed(seen), rcond=1e-10)[0]
    return _rms(missed(judged) - _columns(judged) @ fitted)


def base_and_measurement(problem: Problem, given_up: Collection[str] = ()) -> Array:
    """Return the columns of base and measurement, friction above load, each of length 1."""
    found = _columns(problem, given_up)
    size = np.linalg.norm(found, axis=0)
    return np.asarray(found[:, size > 0] / size[size > 0])


def _columns(problem: Problem, given_up: Collection[str] = ()) -> Array:
    """Return the columns of base and measurement, friction above load."""
    columns = [np.vstack(base_rows(problem))]
    for effect in applicable(MEASUREMENT_EFFECTS, problem.table):
        if effect.name in given_up:
            continue
        shapes = effect.shapes(problem.table)
        columns.append(np.vstack(problem.basis(effect, shapes[len(shapes) // 2])))
    return np.hstack(columns)


def _off(columns: Array, signal: Array) -> Array:
    """Return what columns leave of a signal, friction above load."""
    return np.asarray(signal - columns @ np.linalg.lstsq(columns, signal, rcond=1e-10)[0])
