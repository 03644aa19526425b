"""Figure 11: error (21) against the number of corrections; text on the evaluated settings."""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.report.labels import CRITERION_WORDS, figure_text
from frictioncli.report.panel import name_ticks
from frictioncli.report.results import MOST_RUNS, JointResults
from frictioncli.report.style import (
    FAINT,
    MODEL,
    PHASE_COLOURS,
    PHASE_WORDS,
    PHASES,
    legend_above,
    panels,
)
from frictioncli.report.target_error import target_error
from frictioncli.report.tooltips import set_tooltips
from frictioncli.wording import count_text, number_text, range_text

BASELINES = ("none", "equal")
"""Criteria with which the others are compared."""

_MOST_GROUPS = 16
"""Greatest number of groups of bars."""

_BAR_WIDTH = 0.38
_DASHES = (0, (5, 3))
_EQUAL: dict[str, Any] = {
    "linestyle": "none",
    "marker": "D",
    "markersize": 5,
    "markeredgecolor": "white",
}
_OTHER: dict[str, Any] = _EQUAL | {"marker": "^", "markersize": 6, "markeredgecolor": "black"}


def error_figure(results: JointResults) -> Figure:
    """Draw Figure 11: error (21) against the number of corrections, heating beside cooling.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    criterion = compared_criterion(results)
    runs = runs_in_order(results.evaluation)[:MOST_RUNS]
    evaluation = results.evaluation[results.evaluation["run"].isin(runs)]
    criteria = [criterion, *_other_criterion(criterion, evaluation)]
    counts = shown_counts(_drawn_rows(results))
    target = target_error(results)
    figure, axes = panels(len(runs), height=3.4)
    for run, panel in zip(runs, axes, strict=True):
        own = evaluation[evaluation["run"] == run]
        for column, phase in enumerate(PHASES):
            rows = own[own["phase"] == phase]
            _phase_bars(
                panel, rows, criteria, counts, phase, shift=(column - 0.5) * 0.4, unit=results.unit
            )
        panel.plot([], [], label=CRITERION_WORDS["equal"], color=FAINT, **_EQUAL)
        for name in criteria[1:]:
            panel.plot([], [], label=CRITERION_WORDS[name], color=FAINT, **_OTHER)
        panel.plot([], [], color=FAINT, linestyle=_DASHES, linewidth=1.3, label="no correction")
        label = f"{target:.2g} {results.unit}"
        panel.axhline(target, color=MODEL, linewidth=1.0, linestyle=":", label=label)
        name_ticks(panel.xaxis, range(len(counts)), [str(count) for count in counts])
        panel.grid(visible=False, axis="x")
        panel.set_title(figure_text(run))
        panel.set_ylabel(f"error ε [{results.unit}]")
        legend_above(panel)
    # labels of failures above the bars need room; all panels share the scale
    room = 1.3 if (evaluation["failed"] > 0).any() else 1.08
    axes[0].set_ylim(0.0, room * axes[0].get_ylim()[1])
    axes[-1].set_xlabel(f"number of corrections ({CRITERION_WORDS.get(criterion, criterion)})")
    return figure


def _phase_bars(
    panel: Axes,
    rows: pd.DataFrame,
    criteria: list[str],
    counts: list[int],
    phase: str,
    *,
    shift: float,
    unit: str,
) -> None:
    """Draw one phase: the first criterion as bars, the others and equal spacing as markers."""
    colour = PHASE_COLOURS[phase]
    place = {count: index + shift for index, count in enumerate(counts)}
    known = rows[rows["corrections"].isin(counts)]
    # zero corrections have no spacing
    known = known[(known["criterion"] != "equal") | (known["corrections"] > 0)]
    errors = {
        name: error_per_count(known[known["criterion"] == name])
        for name in (criteria[0], "equal", *criteria[1:])
    }
    bars = errors[criteria[0]]
    drawn = panel.bar(
        [place[count] for count in bars.index],
        bars["epsilon"],
        width=_BAR_WIDTH,
        color=colour,
        alpha=0.85,
        label=PHASE_WORDS[phase],
    )
    for bar, text in zip(drawn, _tooltips(bars, phase, unit), strict=True):
        set_tooltips(bar, [text])
    for name in list(errors)[1:]:
        (marks,) = panel.plot(
            [place[count] for count in errors[name].index],
            errors[name]["epsilon"],
            color=colour,
            **(_EQUAL if name == "equal" else _OTHER),
        )
        tooltips = _tooltips(errors[name], phase, unit)
        set_tooltips(marks, [f"{CRITERION_WORDS[name]}, {text}" for text in tooltips])
    tops = pd.concat([each["epsilon"] for each in errors.values()]).groupby(level=0).max()
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


def _tooltips(errors: pd.DataFrame, phase: str, unit: str) -> list[str]:
    return [
        f"{PHASE_WORDS[phase]}, {count_text(int(count), 'correction')}: ε = {number_text(error)}"
        f" {unit}"
        for count, error in errors["epsilon"].items()
    ]


def _other_criterion(criterion: str, evaluation: pd.DataFrame) -> list[str]:
    """Return a second criterion to draw: uncertainty, or one of the paper if that is the first."""
    evaluated = set(evaluation["criterion"])
    others = [name for name in CRITERION_WORDS if name in evaluated and name not in BASELINES]
    if criterion != "uncertainty":
        others = [name for name in others if name == "uncertainty"]
    return [name for name in others if name != criterion][:1]


def error_per_count(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the median error and the greatest number of failures per number of corrections.

    Several settings may give the same number; their median is what the terminal prints too.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.EVALUATION` of one run, phase and criterion.
    """
    return rows.groupby("corrections").agg(epsilon=("epsilon", "median"), failed=("failed", "max"))


