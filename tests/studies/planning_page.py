"""The tables of docs/planning.md, between its two marks."""

import math

import pandas as pd
from scipy import stats

from tests.studies.planning_examined import CHECK, WAYS
from tests.studies.planning_worlds import BUDGETS, HIDDEN

BEGIN, END = "<!-- study -->", "<!-- /study -->"
_NAMES = {
    "plan": "the plan",
    "repeat": "the thin experiment again",
    "blocks": "blocks at random",
    "motions": "motions at random",
}


def wilson(count: int, total: int, z: float = 1.96) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a share (J. Am. Stat. Assoc. 22, 1927)."""
    if not total:
        return 0.0, 1.0
    share, square = count / total, z * z / total
    middle = (share + square / 2) / (1 + square)
    half = z / (1 + square) * math.sqrt(share * (1 - share) / total + square / (4 * total))
    return max(middle - half, 0.0), min(middle + half, 1.0)


def told(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the ambiguous worlds whose set holds the truth, with what became of them.

    Added for each way: ``right`` (the hidden effect stands alone in a set, and the old question is
    gone), ``only`` (and nothing else is named) and ``wrong`` (a set of one name is not hidden).
    """
    open_ = rows[(rows["verdict"] == "ambiguous") & (rows["truth_held"] == "1")].copy()
    for way in WAYS:
        sets = [[one.split("|") for one in text.split(";") if one] for text in open_[f"{way}_sets"]]
        both = list(zip(sets, open_["hidden"], strict=True))
        open_[f"{way}_right"] = [[truth] in found for found, truth in both]
        open_[f"{way}_only"] = [found == [[truth]] for found, truth in both]
        open_[f"{way}_wrong"] = [
            any(len(one) == 1 and one != [truth] for one in found) for found, truth in both
        ]
        open_[f"{way}_lost"] = [not any(truth in one for one in found) for found, truth in both]
    open_["promised"] = [
        min((float(one) for one in text.split(";") if one), default=0.0)
        for text in open_["expected"]
    ]
    return open_


def share(values: pd.Series) -> str:
    """Return a share in per cent with its numbers and interval."""
    count, total = int(values.sum()), len(values)
    if not total:
        return "-"
    low, high = wilson(count, total)
    return f"{count / total:.0%} ({count}/{total}) [{low:.0%}, {high:.0%}]"


def page(rows: pd.DataFrame, digest: str, document: str) -> str:
    """Return the document with its tables made anew."""
    before, _, rest = document.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{tables(rows, digest)}\n{END}{after}"


def _against(found: pd.DataFrame, way: str) -> str:
    """Return on how many joints only the plan was right, and on how many only another way."""
    plan, other = found["plan_right"], found[f"{way}_right"]
    ours, theirs = int((plan & ~other).sum()), int((other & ~plan).sum())
    chance = stats.binomtest(ours, ours + theirs).pvalue if ours + theirs else 1.0
    return (
        f"Only the plan was right in {ours} joints, only {_NAMES[way]} in {theirs}: a difference"
        f" that chance alone makes with probability {chance:.2g} (sign test)."
    )


def _shown(sets: str) -> str:
    """Return sets of causes for people: names of a set with "or", sets with "and"."""
    return sets.replace("|", " or ").replace(";", "; and ") or "none"


def tables(rows: pd.DataFrame, digest: str) -> str:
    """Return the tables."""
    found = told(rows)
    first = rows[rows["minutes"] == str(BUDGETS[0])]
    asked = len(first[~first["verdict"].isin(["not hidden", "failed"])])
    failed = int((rows["verdict"] == "failed").sum())
    stale = int((rows["sources"] != digest).sum())
    ambiguous = int((first["verdict"] == "ambiguous").sum())
    held = int((found["minutes"] == str(BUDGETS[0])).sum())
    lines = [
        f"{asked} thin experiments were diagnosed; {ambiguous} were ambiguous, and in {held} of",
        f"these the set held what is hidden. {failed} more broke down. {CHECK:.0%} of the time is",
        "for the check. Square brackets are Wilson's 95 % intervals.",
        "",
    ]
    if stale:
        lines += [f"{stale} rows were made before the last changes of the program's sources.", ""]
    for minutes in BUDGETS:
        part = found[found["minutes"] == str(minutes)]
        if len(part):
            lines += _budget(part, minutes)
    return "\n".join([*lines, *_by_effect(found), *_unsettled(found)])


def _budget(found: pd.DataFrame, minutes: float) -> list[str]:
    """Return what became of the joints within one budget."""
    return [
        f"**{minutes:.0f} minutes**, {len(found)} joints:",
        "",
        "| | right name alone | and no other cause | truth in no set | another name alone |",
        "|---|---|---|---|---|",
        *(
            f"| {_NAMES[way]} | {share(found[f'{way}_right'])} | {share(found[f'{way}_only'])}"
            f" | {share(found[f'{way}_lost'])} | {share(found[f'{way}_wrong'])} |"
            for way in WAYS
        ),
        "",
        f"The plans promised the right name alone in {float(found['promised'].mean()):.0%} of the"
        " cases, in the mean.",
        *(_against(found, way) for way in WAYS[1:]),
        "",
    ]


def _by_effect(found: pd.DataFrame) -> list[str]:
    """Return how often each way ends with the right name alone, effect by effect."""
    heads = [f"{_NAMES[way]}, {minutes:.0f} min" for minutes in BUDGETS for way in WAYS]
    lines = [
        f"| hidden | {' | '.join(heads)} |",
        "|---|" + "---|" * len(heads),
    ]
    for hidden in HIDDEN:
        cells = []
        for minutes in BUDGETS:
            part = found[(found["hidden"] == hidden) & (found["minutes"] == str(minutes))]
            cells += [f"{int(part[f'{way}_right'].sum())}/{len(part)}" for way in WAYS]
        lines.append(f"| {hidden} | {' | '.join(cells)} |")
    return [*lines, ""]


def _unsettled(found: pd.DataFrame) -> list[str]:
    """Return what the plan made of the joints that it did not settle."""
    lines = [
        "Not settled by the plan:",
        "",
        "| hidden | design | min | set before | promised | the plan | again | blocks | motions |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    missed = found[~found["plan_right"]].sort_values(["minutes", "hidden", "design", "seed"])
    for _, row in missed.iterrows():
        cells = ["**right**" if row[f"{way}_right"] else _shown(row[f"{way}_sets"]) for way in WAYS]
        lines.append(
            f"| {row['hidden']} | {row['design']} | {float(row['minutes']):.0f} |"
            f" {_shown(row['sets'])} | {row['promised']:.0%} | {' | '.join(cells)} |"
        )
    return lines
