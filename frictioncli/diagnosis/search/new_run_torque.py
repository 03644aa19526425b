"""Other torque than a change that a run kept out may have in addition to those seen."""

from collections.abc import Mapping

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.effects.base import Basis, Channel, Effect
from frictioncli.effects.history import history, presence, spans_with
from frictioncli.effects.pair_series import measured_share

_LAGS = (1 / 8, 1 / 3, 1.0)
"""Time constants of slow torque that is tried instead, as shares of the run."""


def rivals_of_change(new: Problem, shape: Mapping[str, float], effect: Effect) -> list[Basis]:
    """Return other torque with the history of a change that might be left.

    Days differ in everything that friction depends on. Within a run a step of it is a step,
    whatever it depends on.

    Parameters
    ----------
    new : Problem
        Rows of the new run.
    shape : mapping of str to float
        History of the change.
    effect : Effect
        The change.
    """
    table = new.table
    there = presence(new.all_runs, shape)[new.rows]
    found = [
        Basis((there * table.friction)[:, np.newaxis], (there * table.load)[:, np.newaxis]),
        _in_channel("load", there),
    ]
    if effect.channel != "friction" or there.all():
        found += [
            _in_channel("friction", there * one)
            for one in (
                table.friction,
                np.sqrt(table.speed),
                table.temperature_slope,
                np.square(table.load),
            )
        ]
    return found


def slow_torque(new: Problem, shape: Mapping[str, float], effect: Effect) -> list[Basis]:
    """Return torque in the channel of a change that grows slowly, with the run or after it.

    A load that another joint changes by moving slowly varies with the angle as a payload does.
    Where a payload comes or goes within the run, that joint may have another pose from its start.

    Parameters
    ----------
    new : Problem
        Rows of the new run.
    shape : mapping of str to float
        History of the change.
    effect : Effect
        The change.
    """
    time = new.table.time
    there = presence(new.all_runs, shape)[new.rows]
    since = time - time.min()
    after = np.maximum(time - float(np.min(time[there > 0])), 0.0)
    duration = max(float(np.ptp(since)), 1e-9)
    slow = [
        one
        for run in (since, after)
        for one in (run, *(1 - np.exp(-run / (lag * duration)) for lag in _LAGS))
    ]
    found = [_in_channel(effect.channel, one) for one in slow]
    if effect.channel == "friction":
        return found
    (throughout,) = spans_with(new.all_runs, np.unique(measured_share(new.all_runs)[new.rows]))
    own = new.basis(effect, history([throughout]))
    lasting = 0 if there.all() else own.load.shape[1]
    return found + [
        Basis(*(np.hstack([part[:, :lasting], one[:, np.newaxis] * part]) for part in own))
        for one in slow
    ]


def _in_channel(channel: Channel, torque: Array) -> Basis:
    values, nothing = torque[:, np.newaxis], np.zeros((len(torque), 1))
    return Basis(values, nothing) if channel == "friction" else Basis(nothing, values)
