"""Tables of the blind study that are about numbers: intervals, and sizes that would be found."""

from collections.abc import Sequence

import numpy as np

from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import PUBLISHED
from tests.studies.blind_gates import (
    coefficient_intervals,
    held_by,
    meaningful,
    measurement_intervals,
    size_intervals,
)
from tests.studies.blind_page_tables import median, table
from tests.studies.blind_rows import Joint, of_kind, share
from tests.studies.blind_worlds import LISTED, MEASUREMENT


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
