"""Base models about which a diagnosis may be linear."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.data.pair_layout import speed_level
from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import FrictionParameters
from frictioncli.model.identifiability import determined_fit
from frictioncli.model.observations import observations
from frictioncli.model.zero_load import PAIR_KEY

_COMMON = 0.05
"""Speeds of a smaller share of the pairs are rare."""


@dataclass(frozen=True, slots=True)
class Base:
    """A base model to be linear about.

    Attributes
    ----------
    parameters : FrictionParameters
        Its parameters.
    names : tuple of str
        Those that may change.
    """

    parameters: FrictionParameters
    names: tuple[str, ...]


def candidate_bases(rows: pd.DataFrame, temperature: str) -> list[Base]:
    """Return base models: of all pairs, and of the speeds that hold most of them.

    A few pairs at rare speeds that obey another law would bend the parameters so far that a model
    linear about them explains nothing any more. Beta may change wherever gamma may, even where the
    fit could not tell them apart: what is hidden in the torques may be why.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint, with its smooth load.
    temperature : {"motor", "housing", "mean"}
        Temperature that the friction function is given.
    """
    heads = rows.drop_duplicates(PAIR_KEY)
    level = speed_level(heads["speed"].to_numpy(float))
    _, place, count = np.unique(level, return_inverse=True, return_counts=True)
    common = count >= _COMMON * len(heads)
    chosen = [rows]
    if not common.all() and common.sum() >= 3:
        kept = heads.loc[common[place], PAIR_KEY]
        chosen.append(rows.merge(kept, on=PAIR_KEY))
    return [_base(part, temperature) for part in chosen]


def _base(rows: pd.DataFrame, temperature: str) -> Base:
    estimate, _ = determined_fit(observations(rows, temperature))
    free = {*estimate.names, "beta"} if "gamma" in estimate.names else set(estimate.names)
    return Base(estimate.parameters, tuple(name for name in PARAMETERS if name in free))
