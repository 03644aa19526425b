"""Stage ``pair``: counter-directed motion at the same speed, joint, temperature and angle."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from frictioncli.errors import NotEnoughData
from frictioncli.motion.given import of_recordings
from frictioncli.motion.matching import (
    Matches,
    SpanArrays,
    match_visits,
    speed_levels,
)
from frictioncli.motion.settings import PairingSettings
from frictioncli.motion.spans import Spans

_OTHER_PAYLOAD = "the partner has another payload"

_ALIKE = 0.01
"""Speeds this close to the middle one of their level are one commanded speed."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """Rows of :data:`frictioncli.schemas.PAIRS` (without phase) and what was left over.

    ``dropped`` counts samples by reason; with the samples of the pairs they make ``samples``.
    """

    pairs: pd.DataFrame
    samples: int
    dropped: dict[str, int]
    bin_width: float


def pair_spans(
    found: Spans, settings: PairingSettings, payload: pd.Series | None = None
) -> Pairing:
    """Pair counter-directed spans and put both torques of each angle bin side by side.

    Moves with different payloads are loaded differently and make no pair; nor do a move whose
    payload is known and one whose is not. Of the latter two are taken to carry the same.

    Parameters
    ----------
    found : Spans
        The constant-velocity spans.
    settings : PairingSettings
        What makes a pair.
    payload : Series, optional
        Payload by run and recording, missing where unknown. [kg]

    Raises
    ------
    NotEnoughData
        If nothing moves at constant velocity, or nothing has a counter-directed partner.
    """
    if found.spans.empty:
        raise NotEnoughData(
            f"no constant-velocity motion in {found.samples} samples"
            f" ({_told(found.dropped)}); expected moves that hold a speed above"
            f" {settings.steady.min_speed:g} deg/s; look at the velocity, or loosen --min-speed,"
            " --speed-tolerance, --settling"
        )
    visits = found.visits
    spans = found.spans.assign(
        level=speed_levels(found.spans["speed"].to_numpy(), settings.same_speed),
        payload=np.nan if payload is None else of_recordings(found.spans, payload).astype(float),
    )
    matches = match_visits(_arrays(spans, visits), _groups(spans, "payload"), settings)
    used = matches.visit_couple >= 0
    other = ~used & _matches_another_payload(spans, visits, used, settings)
    if not used.any():
        mixed = f", {_OTHER_PAYLOAD}" if other.any() else ""
        raise NotEnoughData(
            f"no pair of counter-directed moves: {_directions(spans)}{mixed}; expected motion there"
            " and back over the same angles at the same speed; log both directions, or loosen"
            " --same-speed, --same-temperature, --longest-pause"
        )
    alone = ~np.isin(visits["span"], [span for couple in matches.couples for span in couple])
    dropped = found.dropped | {
        "no counter-directed partner": int(visits.loc[~used & ~other & alone, "n"].sum()),
        "angle not shared with the partner": int(visits.loc[~used & ~other & ~alone, "n"].sum()),
        _OTHER_PAYLOAD: int(visits.loc[other, "n"].sum()),
    }
    rows = _rows(spans, visits, matches, found.bin_width)
    return Pairing(rows, found.samples, dropped, found.bin_width)


def _groups(spans: pd.DataFrame, *also: str) -> list[NDArray[np.int64]]:
    """Return the spans that may pair with each other, in time order."""
    grouped = spans.groupby(["run", "joint", "level", *also], observed=True, dropna=False)
    return [group.sort_values("start").index.to_numpy() for _, group in grouped]


def _matches_another_payload(
    spans: pd.DataFrame, visits: pd.DataFrame, used: NDArray[np.bool_], settings: PairingSettings
) -> NDArray[np.bool_]:
    """Return which of the visits left over would have a partner if payloads did not matter."""
    found = np.zeros(len(visits), dtype=bool)
    if len(spans["payload"].unique()) > 1:
        # those of one payload have been matched as far as they can be
        rest = match_visits(_arrays(spans, visits[~used]), _groups(spans), settings)
        found[~used] = rest.visit_couple >= 0
    return found


def _arrays(spans: pd.DataFrame, visits: pd.DataFrame) -> SpanArrays:
    return SpanArrays(
        direction=spans["direction"].to_numpy(),
        start=spans["start"].to_numpy(),
        stop=spans["stop"].to_numpy(),
        temperature=spans["motor_temperature"].to_numpy(float),
        visit_span=visits["span"].to_numpy(np.int64),
        visit_bin=visits["bin"].to_numpy(np.int64),
        visit_time=visits["time"].to_numpy(float),
    )


def _told(dropped: dict[str, int]) -> str:
    return ", ".join(f"{reason}: {count}" for reason, count in dropped.items() if count)


def _directions(spans: pd.DataFrame) -> str:
    told = []
    for name, sign in (("forward", 1), ("reverse", -1)):
        speeds = spans.loc[spans["direction"] == sign, "speed"]
        reach = f" at {speeds.min():.3g} to {speeds.max():.3g} deg/s" if len(speeds) else ""
        told.append(f"{len(speeds)} constant-velocity parts {name}{reach}")
    return ", ".join(told)


def _rows(
    spans: pd.DataFrame,
    visits: pd.DataFrame,
    matches: Matches,
    bin_width: float,
) -> pd.DataFrame:
    """Return one row per pair and bin, pairs numbered in time order within run and joint."""
    heads = _heads(spans, matches.couples)
    used = visits.assign(couple=matches.visit_couple)[matches.visit_couple >= 0]
    ahead = used["span"].to_numpy(int) == heads["forward"].to_numpy()[used["couple"]]
    both = used[ahead].merge(used[~ahead], on=["couple", "bin"], suffixes=("_forward", "_reverse"))
    rows = both.join(heads, on="couple")
    return pd.DataFrame(
        {
            "run": rows["run"],
            "joint": rows["joint"],
            "pair": rows["pair"],
            "speed": rows["speed"],
            "time": rows["time"],
            "motor_temperature": rows["motor_temperature"],
            "housing_temperature": rows["housing_temperature"],
            "position": (rows["bin"] + 0.5) * bin_width,
            "torque_forward": rows["torque_forward"],
            "torque_reverse": rows["torque_reverse"],
            "n_forward": rows["n_forward"].astype(np.int64),
            "n_reverse": rows["n_reverse"].astype(np.int64),
            "motor_temperature_reading": rows["motor_temperature_reading"],
            "load": (rows["load_forward"] + rows["load_reverse"]) / 2,
            "payload": rows["payload"],
            "recording": rows["recording"],
        }
    ).sort_values(["run", "joint", "pair", "position"], ignore_index=True)


def _heads(spans: pd.DataFrame, couples: list[tuple[int, int]]) -> pd.DataFrame:
    """Return one row per pair: what its two spans have in common, and its number."""
    ahead = spans.iloc[[forward for forward, _ in couples]].reset_index(drop=True)
    back = spans.iloc[[reverse for _, reverse in couples]].reset_index(drop=True)
    heads = ahead[["run", "joint", "recording", "level", "payload"]].assign(
        forward=[forward for forward, _ in couples],
        time=(ahead["start"] + ahead["stop"] + back["start"] + back["stop"]) / 4,
        speed=(ahead["speed"] + back["speed"]) / 2,
    )
    for name in ("motor_temperature", "housing_temperature", "motor_temperature_reading"):
        heads[name] = (ahead[name] + back[name]) / 2
    # one commanded speed gets one number, so that results can be grouped by it
    level = [heads["joint"], heads["level"]]
    middle = heads.groupby(level)["speed"].transform("median")
    alike = (heads["speed"] - middle).abs() < _ALIKE * middle
    common = heads["speed"].where(alike).groupby(level).transform("mean")
    heads["speed"] = common.where(alike, heads["speed"])
    order = heads.sort_values(["run", "joint", "time", "forward"], kind="stable")
    numbers = order.groupby(["run", "joint"], observed=True).cumcount()
    return heads.assign(pair=numbers.reindex(heads.index))
