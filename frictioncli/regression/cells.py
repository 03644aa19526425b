"""Torques by speed, angle and time from the rows of a regression.

A *pair* of the table is motion at nearly one speed, temperature and time, with all rows of either
direction; no move is its partner. Inertial torque is subtracted from every row. Where both
directions pass an angle bin, friction is half of their difference, as of a pair of moves: gravity
cancels whatever its form. Else gravity of the regression is subtracted.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Numbers
from frictioncli.pairs.thermal_phases import phases, phases_of
from frictioncli.regression.determination import JointRegression
from frictioncli.regression.equation import load_columns, root_speed
from frictioncli.regression.motion_rows import MotionLog

FEW_ROWS = "too few at that speed and time"
ONE_WAY = "angle passed in one direction only"

_SPEED_RATIO = 1.12
"""Ratio of the bounds of a level of speed."""

_LONGEST = 600.0
"""Longest time that a pair spans. [s]"""

_WARMER = 2.0
"""Greatest difference of temperature in a pair. [°C]"""

_ROWS = 24
"""Rows of a pair, where there are enough for several."""

_MOST_PAIRS = 1500
"""Pairs of a joint, about; long logs have more rows in each."""

_LEAST_ROWS = 6
"""Least rows of a pair."""

_BOTH_WAYS = 0.5
"""Share of rows in bins that both directions pass from which only these bins are kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueCells:
    """Rows of :data:`frictioncli.schemas.TORQUES` of one joint.

    Attributes
    ----------
    table : DataFrame
        The rows.
    dropped : dict of str to int
        Samples in none of them, by reason.
    both_ways : bool
        Whether every row holds both directions.
    """

    table: pd.DataFrame
    dropped: dict[str, int]
    both_ways: bool


def torque_cells(
    found: JointRegression,
    motion: MotionLog,
    joint: int,
    bin_width: float,
    phase: pd.Series | None = None,
) -> TorqueCells:
    """Return the torques of a joint by pair and angle bin.

    Parameters
    ----------
    found : JointRegression
        Its regression.
    motion : MotionLog
        Names of runs and recordings.
    joint : int
        Its number.
    bin_width : float
        Width of the angle bins. [deg]
    phase : Series, optional
        Phase by run and recording, missing where unknown.

    Returns
    -------
    TorqueCells
        The rows, ordered by run, pair and angle.
    """
    rows = found.equations.rows
    group = _groups(found)
    counts = np.bincount(group)
    kept = counts[group] >= _LEAST_ROWS
    angle = np.floor(rows.position / bin_width).astype(np.int64)
    data = pd.DataFrame(
        {
            "group": group,
            "bin": angle,
            "forward": found.equations.direction > 0,
            "torque": _frictionless_motion(found, group, np.asarray((angle + 0.5) * bin_width)),
            "load_model": found.load(),
            "load": rows.load,
            "samples": rows.samples,
        }
    )[kept]
    dropped = {FEW_ROWS: int(rows.samples[~kept].sum())}
    cells = _cells(data, found, bin_width)
    both = (cells["n_forward"] > 0) & (cells["n_reverse"] > 0)
    samples = cells["n_forward"] + cells["n_reverse"]
    both_ways = bool(samples[both].sum() >= _BOTH_WAYS * samples.sum())
    if both_ways:
        dropped[ONE_WAY] = int(samples[~both].sum())
        cells = cells[both]
    pairs = _pairs(found, motion, group, phase)
    table = cells.join(pairs, on="group").assign(joint=joint)
    table = table.sort_values(["run", "pair", "position"], ignore_index=True)
    # numbers without gaps, in order of time within the run
    table["pair"] = table.groupby("run", observed=True)["pair"].rank("dense").astype(int) - 1
    return TorqueCells(
        table=table.drop(columns=["group", "bin"]),
        dropped={reason: n for reason, n in dropped.items() if n},
        both_ways=both_ways,
    )


