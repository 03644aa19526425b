r"""The two channels of one joint with the simulation of its torque: what diagnosis works on.

The simulated torque along the measured motion is the fitted friction (16) plus the fitted gravity
:math:`l_g = P \cos q + Q \sin q + c + m (p \cos q + r \sin q)`, the latter where payloads *m* are
known (:mod:`frictioncli.diagnosis.data.gravity`). Its misfit has an even part, the friction
channel, and an odd part, the load channel. Friction is refitted with the smooth gravity as its
load, so that an odd effect cannot leak into :math:`\alpha L^2`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags, Indices
from frictioncli.diagnosis.data.base_models import candidate_bases
from frictioncli.diagnosis.data.gravity import (
    NAMES,
    carried_load,
    columns_of,
    differs,
    known_payload,
    without_offset,
)
from frictioncli.diagnosis.data.motion_history import clock_of, series, travel_of
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.effects.base import Basis, Effect, EffectTable
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import FrictionParameters, friction_torque
from frictioncli.model.zero_load import PAIR_KEY, temperature_of

_REBUILT = 0.05
_REGISTERED = 0.29
"""Error of the motor temperature where it was rebuilt between its steps, and where it was not:
a step of 1 °C has a standard deviation of 1/sqrt(12). [°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One joint's measurements and base model, rows by run, time and angle.

    Attributes
    ----------
    table : EffectTable
        The rows, with the base model.
    whole : EffectTable
        The rows of all runs: an effect that remembers is evaluated on them.
    rows : ndarray of int, shape (rows,)
        Which of those the problem has.
    layout : PairLayout
        Which rows make up which pair.
    friction, load : ndarray, shape (rows,)
        Measured friction and load torque. [N·m]
    friction_base, load_base : ndarray, shape (rows, parameters)
        Derivatives of the simulated torque by the base parameters.
    names : tuple of str
        Friction parameters that the columns of ``friction_base`` belong to.
    parameters : FrictionParameters
        Friction refitted to these data.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of cos q, sin q and 1, and of the first two per mass of the payload where two
        payloads are known: those of the columns of ``load_base``. [N·m], [N·m/kg]
    own_load : bool
        Whether the log has a load channel of its own; the base's load is then that.
    temperature_error : float
        Error of the motor temperature. [°C]
    runs : tuple of str
        Names of the runs, in order.
    """

    table: EffectTable
    whole: EffectTable
    rows: Indices
    layout: PairLayout
    friction: Array
    load: Array
    friction_base: Array
    load_base: Array
    names: tuple[str, ...]
    parameters: FrictionParameters
    gravity: Array
    own_load: bool
    temperature_error: float
    runs: tuple[str, ...]

    def basis(self, effect: Effect, shape: Mapping[str, float]) -> Basis:
        """Return an effect's columns at these rows, with all runs as its history."""
        friction, load = effect.evaluate(self.whole, shape)
        return Basis(friction[self.rows], load[self.rows])

    @property
    def temperature_variance(self) -> Array:
        """Variance that an uncertain temperature gives to pair means, shape (pairs,)."""
        slope = self.layout.means(self.table.temperature_slope[:, np.newaxis])[:, 0]
        return np.square(self.temperature_error * slope)

    @property
    def friction_by_gravity(self) -> Array:
        """Derivatives of the friction torque by the gravity's coefficients, as of load_base.

        Friction goes with the square of the load: a cause that bends the fitted gravity would
        else show a second time, in friction.
        """
        if self.own_load:
            return np.zeros_like(self.load_base)
        slope = 2 * self.parameters.alpha * self.table.load
        return slope[:, np.newaxis] * without_offset(self.load_base)

    def squared(self, friction: Array, load: Array) -> Array:
        """Return the squared misfit of the simulated torque, shape (rows,). [(N·m)²].

        Forward, torque misses by load plus friction, in reverse by load less friction: the mean
        square is the sum of both. Where the log has a load of its own, perhaps in another unit
        than a motor current, the load is not simulated and only friction counts.
        """
        return np.square(friction) + (0.0 if self.own_load else np.square(load))

    @property
    def friction_misfit(self) -> Array:
        """Measured minus simulated friction torque, shape (rows,). [N·m]."""
        return self.friction - self.table.friction

    @property
    def load_misfit(self) -> Array:
        """Measured minus simulated load torque, shape (rows,). [N·m]."""
        return self.load - self.load_base @ self.gravity


def build_problems(
    torques: pd.DataFrame, temperature: str, held_out: str | None = None
) -> tuple[Problem, Problem | None]:
    """Return the problem of one joint, and that of a run that is kept out of it.

    The base model is fitted to the first one's rows only; the second is simulated with it. Gravity
    goes with the payload if the first one's rows have two that are known.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    held_out : str, optional
        Name of the run that is kept out.
    """
    rows = torques.sort_values(["run", "time", "pair", "position"], ignore_index=True)
    new = (rows["run"] == held_out).to_numpy()
    columns = columns_of(rows, payloads=differs(known_payload(rows)[~new]))
    load = rows["load_torque"].to_numpy(float)
    gravity = np.linalg.lstsq(columns[~new], load[~new], rcond=None)[0]
    smooth = carried_load(columns, gravity) if rows["load"].isna().all() else load
    whole = min(
        (
            _assembled(rows, temperature, smooth, columns, gravity, base.parameters, base.names)
            for base in candidate_bases(rows.assign(load_torque=smooth)[~new], temperature)
        ),
        key=lambda problem: _typical_misfit(problem, ~new),
    )
    return _part(whole, ~new), _part(whole, new) if new.any() else None


def _typical_misfit(problem: "Problem", seen: Flags) -> float:
    """Return the median misfit of the pairs' mean friction. [N·m]."""
    misfit = problem.layout.means(problem.friction_misfit[:, np.newaxis])[:, 0]
    return float(np.median(np.abs(misfit[np.unique(problem.layout.row_pair[seen])])))


def simulated(
    torques: pd.DataFrame, temperature: str, parameters: FrictionParameters, gravity: Array
) -> tuple[pd.Index, Problem]:
    """Return the problem of given rows under a given base, and the rows' labels in its order.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    parameters : FrictionParameters
        Its parameters.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of cos q, sin q and 1, and of the first two per mass of the payload. [N·m],
        [N·m/kg]
    """
    rows = torques.sort_values(["run", "time", "pair", "position"])
    columns = columns_of(rows, payloads=len(gravity) > len(NAMES))
    smooth = rows["load"].isna().all()
    load = carried_load(columns, gravity) if smooth else rows["load_torque"].to_numpy(float)
    problem = _assembled(
        rows.reset_index(drop=True), temperature, load, columns, gravity, parameters, PARAMETERS
    )
    return rows.index, problem


def _assembled(
    rows: pd.DataFrame,
    temperature: str,
    load: Array,
    columns: Array,
    gravity: Array,
    parameters: FrictionParameters,
    names: tuple[str, ...],
) -> Problem:
    pair = rows.groupby(PAIR_KEY, sort=False, observed=True).ngroup().to_numpy()
    run, run_names = pd.factorize(rows["run"])
    speed = rows["speed"].to_numpy(float)
    warm = np.nan_to_num(temperature_of(rows, temperature).to_numpy(float), nan=0.0)
    heads = np.flatnonzero(np.diff(pair, prepend=-1))
    position = rows["position"].to_numpy(float)
    layout = PairLayout.of(
        row_pair=pair,
        run=run[heads],
        time=rows["time"].to_numpy(float)[heads],
        speed=speed[heads],
        position=position,
    )
    motor = rows["motor_temperature"].to_numpy(float)
    rest, order = series(layout, motor[heads])
    table = EffectTable(
        run=run,
        pair=pair,
        time=rows["time"].to_numpy(float),
        clock=clock_of(layout)[pair],
        speed=speed,
        position=position,
        load=load,
        temperature=warm,
        motor_temperature=motor,
        housing_temperature=rows["housing_temperature"].to_numpy(float),
        friction=np.zeros_like(speed),
        viscous=np.zeros_like(speed),
        temperature_slope=np.zeros_like(speed),
        load_slope=np.zeros_like(speed),
        travel=travel_of(rows, layout, motor[heads])[pair],
        rest=rest[pair],
        order=order[pair],
    )
    reading = rows["motor_temperature_reading"].to_numpy(float)
    rebuilt = np.nanmax(np.abs(reading - warm), initial=0.0) > 1e-6
    empty = Problem(
        table=table,
        whole=table,
        rows=np.arange(len(run)),
        layout=layout,
        friction=rows["friction_torque"].to_numpy(float),
        load=rows["load_torque"].to_numpy(float),
        friction_base=np.empty((len(run), 0)),
        load_base=columns,
        names=names,
        parameters=parameters,
        gravity=gravity,
        own_load=bool(rows["load"].notna().any()),
        temperature_error=_REBUILT if rebuilt else _REGISTERED,
        runs=tuple(str(name) for name in run_names),
    )
    return _with_friction(empty)


def _with_friction(problem: Problem) -> Problem:
    """Return the problem of all runs with its friction simulated by its parameters."""
    parameters, table = problem.parameters, _modelled(problem.table, problem.parameters)
    root_speed = np.sqrt(table.speed)
    decay = np.exp(-parameters.delta * table.temperature)
    derivative = {
        "tau_c": np.ones_like(root_speed),
        "alpha": np.square(table.load),
        "beta": root_speed,
        "gamma": root_speed * decay,
        "delta": -parameters.gamma * table.temperature * decay * root_speed,
    }
    return replace(
        problem,
        table=table,
        whole=table,
        friction_base=np.column_stack([derivative[name] for name in problem.names]),
    )


def _modelled(table: EffectTable, parameters: FrictionParameters) -> EffectTable:
    """Return a table with the columns that depend on the base's friction."""
    decay = np.exp(-parameters.delta * table.temperature)
    return replace(
        table,
        friction=friction_torque(
            parameters, load=table.load, speed=table.speed, temperature=table.temperature
        ),
        viscous=parameters.beta + parameters.gamma * decay,
        temperature_slope=-parameters.delta * parameters.gamma * decay * np.sqrt(table.speed),
        load_slope=2 * parameters.alpha * table.load,
    )


def _part(whole: Problem, chosen: Flags) -> Problem:
    """Return the problem of some runs; rows of whole pairs are chosen."""
    table = EffectTable(
        **{field.name: getattr(whole.table, field.name)[chosen] for field in fields(EffectTable)}
    )
    pairs = np.unique(whole.layout.row_pair[chosen])
    row_pair = np.searchsorted(pairs, whole.layout.row_pair[chosen])
    layout = PairLayout.of(
        row_pair=row_pair,
        run=whole.layout.run[pairs],
        time=whole.layout.time[pairs],
        speed=table.speed[np.flatnonzero(np.diff(row_pair, prepend=-1))],
        position=table.position,
    )
    return replace(
        whole,
        table=table,
        rows=np.flatnonzero(chosen),
        layout=layout,
        friction=whole.friction[chosen],
        load=whole.load[chosen],
        friction_base=whole.friction_base[chosen],
        load_base=whole.load_base[chosen],
        runs=tuple(whole.runs[number] for number in np.unique(layout.run)),
    )
