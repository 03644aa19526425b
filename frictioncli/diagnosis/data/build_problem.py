"""Problems of one joint from its torques, with the base model fitted to them or given."""

from dataclasses import replace

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.diagnosis.data.base_models import candidate_bases
from frictioncli.diagnosis.data.gravity import (
    GravityForm,
    by_angle,
    carried_load,
    differs,
    form_of,
    gravity_in_torque,
    known_payload,
    known_pose,
    sign_convention,
)
from frictioncli.diagnosis.data.hidden_temperature import HiddenTemperature
from frictioncli.diagnosis.data.motion_history import (
    clock_of,
    distance_of_pairs,
    pauses_of,
    series,
    travel_of,
    unrecorded_motion,
)
from frictioncli.diagnosis.data.pair_layout import PairLayout
from frictioncli.diagnosis.data.pose_gravity import gravities_by_pose
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.data.temperature_error import temperature_error
from frictioncli.diagnosis.data.within_noise import WithinNoise
from frictioncli.effects.base import EffectTable
from frictioncli.effects.pair_series import rows_of
from frictioncli.logs.runs.run_order import sorted_rows
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import FrictionParameters, friction_torque
from frictioncli.model.zero_load import PAIR_KEY, temperature_of


def build_problems(
    torques: pd.DataFrame, temperature: str, held_out: str | None = None
) -> tuple[Problem, Problem | None]:
    """Return the problem of one joint, and that of its hold-out run.

    The base model is fitted to the rows of the first only; the second is simulated with it. Gravity
    goes with the payloads, and the poses of other joints, that differ in the first. With those that
    only the hold-out run has, gravity is not predicted but fitted to that run.

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
    rows = sorted_rows(torques).reset_index(drop=True)
    new = (rows["run"] == held_out).to_numpy()
    load = rows["load_torque"].to_numpy(float)
    form = _gravity_form(rows[~new], load[~new])
    columns = form.columns(rows)
    gravity = np.linalg.lstsq(columns[~new], load[~new], rcond=None)[0]
    unseen = _unseen_gravity(rows, new, load - columns @ gravity, form)
    smooth = carried_load(columns, gravity) + unseen if rows["load"].isna().all() else load
    rows["load_torque"] -= unseen
    by_gravity = (form, columns, gravity)
    problem = min(
        (
            _assembled(rows, temperature, smooth, by_gravity, base.parameters, base.names)
            for base in candidate_bases(rows.assign(load_torque=smooth)[~new], temperature)
        ),
        key=lambda problem: _typical_misfit(problem, ~new),
    )
    return problem.part(~new), problem.part(new) if new.any() else None


def _gravity_form(rows: pd.DataFrame, load: Array) -> GravityForm:
    """Return what the gravity of rows depends on."""
    form = GravityForm(payloads=differs(known_payload(rows)))
    pair = rows.groupby(PAIR_KEY, sort=False, observed=True).ngroup().to_numpy()
    position = rows["position"].to_numpy(float)
    poses = gravities_by_pose(load, form.columns(rows), position, known_pose(rows), pair)
    return GravityForm(form.payloads, poses)


def _unseen_gravity(rows: pd.DataFrame, new: Flags, misfit: Array, form: GravityForm) -> Array:
    """Return what poses and payloads that only the hold-out run has add to gravity [N·m].

    They are known, so that it is no change that has to be found.
    """
    mass = np.nan_to_num(known_payload(rows)) * (not form.payloads)
    states = np.column_stack([np.nan_to_num(known_pose(rows), nan=-1.0), mass])
    added = np.zeros(len(rows))
    for state in np.unique(states[new], axis=0):
        own = (states == state).all(axis=1)
        if not (own & ~new).any():
            columns = GravityForm().columns(rows[own])[:, :2]
            added[own] = columns @ np.linalg.lstsq(columns, misfit[own], rcond=None)[0]
    return added


def _typical_misfit(problem: Problem, chosen: Flags) -> float:
    """Return the median absolute misfit of the mean friction of the chosen pairs [N·m]."""
    misfit = problem.layout.means(problem.friction_misfit[:, np.newaxis])[:, 0]
    return float(np.median(np.abs(misfit[np.unique(problem.layout.row_pair[chosen])])))


def simulated(
    torques: pd.DataFrame,
    temperature: str,
    parameters: FrictionParameters,
    gravity: Array,
    hidden: HiddenTemperature | None = None,
    form: GravityForm | None = None,
    noise: WithinNoise | None = None,
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
    gravity : ndarray, shape (coefficients,)
        Coefficients of cos q, sin q and 1, of the first two per mass of the payload, and of those
        of further poses. [N·m], [N·m/kg]
    hidden : HiddenTemperature, optional
        Temperature of the gear at which friction is simulated; by default the measured one.
    form : GravityForm, optional
        What the gravity depends on; by default that of three or five coefficients.
    noise : WithinNoise, optional
        Noise within pairs; by default it is estimated from the rows.

    Returns
    -------
    Index, Problem
        Labels of the rows of ``torques`` in the order of the problem, and the problem.
    """
    rows = sorted_rows(torques)
    form = form or form_of(gravity)
    columns = form.columns(rows)
    smooth = rows["load"].isna().all()
    load = carried_load(columns, gravity) if smooth else rows["load_torque"].to_numpy(float)
    given = (rows.reset_index(drop=True), temperature, load, (form, columns, gravity))
    return rows.index, _assembled(*given, parameters, PARAMETERS, hidden, noise)


