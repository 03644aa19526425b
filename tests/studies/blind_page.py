"""The page docs/blind.md of the blind study."""

import textwrap
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import PUBLISHED
from frictioncli.simulator.settings import NOISE_KINDS, PROTOCOLS
from tests.studies.blind_examined import FAILED, NOT_PLANTED
from tests.studies.blind_gates import WORTH, coefficients, errors, gates, holds, meaningful
from tests.studies.blind_rows import asked, claimed_size, percent, power_size, share
from tests.studies.blind_truth import COUNTERPARTS, LEAVES_BASE
from tests.studies.blind_worlds import LAG, SIZES, UNLISTED
from tests.studies.effect_names import EFFECT_NAMES

TEXT = Path(__file__).with_name("blind.txt")


CHANGED = (
    "the bounds of coefficients in units of torque, the size of structure that is left without a"
    " name, and the draws of chance in both channels at once"
)
"""What the program does otherwise since the oldest rows that are still shown."""


def page(rows: pd.DataFrame, digest: str) -> str:
    """Return the page: the text with the tables in their places.

    Parameters
    ----------
    rows : DataFrame
        The worlds' rows.
    digest : str
        The present sources': rows of others are said to be older.
    """
    counts = rows["kind"].value_counts()
    return TEXT.read_text(encoding="utf-8").format(
        worlds=len(rows),
        clean=counts.get("clean", 0),
        single=counts.get("single", 0),
        pair=counts.get("pair", 0),
        unlisted=counts.get("unlisted", 0),
        repetitions=_repetitions(rows),
        stale=_stale(rows, digest),
        worth=WORTH,
        gates=gates(rows),
        alarms=_alarms(rows),
        sizes=_sizes(rows),
        effects=_effects(rows),
        hopeless=_hopeless(rows),
        pairs=_pairs(rows),
        off_list=_off_list(rows),
        base=_base(rows),
        leaves=textwrap.fill(", ".join(LEAVES_BASE), 90),
        coefficients=_coefficients(rows),
    )


def _repetitions(rows: pd.DataFrame) -> str:
    per = rows.groupby(["kind", "noise", "protocol", "hidden", "size"]).size()
    least, most = int(per.min()), int(per.max())
    return str(most) if least == most else f"{least} to {most}"


def _stale(rows: pd.DataFrame, digest: str) -> str:
    """Return a paragraph on the rows that other sources made; none where there are none."""
    old = int((rows["sources"] != digest).sum())
    if not old:
        return ""
    text = (
        f"**Older rows.** {old} of the joints were diagnosed before the last changes of the"
        f" program: {CHANGED}. What the present one says of them may differ."
    )
    return textwrap.fill(text, 90) + "\n\n"


