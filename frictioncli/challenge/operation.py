"""Operating history of a joint as far as its log tells it: temperatures, heat, travel and rests."""

from collections.abc import Sequence

import numpy as np

from frictioncli.arrays import Array, Flags
from frictioncli.challenge.logged_run import LoggedRun
from frictioncli.simulator.planted.operating_history import (
    NIGHT,
    SHORTEST_REST,
    TIME_STEP,
    EarlierRuns,
    OperatingHistory,
)
from frictioncli.simulator.thermal_history import MOTOR

ROOM = 40.0
"""Temperature that stands for one that the log lacks. [°C]"""

_WARMED = 0.2
"""Rise of the motor's temperature over a gap of the log above which the joint moved in it. [°C]"""


def operating_histories(
    runs: Sequence[LoggedRun], powers: Sequence[Array], standing: float
) -> list[OperatingHistory]:
    """Return the operating history of each run.

    Where the log has a gap of a minute or more, the joint has moved at its highest speed if the
    motor is warmer after it, and else has rested.

    Parameters
    ----------
    runs : sequence of LoggedRun
        The runs in their order.
    powers : sequence of ndarray, shape (samples,)
        Dissipated power of their samples. [W]
    standing : float
        Speed below which the joint stands. [deg/s]
    """
    durations = [float(run.time[-1]) + TIME_STEP for run in runs]
    temperatures = [motor_temperature(run) for run in runs]
    ambient = min(float(one.min()) for one in temperatures)
    histories: list[OperatingHistory] = []
    travelled = 0.0
    for number, (run, power, motor) in enumerate(zip(runs, powers, temperatures, strict=True)):
        steps, gap, moved = _gaps(run, motor)
        speed = np.abs(run.velocity)
        way = np.where(gap, moved * steps * speed.max(), steps * speed[:-1])
        ends, rests = _rests(run, steps, gap, moved, standing)
        grid = np.arange(0.0, durations[number] + TIME_STEP, TIME_STEP)
        travel = np.concatenate([[0.0], np.cumsum(way)])
        histories.append(
            OperatingHistory(
                earlier=EarlierRuns(
                    operated=sum(durations[:number]), travelled=travelled, total=sum(durations)
                ),
                angles=(float(run.position.min()), float(run.position.max())),
                times=grid,
                temperatures={MOTOR: np.interp(grid, run.time, motor)},
                ambient=np.full(len(grid), ambient),
                heat=_heat(run, power, grid, gap, moved),
                edges=run.time,
                travel=travel,
                rest_ends=ends,
                rests=rests,
            )
        )
        travelled += float(travel[-1])
    return histories


def motor_temperature(run: LoggedRun) -> Array:
    """Return the motor temperature with gaps filled in; a constant where it is not logged [°C]."""
    known = np.isfinite(run.motor)
    if not known.any():
        return np.full(len(run.time), ROOM)
    return np.asarray(np.interp(run.time, run.time[known], run.motor[known]))


def _gaps(run: LoggedRun, motor: Array) -> tuple[Array, Flags, Flags]:
    """Return the steps of time [s], which are gaps, and in which of them the joint moved."""
    steps = np.diff(run.time)
    gap = steps > SHORTEST_REST
    return steps, gap, gap & (np.diff(motor) > _WARMED)


def _rests(
    run: LoggedRun, steps: Array, gap: Flags, moved: Flags, standing: float
) -> tuple[Array, Array]:
    """Return ends and durations of rests; the one before the first sample is a night [s]."""
    still = np.where(gap, ~moved, np.abs(run.velocity[:-1]) <= standing)
    ends, rests = [float(run.time[0])], [NIGHT]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        duration = float(steps[begin:end].sum())
        if duration > SHORTEST_REST:
            ends.append(float(run.time[end]))
            rests.append(duration)
    return np.array(ends), np.array(rests)


def _heat(run: LoggedRun, power: Array, grid: Array, gap: Flags, moved: Flags) -> Array:
    """Return the mean power per step of the grid; the run's mean in motion not logged [W]."""
    cell = np.minimum((run.time / TIME_STEP).astype(int), len(grid) - 1)
    count = np.bincount(cell, minlength=len(grid))
    heat = np.bincount(cell, weights=power, minlength=len(grid)) / np.maximum(count, 1)
    usual = float(power.mean())
    for i in np.flatnonzero(gap & moved):
        inside = (grid >= run.time[i]) & (grid < run.time[i + 1]) & (count == 0)
        heat[inside] = usual
    return np.asarray(heat)
