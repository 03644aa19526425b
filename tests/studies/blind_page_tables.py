"""Tables of the blind study: what was said of each kind of joint."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from itertools import product

import numpy as np

from frictioncli.simulator.settings import NOISE_KINDS, PROTOCOLS
from tests.studies.blind_before import answers
from tests.studies.blind_examined import FAILED, NOT_PLANTED
from tests.studies.blind_gates import GATES
from tests.studies.blind_judged import located, said_as_such, unnamed_and_located
from tests.studies.blind_rows import Joint, of_kind, percent, share, text_of
from tests.studies.blind_worlds import CHANGES, HISTORIES, LAG, LISTED, UNLISTED


def table(titles: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    head = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    return "\n".join([*head, *("| " + " | ".join(cells) + " |" for cells in lines)])


def median(values: Iterable[float], form: str = ".2f") -> str:
    """Return the median of what is known; a dash without any."""
    known = [value for value in values if np.isfinite(value)]
    return f"{np.median(known):{form}}" if known else "–"


def alarm_table(joints: Sequence[Joint]) -> str:
    """Return the table of wrong names where nothing is hidden."""
    clean = of_kind(joints, "clean")
    lines = []
    for noise in NOISE_KINDS:
        parts = [
            [one for one in clean if (one.world.noise, one.world.protocol) == (noise, protocol)]
            for protocol in PROTOCOLS
        ]
        cells = [share(bool(one.wrong) for one in part) for part in parts]
        unnamed = percent(one.structure is not None for part in parts for one in part)
        lines.append([noise, *cells, unnamed])
    return table(("noise", *PROTOCOLS, "structure without a name"), lines)


def wrong_table(joints: Sequence[Joint]) -> str:
    """Return the table of all joints in which a wrong name was given."""
    said = Counter(
        (one.world.kind, one.world.hidden or "nothing", text_of(one.wrong), text_of(one.sets))
        for one in joints
        if one.judged and one.wrong
    )
    if not said:
        return "None."
    return table(
        ("kind", "hidden", "wrong", "all that was named", "joints"),
        ([*key, str(count)] for key, count in sorted(said.items())),
    )


def effect_table(joints: Sequence[Joint]) -> str:
    """Return the table of single effects of 1 N·m."""
    single = [one for one in of_kind(joints, "single") if one.world.size == 1.0]
    lines = []
    for name in LISTED:
        part = [one for one in single if one.world.hidden == name and one.possible]
        if part:
            shown = [one for one in part if one.shows]
            lines.append(
                [
                    name,
                    str(len(part)),
                    median(one.hidden[0]["left"] for one in part),
                    str(len(shown)),
                    percent(one.held for one in shown),
                    percent(one.alone for one in shown),
                    percent(bool(one.wrong) for one in part),
                    median(one.over_floor for one in part),
                    _other_answers(part),
                ]
            )
    titles = (
        *("hidden", "joints", "left [N·m]", "left the margin", "in a set", "alone", "wrong name"),
        *("day/floor", "other answers"),
    )
    return table(titles, lines)


def _other_answers(part: Sequence[Joint]) -> str:
    rest = [one for one in part if not one.alone or one.wrong]
    return answers(rest) if rest else ""


def size_table(joints: Sequence[Joint]) -> str:
    """Return the table of single effects of other sizes."""
    lines = []
    for size in sorted({one.world.size for one in of_kind(joints, "single")} - {1.0}):
        part = [one for one in of_kind(joints, "single") if one.world.size == size]
        part = [one for one in part if one.possible]
        for what, chosen in (
            ("margin or more left", [one for one in part if one.shows]),
            ("less left", [one for one in part if not one.shows]),
        ):
            lines.append(
                [
                    f"{size:g} N·m, {what}",
                    share(one.held for one in chosen),
                    share(one.alone for one in chosen),
                    share(bool(one.wrong) for one in chosen),
                ]
            )
    return table(("planted", "in a set", "alone", "wrong name"), lines)


def hopeless_text(joints: Sequence[Joint]) -> str:
    """Return what is left out of the tables."""
    reasons: Sequence[tuple[str, Callable[[Joint], bool]]] = (
        ("nothing of it in the day seen", lambda one: one.judged and not one.possible),
        ("cannot be planted in that size", lambda one: one.verdict == NOT_PLANTED),
        ("the program broke down", lambda one: one.verdict == FAILED),
    )
    parts = []
    for why, applies in reasons:
        found = Counter(one.world.hidden for one in joints if applies(one))
        if found:
            names = ", ".join(f"{name} ({count})" for name, count in sorted(found.items()))
            parts.append(f"{why}: {names}")
    return "Left out, " + "; ".join(parts) + "." if parts else ""


def pair_table(joints: Sequence[Joint]) -> str:
    """Return the table of a lag beside another effect."""
    lines = []
    for name in LISTED:
        part = [one for one in of_kind(joints, "pair") if name in one.names and name != LAG]
        part = [one for one in part if one.possible]
        if part:
            lines.append(
                [
                    name,
                    str(len(part)),
                    " / ".join(median(_left(one, which) for one in part) for which in (LAG, name)),
                    *(percent(_in_set(one, which) for one in part) for which in (LAG, name)),
                    percent(one.held for one in part),
                    percent(bool(one.wrong) for one in part),
                    median(one.over_floor for one in part),
                ]
            )
    titles = (
        *("also hidden", "joints", "left, lag / other [N·m]", "lag in a set", "other in a set"),
        *("both", "wrong name", "day/floor"),
    )
    return table(titles, lines)


def _left(joint: Joint, name: str) -> float:
    return next(one["left"] for one in joint.hidden if one["name"] == name)


def _in_set(joint: Joint, name: str) -> bool:
    return any(name in one for one in joint.sets)


def unlisted_table(joints: Sequence[Joint]) -> str:
    """Return the table of effects that no catalogue lists."""
    lines = []
    for name in UNLISTED:
        part = [one for one in of_kind(joints, "unlisted") if one.world.hidden == name]
        if part:
            lines.append(
                [
                    name,
                    str(len(part)),
                    median(one.hidden[0]["left"] for one in part),
                    percent(one.verdict == "unnamed" for one in part),
                    percent(located(one) for one in part),
                    percent(unnamed_and_located(one) for one in part),
                    percent(bool(one.wrong) for one in part),
                    answers(part),
                ]
            )
    titles = (
        *("hidden", "joints", "left [N·m]", "unnamed", "right axis", "both", "wrong name"),
        "answers",
    )
    return table(titles, lines)


def change_table(joints: Sequence[Joint]) -> str:
    """Return the table of changes."""
    lines = []
    for name in CHANGES:
        for history in HISTORIES:
            part = [
                one
                for one in of_kind(joints, "change")
                if (one.world.hidden, one.world.history) == (name, history)
            ]
            if part:
                lines.append(
                    [
                        f"{name}, {history}",
                        str(len(part)),
                        median(one.hidden[0]["left"] for one in part),
                        percent(one.held for one in part),
                        percent(said_as_such(one) for one in part),
                        percent(bool(one.wrong) for one in part),
                        answers(part),
                    ]
                )
    titles = ("change", "joints", "left [N·m]", "in a set", "said as such", "wrong name", "answers")
    return table(titles, lines)


def network_table(joints: Sequence[Joint]) -> str:
    """Return the table of joints that are thermal networks."""
    lines = []
    for kind, protocol in product(("network", "moved_heat"), PROTOCOLS):
        part = [one for one in of_kind(joints, kind) if one.world.protocol == protocol]
        if part:
            lines.append(
                [
                    "constant" if kind == "network" else "moved",
                    protocol,
                    str(len(part)),
                    percent(_in_set(one, LAG) for one in part),
                    percent(bool(one.wrong) for one in part),
                    median(one.numbers["before"] for one in part),
                    median(one.after for one in part),
                    median(one.over_floor for one in part),
                    answers(part),
                ]
            )
    titles = (
        *("entry of heat", "programme", "joints", "lag in a set", "wrong name"),
        *("day kept out, base [N·m]", "extended [N·m]", "over floor", "answers"),
    )
    return table(titles, lines)


def chain_table(joints: Sequence[Joint]) -> str:
    """Return the gates for torques per bin and for logs."""
    parts = [[one for one in joints if one.world.path == path] for path in ("bins", "logs")]
    lines = [[gate.what, *(gate.text(part) for part in parts)] for gate in GATES]
    return table(("figure", "torques per bin", "logs"), lines)