def shown_counts(rows: pd.DataFrame) -> list[int]:
    """Return the numbers of corrections shown in Figure 11, at most sixteen.

    Numbers shared by most runs, phases and criteria are preferred, so that these can be compared,
    and among them the lowest.

    Parameters
    ----------
    rows : DataFrame
        Rows of :data:`frictioncli.schemas.EVALUATION` of the criteria that are drawn.
    """
    phases = rows[["run", "phase", "criterion", "corrections"]].drop_duplicates()
    frequency = phases.groupby("corrections").size().sort_values(ascending=False, kind="stable")
    return sorted(int(count) for count in frequency.index[:_MOST_GROUPS])


def counts_left_out(results: JointResults) -> list[int]:
    """Return the numbers of corrections that were evaluated and have no room in Figure 11.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    rows = _drawn_rows(results)
    return sorted({int(count) for count in rows["corrections"]} - set(shown_counts(rows)))


def _drawn_rows(results: JointResults) -> pd.DataFrame:
    """Return the rows of the evaluation whose numbers of corrections Figure 11 shows."""
    criterion = compared_criterion(results)
    runs = runs_in_order(results.evaluation)[:MOST_RUNS]
    evaluation = results.evaluation[results.evaluation["run"].isin(runs)]
    criteria = [criterion, *_other_criterion(criterion, evaluation)]
    return evaluation[evaluation["criterion"].isin(criteria)]


def compared_criterion(results: JointResults, *, bounded: bool = True) -> str:
    """Return the criterion shown in Figure 11: the simulated one if it was evaluated.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    bounded : bool
        Whether it may be the criterion with a bound on uncertainty instead of k and tmax.

    Returns
    -------
    str
        Name of the criterion; empty if only the baselines were evaluated.
    """
    evaluated = {str(c) for c in results.evaluation["criterion"].unique()} - set(BASELINES)
    if not bounded:
        evaluated -= {"uncertainty"}
    simulated = [] if results.schedule.empty else [str(results.schedule["criterion"].iloc[0])]
    for criterion in (*simulated, *CRITERION_WORDS):
        if criterion in evaluated:
            return criterion
    return ""


def setting_text(results: JointResults) -> str:
    """Return the simulated setting as text.

    Parameters
    ----------
    results : JointResults
        One joint's results, with a schedule.
    """
    first = results.schedule.iloc[0]
    word = CRITERION_WORDS.get(str(first["criterion"]), str(first["criterion"]))
    texts = [f"criterion “{word}”"]
    if pd.notna(first["k"]):
        texts.append(f"k = {first['k']:g}")
    if pd.notna(first["tmax"]):
        texts.append(f"tmax = {first['tmax'] / 60.0:g} min")
    if pd.notna(first["bound"]):
        texts.append(f"bound = {first['bound']:g} {results.unit}")
    if results.simulated_extended:
        texts.append("extended model")
    return ", ".join(texts)


def uncertainty_text(results: JointResults) -> str:
    """Return a sentence on corrections by uncertainty; empty if they were not evaluated.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    rows = results.evaluation[results.evaluation["criterion"] == "uncertainty"]
    if rows.empty:
        return ""
    bounds = rows["bound"].unique()
    bound = float(bounds[abs(bounds - target_error(results)).argmin()])
    texts = []
    for phase in PHASES:
        own = rows[(rows["phase"] == phase) & (rows["bound"] == bound)]
        if len(own):
            counts = range_text([str(count) for count in sorted(own["corrections"])])
            errors = range_text([number_text(error) for error in sorted(own["epsilon"])])
            texts.append(f"{PHASE_WORDS[phase]} {counts} corrections, ε {errors} {results.unit}")
    return (
        f"{_marker_name(results)}: corrections made where the predicted uncertainty of friction"
        f" exceeds a bound; with {bound:g} {results.unit}, {'; '.join(texts)}."
    )


def _marker_name(results: JointResults) -> str:
    return "Bars" if compared_criterion(results) == "uncertainty" else "Triangles"
