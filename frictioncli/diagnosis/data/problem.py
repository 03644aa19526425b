r"""Friction and load channel of one joint with the simulation of its torque.

The simulated torque along the measured motion is the fitted friction (16) plus the fitted gravity
(:mod:`frictioncli.diagnosis.data.gravity`),

.. math:: u = \sigma \tau(L_g, \dot q, T) + L_g(q, m)

with the direction :math:`\sigma` of the motion. Its misfit has an even part in the direction, the
friction channel, and an odd part, the load channel. The base model takes the fitted gravity as its
load, so that a disturbance of the load channel cannot enter :math:`\alpha L^2`.
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

_RECONSTRUCTED = 0.05
"""Standard error of a motor temperature reconstructed between the steps of its register. [°C]"""

_REGISTERED = 0.29
"""Standard error of a motor temperature as registered in steps of 1 °C: 1/sqrt(12). [°C]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One joint's measurements and base model, rows by run, time and angle.

    Attributes
    ----------
    table : EffectTable
        The rows, with the base model.
    all_runs : EffectTable
        The rows of all runs; an effect with memory is evaluated on them.
    rows : ndarray of int, shape (rows,)
        Which of those rows the problem has.
    layout : PairLayout
        Division of the rows into pairs.
    friction, load : ndarray, shape (rows,)
        Measured friction and load torque. [N·m]
    friction_base, load_base : ndarray, shape (rows, parameters)
        Derivatives of the simulated friction by its parameters, and of the simulated load by the
        coefficients of gravity.
    names : tuple of str
        Friction parameters that the columns of ``friction_base`` belong to.
    parameters : FrictionParameters
        Parameters of friction, fitted to these data.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of cos q, sin q and 1, and of the first two per mass of the payload where two
        payloads are known: those of the columns of ``load_base``. [N·m], [N·m/kg]
    has_load_channel : bool
        Whether the log has a load channel; the base model takes the load from it.
    temperature_error : float
        Standard error of the motor temperature. [°C]
    runs : tuple of str
        Names of the runs, in order.
    """

    table: EffectTable
    all_runs: EffectTable
    rows: Indices
    layout: PairLayout
    friction: Array
    load: Array
    friction_base: Array
    load_base: Array
    names: tuple[str, ...]
    parameters: FrictionParameters
    gravity: Array
    has_load_channel: bool
    temperature_error: float
    runs: tuple[str, ...]

    def basis(self, effect: Effect, shape: Mapping[str, float]) -> Basis:
        """Return an effect's columns at these rows, evaluated on all runs."""
        friction, load = effect.evaluate(self.all_runs, shape)
        return Basis(friction[self.rows], load[self.rows])

    @property
    def temperature_variance(self) -> Array:
        """Variance of pair means from the error of the temperature, shape (pairs,). [(N·m)²]."""
        slope = self.layout.means(self.table.temperature_slope[:, np.newaxis])[:, 0]
        return np.square(self.temperature_error * slope)

    @property
    def friction_by_gravity(self) -> Array:
        """Derivatives of the friction torque by the coefficients of gravity, as of ``load_base``.

        Friction depends on the square of the load: without these columns a cause that changes the
        fitted gravity would show a second time, in friction.
        """
        if self.has_load_channel:
            return np.zeros_like(self.load_base)
        slope = 2 * self.parameters.alpha * self.table.load
        return slope[:, np.newaxis] * without_offset(self.load_base)

    def squared(self, friction: Array, load: Array) -> Array:
        """Return the squared misfit of the simulated torque, shape (rows,). [(N·m)²].

        The misfit is load plus friction forward and load minus friction in reverse; the mean square
        of both is the sum of the squares. Where the log has a load channel, which may have another
        unit, the load is not simulated and only friction counts.

        Parameters
        ----------
        friction, load : ndarray, shape (rows,)
            Misfit in both channels. [N·m]
        """
        return np.square(friction) + (0.0 if self.has_load_channel else np.square(load))

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
    """Return the problem of one joint, and that of its hold-out run.

    The base model is fitted to the rows of the first only; the second is simulated with it. Gravity
    depends on the payload if two payloads are known in the rows of the first.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    held_out : str, optional
        Name of the hold-out run.

    Returns
    -------
    Problem, Problem or None
        Of all other runs, and of the hold-out run where there is one.
    """
    rows = torques.sort_values(["run", "time", "pair", "position"], ignore_index=True)
    new = (rows["run"] == held_out).to_numpy()
    columns = columns_of(rows, payloads=differs(known_payload(rows)[~new]))
    load = rows["load_torque"].to_numpy(float)
    gravity = np.linalg.lstsq(columns[~new], load[~new], rcond=None)[0]
    smooth = carried_load(columns, gravity) if rows["load"].isna().all() else load
    problem = min(
        (
            _assembled(rows, temperature, smooth, columns, gravity, base.parameters, base.names)
            for base in candidate_bases(rows.assign(load_torque=smooth)[~new], temperature)
        ),
        key=lambda problem: _typical_misfit(problem, ~new),
    )
    return _part(problem, ~new), _part(problem, new) if new.any() else None