def _groups(found: JointRegression) -> Numbers:
    """Return the pair of each row: one run, state of load, level of speed, temperature and time."""
    rows, speed = found.equations.rows, np.abs(found.equations.velocity)
    level = np.round(np.log(np.maximum(speed, 1e-9)) / np.log(_SPEED_RATIO)).astype(np.int64)
    warm = np.floor(np.nan_to_num(rows.motor_temperature) / _WARMER).astype(np.int64)
    block = np.floor(rows.time / _LONGEST).astype(np.int64)
    keys = pd.DataFrame(
        {
            "run": rows.run,
            "state": found.equations.state,
            "level": level,
            "warm": warm,
            "block": block,
        }
    )
    coarse = keys.groupby(list(keys.columns), sort=False).ngroup().to_numpy()
    part = _parts(
        coarse, rows.move, found.equations.direction, max(_ROWS, len(rows) // _MOST_PAIRS)
    )
    fine = pd.DataFrame({"coarse": coarse, "part": part})
    return np.asarray(fine.groupby(["coarse", "part"], sort=False).ngroup(), dtype=np.int64)


def _parts(coarse: Numbers, move: Numbers, direction: Array, wanted: int) -> Numbers:
    """Return a part of its group for each row, with about the wanted rows.

    Where a group has both directions, a part has an even number of whole moves, so that it has
    both too.
    """
    frame = pd.DataFrame({"coarse": coarse, "move": move, "forward": direction > 0})
    grouped = frame.groupby("coarse", sort=False)
    new = frame["move"].ne(grouped["move"].shift()).astype(int)
    place = new.groupby(frame["coarse"]).cumsum() - 1
    rows, moves = grouped["move"].transform("size"), new.groupby(frame["coarse"]).transform("sum")
    share = grouped["forward"].transform("mean")
    both = (share > 0) & (share < 1)
    together = 2 * np.ceil(wanted * moves / (2 * rows)).clip(lower=1).astype(int)
    by_move = np.minimum(place // together, np.maximum(moves // together, 1) - 1)
    by_row = grouped.cumcount() * np.maximum(rows // wanted, 1) // rows
    return np.where(both, by_move, by_row).astype(np.int64)


def _frictionless_motion(found: JointRegression, group: Numbers, centre: Array) -> Array:
    """Return torque less inertia and load, with friction at a pair's speed and bin's centre."""
    estimate, equations = found.estimate, found.equations
    coefficients = estimate.load_coefficients
    frictionless = load_columns(equations, estimate.terms, estimate.delay) @ coefficients
    root = root_speed(equations, estimate.delay)
    fitted = estimate.parameters
    decay = np.exp(-fitted.get("delta", 0.0) * equations.temperature)
    viscous = found.sign * (fitted.get("beta", 0.0) + fitted.get("gamma", 0.0) * decay)
    counts = np.bincount(group)
    speed = np.bincount(group, np.abs(equations.velocity)) / counts
    mean_viscous = np.bincount(group, viscous) / counts
    carried = mean_viscous[group] * np.sqrt(speed)[group] - viscous * root
    law = estimate.terms.speed_law
    falling = found.sign * np.array([fitted[name] for name in law.names])
    carried += (law.columns(speed) @ falling)[group] - law.columns(np.square(root)) @ falling
    if "alpha" in fitted and _has_one_gravity(found):
        at_centre = np.square(_gravity_at(found, centre))
        carried += found.sign * fitted["alpha"] * (at_centre - estimate.squared_load)
    motion = equations.rows.torque - frictionless
    return np.asarray(motion + found.sign * equations.direction * carried)


def _cells(data: pd.DataFrame, found: JointRegression, bin_width: float) -> pd.DataFrame:
    """Return means by pair and angle bin, both directions side by side."""
    keys = ["group", "bin"]
    means = data.groupby([*keys, "forward"], sort=False).agg(
        torque=("torque", "mean"), n=("samples", "sum")
    )
    wide = means.unstack("forward")  # noqa: PD010
    cells = data.groupby(keys, sort=False).agg(
        load_model=("load_model", "mean"), load=("load", "mean")
    )
    cells = cells.reindex(wide.index).reset_index()
    cells["position"] = (cells["bin"] + 0.5) * bin_width
    if _has_one_gravity(found):
        cells["load_model"] = _gravity_at(found, cells["position"].to_numpy(float))
    sides = {}
    for name, forward in (("forward", True), ("reverse", False)):
        has = ("torque", forward) in wide
        torque = wide["torque", forward].to_numpy(float) if has else np.nan
        cells[f"torque_{name}"] = torque + cells["load_model"]
        count = wide["n", forward].fillna(0).to_numpy() if has else 0
        cells[f"n_{name}"] = np.asarray(count).astype(np.int64)
        sides[name] = cells[f"torque_{name}"].to_numpy(float)
    both = np.isfinite(sides["forward"]) & np.isfinite(sides["reverse"])
    half = (sides["forward"] - sides["reverse"]) / 2
    alone = np.where(
        np.isfinite(sides["forward"]),
        sides["forward"] - cells["load_model"],
        cells["load_model"] - sides["reverse"],
    )
    cells["friction_torque"] = found.sign * np.where(both, half, alone)
    middle = (sides["forward"] + sides["reverse"]) / 2
    load = np.where(both, middle, cells["load_model"])
    measured = cells["load"].to_numpy(float)
    cells["load_torque"] = np.where(np.isfinite(measured), measured, load)
    return cells.drop(columns="load_model")


def _has_one_gravity(found: JointRegression) -> bool:
    """Return whether the load is a function of the angle alone."""
    terms = found.estimate.terms
    return not terms.load_channel and not terms.base_parameters and len(terms.payloads) == 1


def _gravity_at(found: JointRegression, position: Array) -> Array:
    """Return the load of the regression at some angles, of its only payload."""
    fitted = found.estimate.parameters
    angle = np.radians(position)
    cosine, sine = fitted.get("gravity_cos", 0.0), fitted.get("gravity_sin", 0.0)
    return np.asarray(cosine * np.cos(angle) + sine * np.sin(angle) + fitted.get("offset", 0.0))


def _pairs(
    found: JointRegression, motion: MotionLog, group: Numbers, phase: pd.Series | None
) -> pd.DataFrame:
    """Return what is constant in each pair, numbered in order of time within its run."""
    rows = found.equations.rows
    terms, state = found.estimate.terms, found.equations.state
    frame = pd.DataFrame(
        {
            "group": group,
            "run": rows.run,
            "recording": rows.recording,
            "speed": np.abs(found.equations.velocity),
            "time": rows.time,
            "motor_temperature": rows.motor_temperature,
            "housing_temperature": rows.housing_temperature,
            "motor_temperature_reading": rows.motor_temperature_reading,
            "payload": np.array(terms.payloads)[state],
            "pose": np.array(terms.poses)[state],
        }
    )
    grouped = frame.groupby("group")
    pairs = grouped.mean().assign(
        run=grouped["run"].first(), recording=grouped["recording"].first()
    )
    pairs = pairs.sort_values(["run", "time"])
    pairs["pair"] = pairs.groupby("run").cumcount()
    trend = np.empty(len(pairs), dtype=object)
    for _, index in pairs.groupby("run").indices.items():
        own = pairs.iloc[index]
        trend[index] = phases_of(own["pair"].to_numpy(), phases(own["motor_temperature"].tolist()))
    given = np.full(len(pairs), None, dtype=object)
    if phase is not None:
        keys = pd.MultiIndex.from_tuples(motion.recordings, names=["run", "recording"])
        given = phase.reindex(keys).to_numpy(object)[pairs["recording"].to_numpy(np.int64)]
    pairs["phase"] = np.where(pd.isna(given), trend, given)
    names = np.array(motion.runs, dtype=object)
    return pairs.assign(run=names[pairs["run"].to_numpy(np.int64)]).drop(columns="recording")
