"""The phases of a joint under every schedule of a grid."""

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
    """Schedules by criterion (20): every k with every tmax, k by k.

    Attributes
    ----------
    criterion : {"first_degree", "latest_degree"}
        Reading of (20).
    k : tuple of float
        Scales, growing.
    tmax : tuple of float
        Times after which a correction is forced, growing. [s]
    """

    criterion: str
    k: tuple[float, ...]
    tmax: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Events:
    """The corrections of one schedule in one phase, shape (events,) each.

    Attributes
    ----------
    time : ndarray
        When. [s]
    correction : ndarray
        Temperature correction in force from then on. [°C]
    failed : ndarray of bool
        Where it could not be computed.
    """

    time: Array
    correction: Array
    failed: Flags


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayedPhase:
    """All stretches of one phase of a run, under every schedule of a grid.

    Attributes
    ----------
    run, name : str
        The run, and ``heat-up`` or ``cool-down``.
    delta : float
        Rate of the temperature term. [1/°C]
    time, speed, temperature : ndarray, shape (pairs,)
        Of the pairs in time order. [s], [deg/s], [°C]
    term : ndarray, shape (pairs,)
        The temperature term of (16) without correction. [torque unit]
    error : ndarray, shape (pairs,)
        Predicted minus smoothed friction torque without correction. With a correction by ΔT it is
        ``error + term*(exp(-delta*ΔT) - 1)``. [torque unit]
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
    """Replay every schedule of a grid in every phase of some runs, ordered by run and time.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of one joint, all its runs.
    model : FrictionModel
        Its model.
    settings : CorrectionSettings
        How corrections are computed.
    grid : ScheduleGrid
        The schedules.
    runs : sequence of str
        The runs.

    Raises
    ------
    NotEnoughData
        If the model does not know temperature, or no phase heats or cools.
    """
    stretches: dict[tuple[str, str], list[PhaseData]] = {}
    for phase in correction_phases(torques, model, settings):
        if phase.run in runs:
            stretches.setdefault((phase.run, phase.name), []).append(phase.data)
    return [
        _replayed(run, name, data, model.friction, grid) for (run, name), data in stretches.items()
    ]


def _replayed(
    run: str,
    name: str,
    stretches: list[PhaseData],
    parameters: FrictionParameters,
    grid: ScheduleGrid,
) -> ReplayedPhase:
    time, speed, temperature, smoothed = (
        np.concatenate([getattr(one, column) for one in stretches])
        for column in ("time", "speed", "temperature", "smoothed")
    )
    never = _joined([replay(one, parameters, ()) for one in stretches])
    by_stretch = [_scheduled(one, parameters, grid) for one in stretches]
    replays = [_joined(own) for own in zip(*by_stretch, strict=True)]
    return ReplayedPhase(
        run=run,
        name=name,
        delta=parameters.delta,
        time=time,
        speed=speed,
        temperature=temperature,
        term=parameters.gamma * np.exp(-parameters.delta * temperature) * np.sqrt(speed),
        error=never.predicted - smoothed,
        uncorrected=never.epsilon(smoothed),
        epsilon=np.array([one.epsilon(smoothed) for one in replays]),
        events=tuple(
            Events(
                time=time[one.corrected],
                correction=one.correction[one.corrected],
                failed=one.failed[one.corrected],
            )
            for one in replays
        ),
    )


def _scheduled(data: PhaseData, parameters: FrictionParameters, grid: ScheduleGrid) -> list[Replay]:
    settings = np.array(list(product(grid.k, grid.tmax)))
    reading = BY_READING[grid.criterion]
    instants = reading(data.time, data.reading, k=settings[:, 0], tmax=settings[:, 1])
    return [replay(data, parameters, own) for own in instants]


def _joined(replays: Sequence[Replay]) -> Replay:
    """Return the replays of successive stretches as one."""
    return Replay(
        *(
            np.concatenate([getattr(one, part) for one in replays])
            for part in ("corrected", "failed", "correction", "predicted")
        )
    )
