"""Tables of the page: errors of the evaluated corrections, numbers of pairs."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd

from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.report.evaluation_figure import compared_criterion
from frictioncli.report.labels import CRITERION_WORDS
from frictioncli.report.results import JointResults, by_speed
from frictioncli.report.style import PHASE_WORDS, PHASES
from frictioncli.wording import number_text, speed_text

_NEIGHBOURS = 3
"""Settings shown on each side of the simulated one, along k."""

_SHOWN = ("epsilon", "corrections", "failed")
"""Columns of the evaluation that a cell shows."""

_Row = tuple[tuple[str, ...], pd.DataFrame]
"""Cells that name a setting, and the rows of the evaluation at that setting."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTable:
    """A table as text.

    Attributes
    ----------
    title : str
        Caption.
    header : tuple of str
        Column headings.
    rows : tuple of tuple of str
        Cells.
    texts : int
        Number of leading columns that hold text; the others hold numbers.
    remarks : bool
        Whether the last column holds text too.
    marked : tuple of int
        Indices of the rows that are highlighted.
    groups : tuple of (str, int)
        Headings above the column headings, each with the number of columns that it spans.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    texts: int = 1
    remarks: bool = False
    marked: tuple[int, ...] = ()
    groups: tuple[tuple[str, int], ...] = ()


def epsilon_tables(results: JointResults) -> list[TextTable]:
    """Return tables of the errors (21) per run: around the simulated setting, and by bound.

    Parameters
    ----------
    results : JointResults
        One joint's results; without an evaluation there are no tables.
    """
    bounded = results.evaluation["bound"].notna()
    uncorrected = results.evaluation["criterion"] == "none"
    criterion = compared_criterion(results, bounded=False)
    simulated, bound = _simulated_setting(results), _simulated_bound(results)
    settings = _neighbours(
        results.evaluation[(results.evaluation["criterion"] == criterion) & ~bounded], simulated
    )
    bounds = sorted(float(value) for value in results.evaluation.loc[bounded, "bound"].unique())
    tables = []
    fixed, others = results.evaluation[~bounded], results.evaluation[bounded | uncorrected]
    for run in runs_in_order(fixed):
        own = fixed[fixed["run"] == run]
        model = ", extended model" if results.evaluated_extended else ""
        title = f"{run}{model}: error ε of equation (21) [{results.unit}] (number of corrections)"
        rows: list[_Row] = [
            ((f"k = {k:g}", f"{tmax / 60.0:g}"), own[(own["k"] == k) & (own["tmax"] == tmax)])
            for k, tmax in settings
        ]
        marked = [setting == simulated for setting in settings]
        tables.append(_table(title, ("setting", "tmax [min]"), own, rows, marked))
    for run in runs_in_order(others):
        own = others[others["run"] == run]
        title = f"{run}: the same where the predicted uncertainty of friction decides"
        rows = [((f"{value:g}",), own[own["bound"] == value]) for value in bounds]
        marked = [value == bound for value in bounds]
        if bounds:
            tables.append(_table(title, (f"bound [{results.unit}]",), own, rows, marked))
    return tables


def _table(
    title: str,
    settings: tuple[str, ...],
    own: pd.DataFrame,
    rows: Sequence[_Row],
    marked: Sequence[bool],
) -> TextTable:
    """Return a table of errors by phase and criterion, the first row without correction."""
    found = set(own["criterion"])
    criteria = [c for c in CRITERION_WORDS if c != "none" and c in found]
    without = _cells(own[own["criterion"] == "none"], ["none"])
    blank = [""] * (len(criteria) - 1)
    first = ("no correction", *[""] * (len(settings) - 1), without[0], *blank, without[1], *blank)
    return TextTable(
        title=title,
        groups=(("", len(settings)), *((PHASE_WORDS[phase], len(criteria)) for phase in PHASES)),
        header=(*settings, *(CRITERION_WORDS[c] for c in criteria * 2)),
        rows=(first, *((*setting, *_cells(at_setting, criteria)) for setting, at_setting in rows)),
        marked=tuple(index + 1 for index, mark in enumerate(marked) if mark),
    )


def _cells(rows: pd.DataFrame, criteria: list[str]) -> list[str]:
    columns = (rows[name].tolist() for name in ("phase", "criterion", *_SHOWN))
    # the first row of each phase and criterion counts
    known = {
        (phase, name): values for phase, name, *values in reversed([*zip(*columns, strict=True)])
    }
    return [_cell(*known.get((phase, c), (math.nan,) * 3)) for phase in PHASES for c in criteria]


def _simulated_setting(results: JointResults) -> tuple[float, float] | None:
    if results.schedule.empty:
        return None
    first = results.schedule.iloc[0]
    return (float(first["k"]), float(first["tmax"])) if pd.notna(first["k"]) else None


def _simulated_bound(results: JointResults) -> float | None:
    if results.schedule.empty:
        return None
    first = results.schedule.iloc[0]
    return float(first["bound"]) if pd.notna(first["bound"]) else None


def _neighbours(
    rows: pd.DataFrame, simulated: tuple[float, float] | None
) -> list[tuple[float, float]]:
    """Return the settings next to the simulated one in k and in tmax, or else the first few."""
    known = rows[["k", "tmax"]].dropna().drop_duplicates().sort_values(["k", "tmax"])
    settings = [(float(k), float(tmax)) for k, tmax in zip(known["k"], known["tmax"], strict=True)]
    if simulated not in settings or simulated is None:
        return settings[: 2 * _NEIGHBOURS + 1]
    same_tmax = [setting for setting in settings if setting[1] == simulated[1]]
    same_k = [setting for setting in settings if setting[0] == simulated[0]]
    near = {
        setting
        for line, reach in ((same_tmax, _NEIGHBOURS), (same_k, 1))
        for setting in line[
            max(line.index(simulated) - reach, 0) : line.index(simulated) + reach + 1
        ]
    }
    return sorted(near)


def _cell(epsilon: float, corrections: float, failed: float) -> str:
    if math.isnan(corrections):
        return "–"
    lost = f", {int(failed)} failed" if failed > 0 else ""
    return f"{number_text(float(epsilon))} ({int(corrections)}{lost})"


def pairs_table(results: JointResults) -> TextTable:
    """Return the number of pairs, or of groups by regression, per speed and phase.

    Parameters
    ----------
    results : JointResults
        One joint's results.
    """
    found = sorted({str(phase) for phase in results.pairs["phase"]})
    phases = [phase for phase in (*PHASES, "sweep") if phase in found]
    phases += [phase for phase in found if phase not in phases]
    rows = []
    for speed, own in by_speed(results.pairs):
        counts = [int((own["phase"] == phase).sum()) for phase in phases]
        rows.append((speed_text(speed), *(str(count) for count in counts), str(len(own))))
    return TextTable(
        title=f"{results.row_noun}s per speed and phase".capitalize(),
        header=("speed", *(PHASE_WORDS.get(phase, phase) for phase in phases), "all"),
        rows=tuple(rows),
    )