def _typical_misfit(problem: Problem, chosen: Flags) -> float:
    """Return the median absolute misfit of the mean friction of the chosen pairs. [N·m]."""
    misfit = problem.layout.means(problem.friction_misfit[:, np.newaxis])[:, 0]
    return float(np.median(np.abs(misfit[np.unique(problem.layout.row_pair[chosen])])))


def simulated(
    torques: pd.DataFrame, temperature: str, parameters: FrictionParameters, gravity: Array
) -> tuple[pd.Index, Problem]:
    """Return the problem of rows simulated with a given base model, and its order of the rows.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    parameters : FrictionParameters
        Parameters of friction.
    gravity : ndarray, shape (3,) or (5,)
        Coefficients of cos q, sin q and 1, and of the first two per mass of the payload. [N·m],
        [N·m/kg]

    Returns
    -------
    Index, Problem
        Labels of the rows of ``torques`` in the order of the problem, and the problem.
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
    """Return the problem of all rows, with friction simulated by the base model."""
    pair = rows.groupby(PAIR_KEY, sort=False, observed=True).ngroup().to_numpy()
    run, run_names = pd.factorize(rows["run"])
    speed = rows["speed"].to_numpy(float)
    known_temperature = np.nan_to_num(temperature_of(rows, temperature).to_numpy(float), nan=0.0)
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
        temperature=known_temperature,
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
    reconstructed = np.nanmax(np.abs(reading - known_temperature), initial=0.0) > 1e-6
    without_friction = Problem(
        table=table,
        all_runs=table,
        rows=np.arange(len(run)),
        layout=layout,
        friction=rows["friction_torque"].to_numpy(float),
        load=rows["load_torque"].to_numpy(float),
        friction_base=np.empty((len(run), 0)),
        load_base=columns,
        names=names,
        parameters=parameters,
        gravity=gravity,
        has_load_channel=bool(rows["load"].notna().any()),
        temperature_error=_RECONSTRUCTED if reconstructed else _REGISTERED,
        runs=tuple(str(name) for name in run_names),
    )
    return _with_friction(without_friction)


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
        all_runs=table,
        friction_base=np.column_stack([derivative[name] for name in problem.names]),
    )


def _modelled(table: EffectTable, parameters: FrictionParameters) -> EffectTable:
    """Return a table with the columns that depend on the friction of the base model."""
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


def _part(problem: Problem, chosen: Flags) -> Problem:
    """Return the problem of some runs."""
    table = EffectTable(
        **{field.name: getattr(problem.table, field.name)[chosen] for field in fields(EffectTable)}
    )
    pairs = np.unique(problem.layout.row_pair[chosen])
    row_pair = np.searchsorted(pairs, problem.layout.row_pair[chosen])
    layout = PairLayout.of(
        row_pair=row_pair,
        run=problem.layout.run[pairs],
        time=problem.layout.time[pairs],
        speed=table.speed[np.flatnonzero(np.diff(row_pair, prepend=-1))],
        position=table.position,
    )
    return replace(
        problem,
        table=table,
        rows=np.flatnonzero(chosen),
        layout=layout,
        friction=problem.friction[chosen],
        load=problem.load[chosen],
        friction_base=problem.friction_base[chosen],
        load_base=problem.load_base[chosen],
        runs=tuple(problem.runs[number] for number in np.unique(layout.run)),
    )