def _table(titles: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    head = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    return "\n".join([*head, *("| " + " | ".join(cells) + " |" for cells in lines)])


def _by_protocol(part: pd.DataFrame) -> list[pd.DataFrame]:
    return [part[part["protocol"] == protocol] for protocol in PROTOCOLS]


def _alarms(rows: pd.DataFrame) -> str:
    clean = asked(rows, "clean")
    lines = []
    for noise in NOISE_KINDS:
        parts = _by_protocol(clean[clean["noise"] == noise])
        lines.append([noise, *(share(part["found"], with_interval=True) for part in parts)])
    alarms = clean[clean["found"]]
    names = alarms["sets"].where(alarms["sets"] != "", "no name").str.replace("|", " or ")
    said = ", ".join(f"{name} ({count})" for name, count in names.value_counts().items())
    return _table(("noise", *PROTOCOLS), lines) + (f"\n\nWhat was said: {said}." if said else "")


def _size(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.2g}" if value <= SIZES[-1] else f"> {SIZES[-1]:g}"


def _sizes(rows: pd.DataFrame) -> str:
    lines = []
    for name in EFFECT_NAMES:
        cells = [name]
        for protocol in PROTOCOLS:
            if not (rows["hidden"] == name).any():
                continue
            sizes = (power_size(rows, name, protocol), claimed_size(rows, name, protocol))
            cells += [_size(size) for size in sizes]
        if len(cells) > 1:
            lines.append(cells)
    titles = [f"{protocol}, {what}" for protocol in PROTOCOLS for what in ("found", "claimed")]
    return _table(("hidden", *titles), lines)


def _effects(rows: pd.DataFrame) -> str:
    single = asked(rows, "single")
    lines = []
    for name in EFFECT_NAMES:
        for size in SIZES:
            chosen = (single["hidden"] == name) & (single["size"] == size)
            parts = _by_protocol(single[chosen])
            if any(len(part) for part in parts):
                lines.append([name, f"{size:g}", *_single(parts)])
    titles = (
        "joints",
        "left by the base [N·m]",
        "found",
        "in a set",
        "alone",
        "wrong name",
        "gain",
    )
    return _table(("hidden", "size [N·m]", *titles, "oracle's gain"), lines)


def _single(parts: Sequence[pd.DataFrame]) -> list[str]:
    """Return the cells of one effect and size, both protocols in each."""
    found = [part[part["found"]] for part in parts]
    cells = [
        [str(len(part)) for part in parts],
        [_median(part["visible"], ".2f") for part in parts],
        [percent(part["found"]) for part in parts],
        *([percent(part[name]) for part in found] for name in ("held", "alone", "wrong")),
        [_median(part["gain"], ".0%") for part in parts],
        [_median(part["oracle_gain"], ".0%") for part in parts],
    ]
    return [" / ".join(text or "–" for text in pair) for pair in cells]


def _median(values: pd.Series, form: str) -> str:
    return f"{values.median():{form}}" if values.notna().any() else ""


def _hopeless(rows: pd.DataFrame) -> str:
    """Return the worlds apart in which nothing could be found, or which there are not."""
    lines = []
    kinds = (
        ("nothing of it in the runs seen", ~rows["possible"]),
        ("cannot be planted in that size", rows["verdict"] == NOT_PLANTED),
        ("the program broke down", rows["verdict"] == FAILED),
    )
    taken = pd.Series(False, index=rows.index)
    for why, flags in reversed(kinds):
        part = rows[flags & ~taken]
        taken |= flags
        for name, group in part.groupby("hidden"):
            lines.append([str(name), why, str(len(group)), str(int(group["found"].sum()))])
    if not lines:
        return "None."
    return _table(("hidden", "why", "joints", "any finding"), sorted(lines))


def _pairs(rows: pd.DataFrame) -> str:
    pairs = asked(rows, "pair")
    lines = []
    for name in EFFECT_NAMES:
        parts = _by_protocol(pairs[pairs["hidden"] == f"{LAG}+{name}"])
        if not any(len(part) for part in parts):
            continue
        cells = [
            [str(len(part)) for part in parts],
            [percent(_in_set(part, LAG)) for part in parts],
            [percent(_in_set(part, name)) for part in parts],
            [percent(part["held"]) for part in parts],
            [percent(part["wrong"]) for part in parts],
        ]
        lines.append([name, *(" / ".join(text or "–" for text in pair) for pair in cells)])
    titles = ("also hidden", "joints", "lag in a set", "other in a set", "both", "wrong name")
    return _table(titles, lines)


def _in_set(part: pd.DataFrame, name: str) -> list[bool]:
    return [name in text.replace("|", ";").split(";") for text in part["sets"]]


def _off_list(rows: pd.DataFrame) -> str:
    unlisted = asked(rows, "unlisted")
    lines = []
    for name in UNLISTED:
        for protocol, part in zip(
            PROTOCOLS, _by_protocol(unlisted[unlisted["hidden"] == name]), strict=True
        ):
            if part.empty:
                continue
            shares = [
                percent(part["verdict"] == "unnamed"),
                percent(part["wrong"]),
                percent(part["verdict"] == "no_evidence"),
            ]
            gains = [_median(part[column], ".0%") for column in ("gain", "oracle_gain")]
            taken = part.loc[part["sets"] != "", "sets"].str.replace("|", " or ")
            said = ", ".join(f"{text} ({n})" for text, n in taken.value_counts()[:2].items())
            lines.append([name, protocol, str(len(part)), *shares, *gains, said])
    titles = ("joints", "unnamed", "wrong single name", "nothing", "gain", "oracle's gain")
    return _table(("hidden", "protocol", *titles, "taken for, most often"), lines)


def _base(rows: pd.DataFrame) -> str:
    lines = []
    for kind, what in (("clean", "nothing hidden, nothing found"), ("single", "found alone")):
        for protocol, part in zip(PROTOCOLS, _by_protocol(meaningful(rows)), strict=True):
            chosen = part[part["kind"] == kind]
            if chosen.empty:
                continue
            cells = []
            for name in PARAMETERS:
                truth = getattr(PUBLISHED, name)
                bias = chosen[name].median() / truth - 1.0
                cells.append(f"{percent(holds(chosen, name, truth))}, {bias:+.1%}")
            lines.append([what, protocol, str(len(chosen)), *cells])
    return _table(("joints", "protocol", "number", *PARAMETERS), lines)


def _coefficients(rows: pd.DataFrame) -> str:
    known = coefficients(rows)
    lines = []
    for name, (coefficient, _) in COUNTERPARTS.items():
        for protocol, part in zip(
            PROTOCOLS, _by_protocol(known[known["hidden"] == name]), strict=True
        ):
            if part.empty:
                continue
            error = errors(part)
            lines.append(
                [
                    name,
                    coefficient,
                    protocol,
                    share(holds(part, "coefficient", part["coefficient_truth"])),
                    f"{error.median():+.0%}",
                    f"{error.abs().median():.0%}",
                ]
            )
    titles = ("intervals that hold it", "median error", "median absolute error")
    return _table(("hidden", "coefficient", "protocol", *titles), lines)
