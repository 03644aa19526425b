"""Planting of an effect into the samples of a log."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.signal import lfilter

from frictioncli.arrays import Array
from frictioncli.challenge.log_state import LogState
from frictioncli.challenge.logged_run import LoggedRun, recordings
from frictioncli.simulator.planted.effect import PlantedEffect


@dataclass(frozen=True, slots=True, kw_only=True)
class LogTiming:
    """How late the log holds torque, as far as that is known.

    Attributes
    ----------
    delay : float
        Time by which torque is logged later than position. [s]
    time_constant : float
        Time constant of a first-order filter of the torque. [s]
    """

    delay: float = 0.0
    time_constant: float = 0.0


def planted_samples(
    samples: pd.DataFrame,
    states: Sequence[LogState],
    effect: PlantedEffect,
    sign: int,
    timing: LogTiming | None = None,
) -> pd.DataFrame:
    r"""Return samples with the torque that an effect adds.

    Parameters
    ----------
    samples : DataFrame
        Rows of :data:`frictioncli.schemas.SAMPLES` of a single joint, numbered from 0.
    states : sequence of LogState
        State of the joint in each run.
    effect : PlantedEffect
        The effect.
    sign : {+1, -1}
        Sign of friction in forward motion.
    timing : LogTiming, optional
        How late the log holds torque; the planted torque is as late.

    Returns
    -------
    DataFrame
        The samples with another torque, and another load where the log has that channel.

    Notes
    -----
    .. math:: u' = u + \Delta L + s\, \operatorname{sign}(\dot q)\, \Delta\tau

    with the sign convention :math:`s` of the log; where it has a load channel,
    :math:`\Delta L` is added to that.
    """
    torque, load = samples["torque"].to_numpy(float).copy(), samples["load"].to_numpy(float).copy()
    for state in states:
        friction, carried = added_torque(state, effect, sign)
        has_load = bool(np.isfinite(state.run.load).any())
        onto_torque = friction if has_load else friction + carried
        torque[state.run.rows] += delayed(state.run, onto_torque, timing or LogTiming())
        if has_load:
            load[state.run.rows] += carried
    return samples.assign(torque=torque, load=load)


def added_torque(state: LogState, effect: PlantedEffect, sign: int) -> tuple[Array, Array]:
    """Return the torque that an effect adds at each sample of a run.

    Parameters
    ----------
    state : LogState
        State of the joint.
    effect : PlantedEffect
        The effect.
    sign : {+1, -1}
        Sign of friction in forward motion.

    Returns
    -------
    friction, load : ndarray, shape (samples,)
        What friction and what load add to the logged torque. [torque unit], [load unit]
    """
    added = effect.torque(state)
    shape = state.position.shape
    friction = sign * state.direction * np.broadcast_to(added.friction, shape)
    return friction, np.array(np.broadcast_to(added.load, shape), dtype=float)


def delayed(run: LoggedRun, torque: Array, timing: LogTiming) -> Array:
    """Return torque as late as a log holds it, recording by recording.

    Parameters
    ----------
    run : LoggedRun
        The run.
    torque : ndarray, shape (samples,)
        Torque at the moment of each sample. [torque unit]
    timing : LogTiming
        Delay and filter.
    """
    if timing == LogTiming():
        return torque
    late = np.empty_like(torque)
    for part in recordings(run.recording):
        time, own = run.time[part], torque[part]
        own = np.interp(time - timing.delay, time, own)
        period = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
        if timing.time_constant > 0 and period > 0:
            memory = float(np.exp(-period / timing.time_constant))
            own = lfilter([1.0 - memory], [1.0, -memory], own, zi=[memory * own[0]])[0]
        late[part] = own
    return late
