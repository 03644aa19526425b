"""Figure 11: the error (21) against the number of corrections, and the error of one setting."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.report.labels import CRITERION_WORDS, plain
from frictioncli.report.results import MOST_RUNS, JointResults
from frictioncli.report.style import (
    FAINT,
    PHASE_COLOURS,
    PHASE_WORDS,
    PHASES,
    legend_above,
    panels,
)

BASELINES = ("none", "equal")
"""Criteria that others are compared with."""

_MOST_GROUPS = 14
_BAR_WIDTH = 0.38
_DASHES = (0, (5, 3))


def error_against_corrections(results: JointResults) -> Figure:
    """Draw Figure 11: epsilon (21) against the number of corrections, heating beside cooling.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    criterion = compared_criterion(results)
    runs = sorted(results.evaluation["run"].unique())[:MOST_RUNS]
    evaluation = results.evaluation[results.evaluation["run"].isin(runs)]
    counts = counts_shown(evaluation[evaluation["criterion"] == criterion])
    figure, axes = panels(len(runs), height=3.4)
    for run, panel in zip(runs, axes, strict=True):
        own = evaluation[evaluation["run"] == run]
        for side, phase in enumerate(PHASES):
            rows = own[own["phase"] == phase]
            _phase_bars(panel, rows, criterion, counts, phase, shift=(side - 0.5) * 0.4)
        panel.plot([], [], "D", color=FAINT, markersize=5, label="equally spaced")
        panel.plot([], [], color=FAINT, linestyle=_DASHES, linewidth=1.3, label="no correction")
        panel.set_xticks(range(len(counts)), [str(count) for count in counts])
        panel.grid(visible=False, axis="x")
        panel.set_title(plain(run))
        panel.set_ylabel(f"error ε [{results.unit}]")
        legend_above(panel)
    # the notes of failures stand on the bars and need room; all panels share the scale
    room = 1.3 if (evaluation["failed"] > 0).any() else 1.08
    axes[0].set_ylim(0.0, room * axes[0].get_ylim()[1])
    axes[-1].set_xlabel(f"number of corrections ({CRITERION_WORDS.get(criterion, criterion)})")
    return figure


def _phase_bars(
    panel: Axes, rows: pd.DataFrame, criterion: str, counts: list[int], phase: str, *, shift: float
) -> None:
    colour = PHASE_COLOURS[phase]
    place = {count: index + shift for index, count in enumerate(counts)}
    bars = error_per_count(rows[rows["criterion"] == criterion])
    bars = bars[bars.index.isin(counts)]
    equal = error_per_count(rows[rows["criterion"] == "equal"])
    equal = equal[equal.index.isin(counts)]
    panel.bar(
        [place[count] for count in bars.index],
        bars["epsilon"],
        width=_BAR_WIDTH,
        color=colour,
        alpha=0.85,
        label=PHASE_WORDS[phase],
    )
    panel.plot(
        [place[count] for count in equal.index],
        equal["epsilon"],
        linestyle="none",
        marker="D",
        markersize=5,
        color=colour,
        markeredgecolor="white",
    )
    tops = pd.concat([bars["epsilon"], equal["epsilon"]]).groupby(level=0).max()
    for count, failed in zip(bars.index, bars["failed"], strict=True):
        if failed > 0:
            panel.annotate(
                f"{int(failed)} failed",
                (place[count], tops[count]),
                xytext=(0, 6),
                textcoords="offset points",
                rotation=90,
                ha="center",
                va="bottom",
                fontsize=9,
                color=colour,
            )
    none = rows.loc[rows["criterion"] == "none", "epsilon"]
    if len(none):
        panel.axhline(float(none.iloc[0]), color=colour, linestyle=_DASHES, linewidth=1.3)


def error_per_count(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the mean error and the most failures over the settings of each correction count.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.EVALUATION` of one run, phase and criterion.
    """
    return rows.groupby("corrections").agg(epsilon=("epsilon", "mean"), failed=("failed", "max"))


def counts_shown(rows: pd.DataFrame) -> list[int]:
    """Return the numbers of corrections that Figure 11 shows, at most fourteen.

    Those that most runs and phases have come first, for the sake of comparison, then the lowest.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.EVALUATION` of one criterion.
    """
    phases = rows[["run", "phase", "corrections"]].drop_duplicates()
    shared = phases.groupby("corrections").size().sort_values(ascending=False, kind="stable")
    return sorted(int(count) for count in shared.index[:_MOST_GROUPS])


def compared_criterion(results: JointResults) -> str:
    """Return the criterion that Figure 11 draws: the simulated one where it was evaluated.

    Parameters
    ----------
    results : JointResults
        One joint's results.

    Returns
    -------
    str
        Name of the criterion, empty where the evaluation has none but the two baselines.
    """
    evaluated = {str(c) for c in results.evaluation["criterion"].unique()} - set(BASELINES)
    simulated = [] if results.schedule.empty else [str(results.schedule["criterion"].iloc[0])]
    for criterion in (*simulated, *CRITERION_WORDS):
        if criterion in evaluated:
            return criterion
    return ""


def setting_text(results: JointResults) -> str:
    """Return the simulated setting in words."""
    first = results.schedule.iloc[0]
    word = CRITERION_WORDS.get(str(first["criterion"]), str(first["criterion"]))
    told = [f"criterion “{word}”"]
    if pd.notna(first["k"]):
        told.append(f"k = {first['k']:g}")
    if pd.notna(first["tmax"]):
        told.append(f"tmax = {first['tmax'] / 60.0:g} min")
    return ", ".join(told)
