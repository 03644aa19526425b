"""Replay of all schedules of a grid of k and tmax in the phases of a joint."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd

from frictioncli.arrays import Array, Flags
from frictioncli.correction.phases import correction_phases
from frictioncli.correction.replay import PhaseData, Replay, replay
from frictioncli.correction.schedule import BY_READING
from frictioncli.correction.settings import CorrectionSettings
from frictioncli.model.document import FrictionModel
from frictioncli.model.friction import FrictionParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class ScheduleGrid:
    """Schedules by criterion (20) with every k and every tmax, in order of k, then of tmax.

    Attributes
    ----------
    criterion : {"first_degree", "latest_degree"}
        Interpretation of (20).
    k : tuple of float
        Scales, ascending.
    tmax : tuple of float
        Times after which a correction is forced, ascending. [s]
    """

    criterion: str
    k: tuple[float, ...]
    tmax: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Events:
    """Corrections of one schedule in one phase.

    Attributes
    ----------
    time : ndarray, shape (events,)
        Times of the corrections. [s]
    correction : ndarray, shape (events,)
        Temperature correction from each of these times on. [°C]
    failed : ndarray of bool, shape (events,)
        Corrections that could not be computed.
    """

    time: Array
    correction: Array
    failed: Flags


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayedPhase:
    """One phase of a run, over all thermal cycles, under every schedule of a grid.

    Attributes
    ----------
    run, name : str
        Name of the run, and ``heat-up`` or ``cool-down``.
    delta : float
        Parameter delta of (16). [1/°C]
    time, speed, temperature : ndarray, shape (pairs,)
        Time, speed and measured temperature of the pairs, in order of time. [s], [deg/s], [°C]
    term : ndarray, shape (pairs,)
        Temperature term of (16) without correction. [torque unit]
    error : ndarray, shape (pairs,)
        Predicted minus smoothed friction torque without correction. With a correction ΔT the
        difference is ``error + term*(exp(-delta*ΔT) - 1)``. [torque unit]
    uncorrected : float
        Error (21) without correction. [torque unit]
    epsilon : ndarray, shape (schedules,)
        Error (21) of each schedule. [torque unit]
    events : tuple of Events
        Corrections of each schedule.
    """

    run: str
    name: str
    delta: float
    time: Array
    speed: Array
    temperature: Array
    term: Array
    error: Array
    uncorrected: float
    epsilon: Array
    events: tuple[Events, ...]


def replayed_phases(
    torques: pd.DataFrame,
    model: FrictionModel,
    settings: CorrectionSettings,
    grid: ScheduleGrid,
    runs: Sequence[str],
) -> list[ReplayedPhase]:
    """Replay every schedule of a grid in every phase of the given runs, by run and time.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of all runs of one joint.
    model : FrictionModel
        The joint's model.
    settings : CorrectionSettings
        How corrections are computed.
    grid : ScheduleGrid
        Grid of schedules.
    runs : sequence of str
        Names of the runs.

    Raises
    ------
    NotEnoughData
        If the model has no temperature, or there is no heating or cooling phase.
    """
    segments: dict[tuple[str, str], list[PhaseData]] = {}
    for phase in correction_phases(torques, model, settings):
        if phase.run in runs:
            segments.setdefault((phase.run, phase.name), []).append(phase.data)
    return [
        _replayed(run, name, data, model.friction, grid) for (run, name), data in segments.items()
    ]


def _replayed(
    run: str,
    name: str,
    segments: list[PhaseData],
    parameters: FrictionParameters,
    grid: ScheduleGrid,
) -> ReplayedPhase:
    time, speed, temperature, smoothed = (
        np.concatenate([getattr(segment, column) for segment in segments])
        for column in ("time", "speed", "temperature", "smoothed")
    )
    uncorrected = _joined([replay(segment, parameters, ()) for segment in segments])
    by_segment = [_replays(segment, parameters, grid) for segment in segments]
    replays = [_joined(parts) for parts in zip(*by_segment, strict=True)]
    return ReplayedPhase(
        run=run,
        name=name,
        delta=parameters.delta,
        time=time,
        speed=speed,
        temperature=temperature,
        term=parameters.gamma * np.exp(-parameters.delta * temperature) * np.sqrt(speed),
        error=uncorrected.predicted - smoothed,
        uncorrected=uncorrected.epsilon(smoothed),
        epsilon=np.array([replayed.epsilon(smoothed) for replayed in replays]),
        events=tuple(
            Events(
                time=time[replayed.corrected],
                correction=replayed.correction[replayed.corrected],
                failed=replayed.failed[replayed.corrected],
            )
            for replayed in replays
        ),
    )


def _replays(data: PhaseData, parameters: FrictionParameters, grid: ScheduleGrid) -> list[Replay]:
    settings = np.array(list(product(grid.k, grid.tmax)))
    reading = BY_READING[grid.criterion]
    instants = reading(data.time, data.reading, k=settings[:, 0], tmax=settings[:, 1])
    return [replay(data, parameters, corrected) for corrected in instants]


def _joined(replays: Sequence[Replay]) -> Replay:
    """Return the replays of successive segments joined into one."""
    return Replay(
        *(
            np.concatenate([getattr(replayed, part) for replayed in replays])
            for part in ("corrected", "failed", "correction", "predicted")
        )
    )
