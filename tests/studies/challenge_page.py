"""The results of ``tests.studies.challenge`` in docs/challenge.md: gates, wrong names, tables."""

from collections.abc import Sequence
from pathlib import Path

from scipy.stats import beta

from frictioncli import tables
from frictioncli.challenge_schema import AS_LOGGED, CHALLENGE, DONE, SEARCH, SHARE, Row
from frictioncli.report.challenge_words import (
    can_show,
    claim_ratios,
    found_text,
    mark,
    rows_of_table,
)
from frictioncli.wording import count_text, number_text
from frictioncli.workfiles import CHALLENGE as FILE

PAGE = Path(__file__).parents[2] / "docs" / "challenge.md"
BEGIN, END = "<!-- results -->\n", "<!-- /results -->\n"

CLOSE = 1.5
"""Factor within which a claimed size shall be of the one found."""

FOUND, WRONG, CLAIMED = 0.8, 0.05, 0.8
"""What must be reached of effects found, what wrong names must not exceed, and what must be reached
of claims."""


def write_page(work: Path) -> None:
    """Write the results of all cases whose tables are in a folder."""
    cases = {
        path.parent.name: rows_of_table(tables.read(path, CHALLENGE))
        for path in sorted(work.glob(f"*/{FILE}"))
    }
    text = "\n".join([gates(cases), wrong_names(cases), *map(section, cases, cases.values())])
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}{text}{END}{rest.split(END)[1]}", encoding="utf-8")


def gates(cases: dict[str, list[Row]]) -> str:
    """Return the table of gates over all cases."""
    rows = [row for own in cases.values() for row in own]
    done = [row for row in rows if row["status"] == DONE and row["purpose"] != AS_LOGGED]
    usual = [row for row in done if row["purpose"] == SHARE and not row["already"]]
    shown = [row for row in usual if can_show(row)]
    beyond = [row for row in usual if not can_show(row)]
    ratios = [one for own in cases.values() for one in claim_ratios(own).values()]
    lines = [
        "## Gates\n",
        "Shares with their counts and 95 % Clopper-Pearson intervals.\n",
        "| figure | must reach | is | |",
        "|---|---|---|---|",
        _gate(
            "planted at 10 % of the mean friction, where the diagnosis calls that detectable: right"
            " name in a set",
            FOUND,
            [bool(row["right_in_set"]) for row in shown],
        ),
        _gate(
            "trials with a wrong name that was not there before",
            WRONG,
            [bool(row["wrong"]) for row in done],
            most=True,
        ),
        _gate(
            f"claimed detectable size within a factor of {CLOSE} of the size at which four of five"
            " shapes were found",
            CLAIMED,
            [1 / CLOSE <= one <= CLOSE for one in ratios],
        ),
        "",
        f"In {count_text(len(beyond), 'further trial')} the diagnosis says that the usual size is"
        " too small for these data; the effect was found in"
        f" {sum(bool(row['right_in_set']) for row in beyond)} of them.\n",
    ]
    return "\n".join(lines)


def _gate(what: str, limit: float, values: Sequence[bool], *, most: bool = False) -> str:
    sign = "<=" if most else ">="
    if not values:
        return f"| {what} | {sign} {limit:.0%} | not tried | **missed** |"
    count, total = sum(values), len(values)
    low = float(beta.ppf(0.025, count, total - count + 1)) if count else 0.0
    high = float(beta.ppf(0.975, count + 1, total - count)) if count < total else 1.0
    share = count / total
    reached = share <= limit if most else share >= limit
    told = f"{share:.0%} ({count}/{total}) [{low:.0%}, {high:.0%}]"
    return f"| {what} | {sign} {limit:.0%} | {told} | {'reached' if reached else '**missed**'} |"


def wrong_names(cases: dict[str, list[Row]]) -> str:
    """Return every trial with a wrong name."""
    lines = ["## Wrong names\n", "| log | planted | size | named wrongly | all names |"]
    lines.append("|---|---|---|---|---|")
    wrong = [(case, row) for case, own in cases.items() for row in own if row["wrong"]]
    for case, row in wrong:
        lines.append(
            f"| {case} | {row['effect']} | {number_text(row['size'])} {row['unit']}"
            f" ({row['share']:.0%}) | {row['wrong']} | {row['names']} |"
        )
    return "\n".join([*lines, ""]) if wrong else "## Wrong names\n\nNone.\n"


def section(case: str, rows: Sequence[Row]) -> str:
    """Return the table of one log."""
    lines = [f"## {case}\n"]
    for logged in (row for row in rows if row["purpose"] == AS_LOGGED):
        own = [row for row in rows if row["joint"] == logged["joint"]]
        names = logged["names"] or logged["structure"] or "nothing"
        lines.append(f"Joint {logged['joint']} as logged: {logged['verdict']}; {names}.\n")
        lines.append("| planted | size | share | claimed | found at | names given | |")
        lines.append("|---|---|---|---|---|---|---|")
        lines += [_line(row) for row in own if row["purpose"] not in (AS_LOGGED, SEARCH)]
        seconds = sum(row["seconds"] or 0.0 for row in own)
        lines.append(f"\n{count_text(len(own) - 1, 'trial')}, {seconds:.0f} s of CPU time.\n")
    return "\n".join(lines)


def _line(row: Row) -> str:
    unit = row["unit"]
    size = row["asked"] if row["size"] is None else row["size"]
    share = "" if row["share"] is None else f"{row['share']:.0%}"
    claimed = "" if row["claimed"] is None else number_text(row["claimed"], 2)
    said = row["names"] or (f"structure along {row['structure']}" if row["structure"] else "")
    return (
        f"| {row['effect']} | {number_text(size)} {unit} | {share} | {claimed}"
        f" | {found_text(row)} | {said} | {mark(row)} |"
    )