def _assembled(
    rows: pd.DataFrame,
    temperature: str,
    load: Array,
    by_gravity: tuple[GravityForm, Array, Array],
    parameters: FrictionParameters,
    names: tuple[str, ...],
    hidden: HiddenTemperature | None = None,
    noise: WithinNoise | None = None,
) -> Problem:
    """Return the problem of all rows, with friction simulated by the base model.

    ``by_gravity`` is the form of gravity, its columns and its coefficients.
    """
    form, columns, gravity = by_gravity
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
        noise=noise,
    )
    channels = rows[["friction_torque", "load_torque"]].to_numpy(float)
    layout = layout.split_at_jumps(channels, position)
    if noise is None:
        layout = layout.with_noise_from(channels, position)
    motor = rows["motor_temperature"].to_numpy(float)
    friction = rows["friction_torque"].to_numpy(float)
    reference_power = 100.0 * max(float(np.mean(np.abs(friction))), 1e-12)
    if hidden is not None:
        reference_power = hidden.reference_power
    distance = distance_of_pairs(rows)
    pause = pauses_of(layout, distance)
    moved, warmed_to = unrecorded_motion(layout, pause, motor[heads])
    rest, order = series(layout, pause, moved)
    counted = sign_convention(rows)
    in_torque = gravity if rows["load"].isna().all() else gravity_in_torque(rows, columns)
    table = EffectTable(
        run=run,
        pair=pair,
        time=rows["time"].to_numpy(float),
        clock=clock_of(layout)[pair],
        speed=speed,
        position=position,
        angle=position,
        load=load,
        load_gradient=counted * (by_angle(columns) @ in_torque),
        load_curvature=by_angle(by_angle(columns)) @ in_torque,
        temperature=known_temperature,
        measured_temperature=known_temperature,
        motor_temperature=motor,
        housing_temperature=rows["housing_temperature"].to_numpy(float),
        friction=np.zeros_like(speed),
        viscous=np.zeros_like(speed),
        temperature_slope=np.zeros_like(speed),
        load_slope=np.zeros_like(speed),
        friction_power=friction * speed / reference_power,
        moved=np.append(0.0, moved * pause)[pair],
        warmed_to=np.append(motor[0], warmed_to)[pair],
        travel=travel_of(layout, distance, pause, moved)[pair],
        rest=rest[pair],
        order=order[pair],
    )
    reading = rows["motor_temperature_reading"].to_numpy(float)
    without_friction = Problem(
        table=table,
        all_runs=table,
        rows=np.arange(len(run)),
        layout=layout,
        friction=friction,
        load=rows["load_torque"].to_numpy(float),
        friction_base=np.empty((len(run), 0)),
        load_base=columns,
        names=names,
        parameters=parameters,
        gravity=gravity,
        gravity_form=form,
        reference_power=reference_power,
        counted=counted,
        has_load_channel=bool(rows["load"].notna().any()),
        temperature_error=temperature_error(reading, known_temperature),
        runs=tuple(str(name) for name in run_names),
    )
    return at_temperature(without_friction, parameters, hidden)


def at_temperature(
    problem: Problem, parameters: FrictionParameters, hidden: HiddenTemperature | None
) -> Problem:
    """Return a problem with another base model, linear about a hidden temperature.

    Parameters
    ----------
    problem : Problem
        The rows.
    parameters : FrictionParameters
        Parameters of friction at that temperature.
    hidden : HiddenTemperature or None
        Temperature of the gear; none for the measured one.
    """
    all_runs, reference = problem.all_runs, problem.reference_power
    if hidden is not None:
        power = all_runs.friction_power * (reference / hidden.reference_power)
        all_runs, reference = replace(all_runs, friction_power=power), hidden.reference_power
    all_runs = _modelled(all_runs, parameters, hidden, measured_load=problem.has_load_channel)
    table = rows_of(all_runs, problem.rows)
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
        all_runs=all_runs,
        parameters=parameters,
        reference_power=reference,
        hidden=hidden,
        friction_base=np.column_stack([derivative[name] for name in problem.names]),
    )


def _modelled(
    table: EffectTable,
    parameters: FrictionParameters,
    hidden: HiddenTemperature | None,
    *,
    measured_load: bool,
) -> EffectTable:
    """Return a table of all runs with the columns that depend on the friction of the base model."""
    table = replace(table, temperature=table.measured_temperature)
    if hidden is not None:
        table = hidden.applied(table)
    temperature = table.temperature
    decay = np.exp(-parameters.delta * temperature)
    # a measured load has all that changes it already
    slope = 0.0 if measured_load else 2 * parameters.alpha
    return replace(
        table,
        friction=friction_torque(
            parameters, load=table.load, speed=table.speed, temperature=temperature
        ),
        viscous=parameters.beta + parameters.gamma * decay,
        temperature_slope=-parameters.delta * parameters.gamma * decay * np.sqrt(table.speed),
        load_slope=slope * table.load,
    )
