"""The tables of the study of wear, written into docs/compare.md."""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from tests.studies.wear_world import HIGHEST, LOWEST, SURROUNDINGS

PAGE = Path(__file__).parents[2] / "docs" / "compare.md"
_BEGIN, _END = "<!-- measured -->\n", "<!-- /measured -->"

_WORDS = {
    "unchanged": "unchanged",
    "wear": "all friction grows steadily",
    "dry wear": "dry friction only, steadily",
    "viscous wear": "viscous friction only, steadily",
    "sudden": "all friction at once, after half of the runs",
    "season": "unchanged, each day warmer than the last",
    "payload": "payload doubled after half of the runs",
    "sensor": "all torques logged ever higher",
}
_TRUE_CAUSE = {
    "wear": "drift",
    "dry wear": "drift",
    "viscous wear": "drift",
    "sudden": "step_change",
    "payload": "payload_change",
    "sensor": "torque_constant",
}
_JOINTS = {"zones": "three zones", "plain": "equation (16)"}
_GROUP = ["life_kind", "life_joint_kind", "life_runs", "life_change", "life_even"]


def wilson(count: int, total: int) -> tuple[float, float]:
    """Return the 95 % Wilson interval of a share."""
    found = stats.binomtest(count, total).proportion_ci(method="wilson")
    return float(found.low), float(found.high)


def share(values: pd.Series) -> str:
    """Return a share with its numbers and its interval."""
    count, total = int(values.sum()), len(values)
    low, high = wilson(count, total)
    return f"{count} of {total} ({100 * low:.0f} to {100 * high:.0f} %)"


def found(rows: pd.DataFrame) -> str:
    """Return in how many of the joints a change was found."""
    return share(rows["verdict"] == "changed")


def measured(rows: pd.DataFrame) -> str:
    """Return the measured part of the page."""
    unchanged = rows[rows["life_kind"].isin(["unchanged", "season"])]
    steady = rows[(rows["life_kind"].str.endswith("wear")) & (rows["life_runs"] == 10)]
    lines = [
        f"Days differ by surroundings of {SURROUNDINGS[0]:.0f} to {SURROUNDINGS[1]:.0f} °C, drawn"
        f" anew, by their drift, and a little by where heat enters. Each has a sweep of four speeds"
        f" from cold and a cycle from {LOWEST} to {HIGHEST} °C and back. `--fail-above 3%`.",
        "",
        "| what happens | joint | runs | change | found | status 3 | undetermined | change said |",
        "|---|---|---|---|---|---|---|---|",
        *_lines(rows, ""),
        "",
        f"All unchanged joints together: a change found in {found(unchanged)}, status 3 in"
        f" {share(unchanged['exceeded'].astype(bool))}. Steady wear of 5 % over ten runs, all four"
        f" lines: found in {found(steady)}.",
        "",
        *_held(rows),
        "",
        "First and last run of the same joints alone, which is what two work folders months apart"
        " are:",
        "",
        "| what happens | joint | change | found | undetermined | change said | half interval |",
        "|---|---|---|---|---|---|---|",
        *_ends(rows),
        "",
        "Causes of the changes found, over ten runs:",
        "",
        "| what happens | hidden | named alone | in the set | other |",
        "|---|---|---|---|---|",
        *_causes(rows),
    ]
    return "\n".join(lines) + "\n"


def _lines(rows: pd.DataFrame, prefix: str) -> list[str]:
    lines = []
    for key, own in _groups(rows):
        kind, joint, runs, change, even = key
        place = ", equal surroundings" if even else ""
        lines.append(
            f"| {_WORDS[kind]}{place} | {_JOINTS[joint]} | {runs} | {_percent(change)} |"
            f" {found(own)} | {int(own['exceeded'].astype(bool).sum())} |"
            f" {int((own['verdict'] == 'undetermined').sum())} | {_said(own['change'])} |"
        )
    return lines


def _ends(rows: pd.DataFrame) -> list[str]:
    lines = []
    for key, own in _groups(rows[rows["life_runs"] == 10]):
        kind, joint, _, change, _ = key
        half = (own["ends_high"] - own["ends_low"]) / 2
        lines.append(
            f"| {_WORDS[kind]} | {_JOINTS[joint]} | {_percent(change)} |"
            f" {share(own['ends_verdict'] == 'changed')} |"
            f" {int((own['ends_verdict'] == 'undetermined').sum())} |"
            f" {_said(own['ends_change'])} | {half.median():.0f} % |"
        )
    return lines


def _causes(rows: pd.DataFrame) -> list[str]:
    lines = []
    worn = rows[(rows["life_runs"] == 10) & rows["life_kind"].isin(_TRUE_CAUSE)]
    worn = worn[worn["verdict"] == "changed"]
    for (kind, joint), own in worn.groupby(["life_kind", "life_joint_kind"], sort=False):
        truth = _TRUE_CAUSE[str(kind)]
        sets = [[one.split("|") for one in text.split(";")] for text in own["causes"].fillna("")]
        alone = sum([truth] in found_sets for found_sets in sets)
        held = sum(any(truth in one for one in found_sets) for found_sets in sets)
        lines.append(
            f"| {_WORDS[str(kind)]}, {_JOINTS[str(joint)]} | `{truth}` | {alone} of {len(own)} |"
            f" {held} of {len(own)} | {len(own) - held} |"
        )
    return lines


def _held(rows: pd.DataFrame) -> list[str]:
    """Return how often the intervals of the change hold the truth, where that is one number."""
    plain = rows[rows["life_kind"].isin(["unchanged", "season", "wear"])]
    # the change is told against the mean of all runs
    truth = 100 * plain["life_change"] / (1 + plain["life_change"] / 2)
    holds = (plain["low"] <= truth) & (truth <= plain["high"])
    ends = plain[plain["life_runs"] == 10]
    true_ends = truth[ends.index]
    both = (ends["ends_low"] <= true_ends) & (true_ends <= ends["ends_high"])
    return [
        f"The 95 % interval of the change holds the truth in {share(holds)} of the joints above"
        f" where nothing happens or all friction grows, and with the first and the last of ten"
        f" runs alone in {share(both)}."
    ]


def _groups(rows: pd.DataFrame) -> list[tuple[tuple, pd.DataFrame]]:
    return list(rows.groupby(_GROUP, sort=False))


def _percent(change: float) -> str:
    return "–" if change == 0 else f"{100 * change:.0f} %"


def _said(values: pd.Series) -> str:
    low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
    return f"{middle:+.1f} ({low:+.1f} to {high:+.1f}) %"


def write_page(rows: pd.DataFrame) -> None:
    """Put the tables into the page."""
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(_BEGIN)
    after = rest.split(_END)[1]
    PAGE.write_text(before + _BEGIN + measured(rows) + _END + after, encoding="utf-8")
