"""Rows of the blind study with what follows from them, and shares with their intervals."""

import json
from collections.abc import Iterable

import numpy as np
import pandas as pd
from scipy import stats

from tests.studies.blind_examined import COLUMNS, FAILED, NOT_PLANTED
from tests.studies.blind_worlds import KEY

_TEXT = (
    *("kind", "noise", "protocol", "hidden", "sources", "verdict", "sets", "p_values"),
    *("truth_probability", "visible_sets", "structure", "parameters", "coefficient"),
    *("detectable", "note"),
)

NOWHERE = 0.01
"""An effect of which less than this share of its size falls into the runs seen, or of which the
base leaves less than this share there, cannot be found by anyone."""

POWER = 0.8
"""A size is detectable if it is found as often."""


def told(rows: pd.DataFrame) -> pd.DataFrame:
    """Return typed rows with what follows from each.

    Added are ``found``, ``held`` (all that is hidden is in a set), ``first`` (it is the most
    probable of one), ``alone``, ``wrong`` (a set of one name that is not hidden), ``gain`` (0 where
    nothing was found), ``oracle_gain``, ``names`` (mean size of the sets) and ``possible``.
    """
    numbers = [name for name in COLUMNS if name not in _TEXT]
    rows = rows.copy()
    rows[numbers] = rows[numbers].apply(pd.to_numeric, errors="coerce")
    rows = rows.sort_values(list(KEY), ignore_index=True)
    sets = [sets_of(text) for text in rows["sets"]]
    hidden = [text.split("+") if text else [] for text in rows["hidden"]]
    both = list(zip(sets, hidden, strict=True))
    rows["found"] = ~rows["verdict"].isin(["no_evidence", NOT_PLANTED, FAILED])
    rows["held"] = [all(any(n in one for one in found) for n in truth) for found, truth in both]
    rows["first"] = [all(any(n == one[0] for one in found) for n in truth) for found, truth in both]
    rows["alone"] = [all([n] in found for n in truth) for found, truth in both]
    rows["wrong"] = [
        any(len(one) == 1 and one[0] not in truth for one in found) for found, truth in both
    ]
    rows["names"] = [np.mean([len(one) for one in found]) if found else np.nan for found in sets]
    rows["gain"] = rows["reduction"].fillna(0.0)
    rows["oracle_gain"] = 1.0 - rows["oracle"] / rows["before"]
    rows["possible"] = _possible(rows)
    return rows


def sets_of(text: str) -> list[list[str]]:
    """Return the credible sets of a row, strongest cause first."""
    return [one.split("|") for one in text.split(";") if one]


def _possible(rows: pd.DataFrame) -> pd.Series:
    """Return whether all that is hidden can show in the runs seen."""
    shows = (rows["raw"] > NOWHERE * rows["size"]) & (rows["visible"] > NOWHERE * rows["raw"])
    return shows | (rows["kind"] == "clean")


def asked(rows: pd.DataFrame, kind: str) -> pd.DataFrame:
    """Return the worlds of a kind in which what is hidden can be found."""
    good = rows["possible"] & ~rows["verdict"].isin([NOT_PLANTED, FAILED])
    return rows[(rows["kind"] == kind) & good]


def interval(count: int, total: int, level: float = 0.95) -> tuple[float, float]:
    """Return the Clopper-Pearson interval of a share."""
    tail = (1.0 - level) / 2.0
    low = stats.beta.ppf(tail, count, total - count + 1) if count else 0.0
    high = stats.beta.isf(tail, count + 1, total - count) if count < total else 1.0
    return float(low), float(high)


def share(values: Iterable[object], *, with_interval: bool = False) -> str:
    """Return a share in percent with its numbers, and its 95 % interval if wanted."""
    flags = np.array(list(values), dtype=bool)
    if not flags.size:
        return ""
    count, total = int(flags.sum()), int(flags.size)
    text = f"{count / total:.0%} ({count}/{total})"
    if with_interval:
        low, high = interval(count, total)
        text += f" [{low:.0%}, {high:.0%}]"
    return text


def percent(values: Iterable[object]) -> str:
    """Return a bare share in percent."""
    flags = np.array(list(values), dtype=bool)
    return f"{flags.mean():.0%}" if flags.size else ""


def powers(rows: pd.DataFrame, name: str, protocol: str) -> pd.DataFrame:
    """Return how often an effect is found, by size: columns ``count`` and ``total``."""
    part = asked(rows, "single")
    part = part[(part["hidden"] == name) & (part["protocol"] == protocol)]
    return part.groupby("size")["found"].agg(count="sum", total="size")


def power_size(rows: pd.DataFrame, name: str, protocol: str) -> float | None:
    """Return the smallest studied size from which on the effect is found four times in five.

    Infinite where no studied size is, None where no joint was studied.
    """
    power = powers(rows, name, protocol)
    if power.empty:
        return None
    reached = (power["count"] / power["total"] >= POWER).to_numpy()
    from_here = np.logical_and.accumulate(reached[::-1])[::-1]
    return float(power.index[from_here][0]) if from_here.any() else float("inf")


def claimed_size(rows: pd.DataFrame, name: str, protocol: str) -> float | None:
    """Return the median size that the diagnosis says it would find, on the clean worlds.

    The program counts the RMS in the runs seen; it is carried to the size that is planted, which
    counts all runs, or the angles after a reversal alone. [N·m]
    """
    clean = rows[(rows["kind"] == "clean") & (rows["noise"] == "default")]
    clean = clean[(clean["protocol"] == protocol) & (clean["detectable"] != "")]
    claims = [json.loads(text).get(name) for text in clean["detectable"]]
    claims = [claim for claim in claims if claim is not None]
    single = asked(rows, "single")
    single = single[(single["hidden"] == name) & (single["protocol"] == protocol)]
    if not claims or single.empty:
        return None
    return float(np.median(claims) * (single["size"] / single["raw"]).median())
