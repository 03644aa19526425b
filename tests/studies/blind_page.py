"""The page docs/blind.md of the blind study."""

import textwrap
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tests.studies.blind_before import before_table
from tests.studies.blind_gates import gate_table, verdict
from tests.studies.blind_page_tables import (
    alarm_table,
    chain_table,
    change_table,
    effect_table,
    hopeless_text,
    network_table,
    pair_table,
    size_table,
    unlisted_table,
    wrong_table,
)
from tests.studies.blind_page_values import bounds_text, interval_table, power_table
from tests.studies.blind_rows import Joint
from tests.studies.blind_worlds import CHANGE_SIZE, KINDS, plan

TEXT = Path(__file__).with_name("blind.txt")

KIND_TEXT = {
    "clean": "nothing hidden",
    "single": "one effect of the catalogue",
    "pair": "a thermal lag and another effect",
    "unlisted": "an effect that the catalogue does not list",
    "change": "a change that comes, goes or recurs",
    "network": "friction of a temperature that no sensor measures",
    "ordinary": "one ordinary thing and nothing else",
    "zones": "the sample joint with another effect",
    "moved_heat": "friction of such a temperature and an entry of heat that moves",
}


def page(joints: Sequence[Joint], stale: int) -> str:
    """Return the page: the text with the tables in their places.

    Parameters
    ----------
    joints : sequence of Joint
        The joints.
    stale : int
        How many of them were diagnosed by other sources than the present ones.
    """
    counts = Counter(one.world.kind for one in joints)
    return TEXT.read_text(encoding="utf-8").format(
        verdict=verdict(joints),
        worlds=len(joints),
        counts=textwrap.fill(
            ", ".join(f"{counts[kind]} with {KIND_TEXT[kind]}" for kind in KINDS if counts[kind]),
            100,
        ),
        logs=sum(one.world.path == "logs" for one in joints),
        planned=len(plan()),
        stale=_stale(stale),
        nuisance=_nuisance(joints),
        reachable=_reachable(joints),
        gates=gate_table(joints),
        bounds=bounds_text(joints),
        before=before_table(joints),
        alarms=alarm_table(joints),
        wrong=wrong_table(joints),
        effects=effect_table(joints),
        sizes=size_table(joints),
        hopeless=hopeless_text(joints),
        pairs=pair_table(joints),
        unlisted=unlisted_table(joints),
        change_size=CHANGE_SIZE,
        changes=change_table(joints),
        networks=network_table(joints),
        chain=chain_table(joints),
        intervals=interval_table(joints),
        power=power_table(joints),
    )


def _stale(count: int) -> str:
    if not count:
        return ""
    return (
        f"**Older rows.** {count} of the joints were diagnosed before the last changes of the"
        " program; what the present one says of them may differ.\n\n"
    )


def _nuisance(joints: Sequence[Joint]) -> str:
    left = [one.numbers["nuisance"] for one in joints if one.world.kind == "clean"]
    left = [value for value in left if np.isfinite(value)]
    if not left:
        return "an unknown"
    return f"{np.median(left):.2f} ({min(left):.2f} to {max(left):.2f})"


def _reachable(joints: Sequence[Joint]) -> str:
    """Return by how much a model that lacks nothing hidden misses the day kept out, over noise."""
    of = [one.numbers for one in joints if one.world.kind in ("clean", "single", "pair")]
    ratios = [one["reachable"] / one["floor"] for one in of if np.isfinite(one["reachable"])]
    if not ratios:
        return "an unknown multiple of"
    low, high = np.quantile(ratios, (0.1, 0.9))
    return f"{np.median(ratios):.2f} times (eight of ten between {low:.2f} and {high:.2f})"
