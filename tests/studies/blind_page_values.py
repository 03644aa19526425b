"""Tables of the blind study that are about numbers: intervals, and sizes that would be found."""

import itertools
import textwrap
from collections.abc import Sequence

import numpy as np

from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import PUBLISHED
from tests.studies.blind_gates import (
    coefficient_intervals,
    held_by,
    in_catalogue,
    meaningful,
    measurement_intervals,
    size_intervals,
)
from tests.studies.blind_page_tables import median, table
from tests.studies.blind_rows import Joint, of_kind, share
from tests.studies.blind_worlds import LISTED, MEASUREMENT

_SIZES = (0.0, 1.0, 1.5, 2.0, 3.0, np.inf)
"""What is left of an effect, in margins."""


def interval_table(joints: Sequence[Joint]) -> str:
    """Return the table of 95 % intervals that hold the truth."""
    lines = []
    for name in PARAMETERS:
        truth = getattr(PUBLISHED, name)
        known = [one.parameters[name] for one in meaningful(joints) if one.parameters.get(name)]
        flags = [held_by(one, truth) for one in known]
        error = median((one[0] or np.nan) / truth - 1.0 for one in known)
        lines.append(
            [f"base, {name}", share(flag for flag in flags if flag is not None), f"{error}"]
        )
    lines.append(["effects' coefficients", share(coefficient_intervals(joints)), ""])
    lines.append(["what is left of an effect", share(size_intervals(joints)), ""])
    for name in MEASUREMENT:
        flags = measurement_intervals(joints, (name,))
        lines.append([f"measurement, {name}", share(flags), ""])
    return table(("95 % intervals", "hold the truth", "median relative error"), lines)


def bounds_text(joints: Sequence[Joint]) -> str:
    """Return what limits the gates: size, margin, and what one day tells of the next."""
    return "\n\n".join(filter(None, [_of_size(joints), _of_margin(joints), _of_days(joints)]))


def _of_size(joints: Sequence[Joint]) -> str:
    """Return how often an effect is named, by how much is left of it."""
    lines = []
    for low, high in itertools.pairwise(_SIZES):
        cells = [f"{low:g} to {high:g} margins" if np.isfinite(high) else f"{low:g} or more"]
        for kind in ("single", "pair"):
            flags = [
                any(one["name"] in names for names in joint.sets)
                for joint in of_kind(joints, kind)
                for one in joint.hidden
                if low <= one["left"] / joint.margin < high
            ]
            cells.append(share(flags) if flags else "–")
        lines.append(cells)
    text = _filled(
        "*Size.* A name needs the lower end of the 95 % interval of what is left above the margin,"
        " not the estimate alone. Little more than the margin is therefore often not named, and"
        " most of what the study plants leaves little more. By what is left of an effect, all"
        " planted sizes together, the share of those in a set:"
    )
    return f"{text}\n\n{table(('left', 'one effect', 'each of a lag and another'), lines)}"


def _of_margin(joints: Sequence[Joint]) -> str:
    """Return on how many joints with a lag and another effect both can have a name."""
    pairs = [one for one in of_kind(joints, "pair") if one.possible]
    if not pairs:
        return ""
    both = sum(one.shows for one in pairs)
    return _filled(
        f"*A lag and another effect.* On {len(pairs) - both} of {len(pairs)} joints base model and"
        " measurement effects together leave less than the margin of one of the two. What is below"
        f" the margin gets no name, whatever the program: both can be named on {both} joints"
        f" ({both / len(pairs):.0%}), and on others only where an effect of the measurement was"
        " given up, so that more is left."
    )


def _of_days(joints: Sequence[Joint]) -> str:
    """Return how far the day kept out can be predicted by one who knows the law of friction."""
    known = [one for one in in_catalogue(joints) if one.world.kind != "network"]
    named = [one for one in known if one.held]
    if not named:
        return ""

    def medians(among: Sequence[Joint]) -> str:
        over = {
            "with all that it hands out": [one.over_floor for one in among],
            "with the causes alone": [one.causes_alone / one.numbers["floor"] for one in among],
            "of the oracle": [one.numbers["reachable"] / one.numbers["floor"] for one in among],
        }
        return ", ".join(f"{np.median(ratios):.2f} {whose}" for whose, ratios in over.items())

    terms = sum(not np.isnan(one.numbers["with_term"]) for one in known)
    return _filled(
        "*Day kept out over noise floor.* The extended model has the causes that are named and, on"
        f" {terms} of {len(known)} joints, an empirical term for the smooth error that is left. It"
        " has one where the term reduces the error on blocks of the first day that it was not"
        " estimated from, and on the day kept out. The oracle fits base model and measurement"
        " effects to data from which the hidden effect is taken out. Without networks the medians"
        f" are {medians(known)}; on the {len(named)} joints on which the program has the right"
        f" name, {medians(named)}."
    )


def _filled(text: str) -> str:
    return textwrap.fill(text, 100)


def power_table(joints: Sequence[Joint]) -> str:
    """Return the table of sizes that would be found, with the discrepancy and without."""
    known = [one for one in of_kind(joints, "clean") if one.without_discrepancy]
    if not known:
        return "Not measured."
    lines = []
    for name in LISTED:
        cells = [name]
        for protocol in ("paper", "enriched"):
            part = [one for one in known if one.world.protocol == protocol]
            with_it, without = (
                [size for size in (one.get(name) for one in found) if size]
                for found in (
                    [one.detectable for one in part],
                    [one.without_discrepancy for one in part],
                )
            )
            ratio = np.median(with_it) / np.median(without) if with_it and without else np.nan
            cells += [median(with_it), median(without), median([float(ratio)], ".1f")]
        lines.append(cells)
    titles = [
        f"{protocol}, {what}"
        for protocol in ("paper", "enriched")
        for what in ("with", "without", "ratio")
    ]
    return table(("effect", *titles), lines)
