"""Picture of an effect that was planted in a log: chance of its right name against its size."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.report.panel import name_ticks, stacked
from frictioncli.report.style import FAINT, HEATING, MODEL, WIDTH
from frictioncli.wording import in_words

_ALIKE = 1.1
"""Ratio within which sizes count as one, for the share of them that was found."""

_Z95 = 1.959964

_FOUND = "#0072B2"


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundShare:
    """Share of the trials of about one size in which an effect was named rightly.

    Attributes
    ----------
    size : float
        Geometric mean of the sizes. [unit of the effect]
    trials, found : int
        Number of trials, and of those in which it was named, alone or in a set.
    low, high : float
        95 % interval of the probability. [-]
    """

    size: float
    trials: int
    found: int
    low: float
    high: float


def found_shares(rows: pd.DataFrame) -> list[FoundShare]:
    r"""Return the share found by size, with its interval.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.challenge_schema.CHALLENGE` of one effect that were diagnosed.

    Returns
    -------
    list of FoundShare
        By size, smallest first; sizes within a factor of 1.1 of the smallest of them are one.

    Notes
    -----
    Wilson's interval, E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209,
    doi:10.1080/01621459.1927.10502953. One trial tells little: its interval is that wide.
    """
    ordered = rows.sort_values("size")
    groups: list[pd.DataFrame] = []
    while len(ordered):
        alike = ordered["size"] <= _ALIKE * ordered["size"].iloc[0]
        groups.append(ordered[alike])
        ordered = ordered[~alike]
    return [_share(group) for group in groups]


def _share(group: pd.DataFrame) -> FoundShare:
    trials, found = len(group), int(group["right_in_set"].sum())
    share, part = found / trials, _Z95**2 / trials
    middle = (share + part / 2) / (1 + part)
    reach = np.sqrt(share * (1 - share) * part + part**2 / 4) / (1 + part)
    return FoundShare(
        size=float(np.exp(np.log(group["size"]).mean())),
        trials=trials,
        found=found,
        low=max(float(middle - reach), 0.0),
        high=min(float(middle + reach), 1.0),
    )


def challenge_figure(rows: pd.DataFrame) -> Figure:
    """Draw the chance of the right name over the size planted.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.challenge_schema.CHALLENGE` of one effect and joint, one or more
        of them diagnosed.
    """
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    (panel,) = stacked(figure, 1)
    done = rows[rows["status"] == "done"]
    unit = str(rows["unit"].iloc[0])
    _draw_shares(panel, found_shares(done))
    _draw_trials(panel, done)
    _draw_sizes(panel, rows)
    panel.set_xscale("log")
    sizes = [*done["size"], *rows["claimed"].dropna()]
    panel.set_xlim(0.7 * min(sizes), 1.4 * max(sizes))
    _number_ticks(panel)
    panel.set_ylim(-0.12, 1.12)
    name_ticks(panel.yaxis, [0, 0.5, 1], ["0", "50", "100"])
    panel.set_ylabel("right name [%]")
    panel.set_xlabel(f"RMS of the planted effect over all pairs [{unit}]")
    panel.set_title(in_words(str(rows["effect"].iloc[0])))
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _draw_shares(panel: Axes, shares: list[FoundShare]) -> None:
    at = [one.size for one in shares]
    panel.vlines(
        at,
        [one.low for one in shares],
        [one.high for one in shares],
        color=FAINT,
        linewidth=1.2,
        label="95 % interval of the probability",
    )
    several = [one for one in shares if one.trials > 1]
    if several:
        panel.plot(
            [one.size for one in several],
            [one.found / one.trials for one in several],
            "_",
            color=MODEL,
            markersize=12,
            label="share of several trials",
        )


def _draw_trials(panel: Axes, done: pd.DataFrame) -> None:
    wrong = done["wrong"] != ""
    alone, in_set = done["right_alone"], done["right_in_set"]
    for chosen, face, label in (
        (alone, _FOUND, "named"),
        (in_set & ~alone, "white", "named in a set"),
        (~in_set, FAINT, "not named"),
    ):
        if chosen.any():
            panel.plot(
                done["size"][chosen],
                in_set[chosen].astype(float),
                "o",
                color=FAINT if label == "not named" else _FOUND,
                markerfacecolor=face,
                label=label,
            )
    if wrong.any():
        panel.plot(
            done["size"][wrong],
            in_set[wrong].astype(float),
            "x",
            color=HEATING,
            markersize=9,
            label="another name, wrong",
        )


def _draw_sizes(panel: Axes, rows: pd.DataFrame) -> None:
    low, high = rows["size_found_low"].min(), rows["size_found_high"].max()
    if np.isfinite(low) and np.isfinite(high):
        panel.axvspan(low, high, color=_FOUND, alpha=0.15, linewidth=0, label="smallest size found")
    claimed = rows["claimed"].dropna()
    if len(claimed):
        panel.axvline(claimed.iloc[0], color=MODEL, linestyle="--", linewidth=1, label="claimed")


def _number_ticks(panel: Axes) -> None:
    low, high = panel.get_xlim()
    marks = [
        digit * 10.0**power
        for power in range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
        for digit in (1, 2, 5)
    ]
    inside = [mark for mark in marks if low <= mark <= high]
    name_ticks(panel.xaxis, inside, [f"{mark:g}" for mark in inside])
