"""Base models (16) about which the extended model is linear."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.pair_layout import speed_level
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import FrictionParameters
from frictioncli.model.identifiability import determined_fit, load_varies
from frictioncli.model.late_torque import torque_delay, without_delay
from frictioncli.model.observations import observations
from frictioncli.model.zero_load import PAIR_KEY

_COMMON = 0.05
"""Least share of the pairs at a speed level that is not rare."""

_MOST = 0.5
"""Least share of the pairs at all common speeds together."""


@dataclass(frozen=True, slots=True)
class Base:
    """A base model about which the extended model is linear.

    Attributes
    ----------
    parameters : FrictionParameters
        Its parameters.
    names : tuple of str
        Names of the parameters that the extension refits.
    """

    parameters: FrictionParameters
    names: tuple[str, ...]


def candidate_bases(rows: pd.DataFrame, temperature: str) -> list[Base]:
    """Return base models fitted to all pairs, and to those at common speeds only.

    A few pairs at rare speeds that follow another law would bend the parameters so far that a model
    linear about them explains nothing. Gamma and delta stay where delta is vague, and beta is
    refitted wherever gamma is, even where the fit could not distinguish them: the effect that is
    searched for may be the reason. What a late torque adds to friction looks like less of it by
    load, about which the effects of a delay and a filter would then be linear: it is taken off.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint, with the load torque of the
        base model.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    """
    rows = _without_delay(rows)
    pairs = rows.drop_duplicates(PAIR_KEY)
    level = speed_level(pairs["speed"].to_numpy(float))
    _, place, count = np.unique(level, return_inverse=True, return_counts=True)
    common = count >= _COMMON * len(pairs)
    samples = [rows]
    # where most speeds are rare, those few that are not have no law of their own
    mostly = count[common].sum() >= _MOST * len(pairs)
    if not common.all() and common.sum() >= 3 and mostly:
        samples.append(rows.merge(pairs.loc[common[place], PAIR_KEY], on=PAIR_KEY))
    return [_base(sample, temperature) for sample in samples]


def _without_delay(rows: pd.DataFrame) -> pd.DataFrame:
    measured_apart = bool(rows["load"].notna().any())
    delay = None if measured_apart else torque_delay(rows)
    return without_delay(rows, None if delay is None else delay.value)


def _base(rows: pd.DataFrame, temperature: str) -> Base:
    observed = observations(rows, temperature)
    estimate, _ = determined_fit(observed, vague_delta=True)
    free = set(estimate.names)
    if "gamma" in free:
        free.add("beta")
    if load_varies(observed, estimate, _noise_of_bins(rows)):
        free.add("alpha")
    return Base(estimate.parameters, tuple(name for name in PARAMETERS if name in free))


def _noise_of_bins(rows: pd.DataFrame) -> float:
    """Return the RMS of friction beside the mean of its pair and what all pairs have at an angle.

    A ripple of friction is no noise of the load. [N·m]
    """
    friction = rows["friction_torque"]
    within = friction - friction.groupby([rows[key] for key in PAIR_KEY]).transform("mean")
    left = within - within.groupby(rows["position"]).transform("mean")
    return float(np.sqrt(np.mean(np.square(left))))
