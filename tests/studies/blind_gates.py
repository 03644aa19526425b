"""The gates of the blind study, with what was measured."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import PUBLISHED
from frictioncli.simulator.settings import PROTOCOLS
from tests.studies.blind_rows import asked, power_size, share
from tests.studies.blind_truth import COUNTERPARTS, LEAVES_BASE
from tests.studies.effect_names import EFFECT_NAMES

ALIKE = ("linear_viscous", "quadratic_drag", "velocity_exponent", "drift", "run_in")
"""Effects that these protocols hardly tell from each other: two families, of speed and of time."""

WORTH = 0.03
"""Where an oracle takes away less than this share, the ratio of gains is noise."""

SMALL = 0.5
"""Size at which detection is judged. [N·m]"""


def gates(rows: pd.DataFrame) -> str:
    """Return the table of the gates."""
    entries: tuple[tuple[str, str, Callable[[pd.DataFrame], str]], ...] = (
        ("false alarms, all noises but drift99", "<= 5%, interval to 8%", _alarms),
        ("the noise with most of them", "<= 5%", _worst_alarms),
        ("false alarms, drift99", "<= 10%", _slow_alarms),
        ("gain where nothing is hidden: median, greatest", "within 0.5%, <= 2%", _clean_gain),
        (
            "truth in a set, one effect, if found",
            ">= 95%",
            lambda part: share(_found(part)["held"]),
        ),
        ("wrong single name, among `named`", "<= 3%", _wrong),
        ("most probable is the truth, separable, at the 80% size", ">= 90%", _first),
        (f"found at {SMALL:g} N·m, all effects", ">= 80% of what shows", _small),
        (f"effects with an 80% size of {SMALL:g} N·m or less", "", _small_effects),
        ("names per set", "<= 2 paper, <= 1.5 enriched", _names),
        (
            "a lag and another effect of 1 N·m: both in a set",
            ">= 90%",
            lambda part: share(asked(part, "pair")["held"]),
        ),
        ("gain on the held-out run / oracle's: median, 5th percentile", ">= 0.9, >= 0.6", _ratio),
        ("the same where the cause was found", "", lambda part: _ratio(part, found=True)),
        ("95% intervals, base parameters", "92 to 98%", _base_coverage),
        ("95% intervals, effects' coefficients", "92 to 98%", _effect_coverage),
        ("bias, effects' coefficients, greatest", "< 10%", _effect_bias),
        ("unlisted: `unnamed`", ">= 80%", _unnamed),
        ("unlisted: wrong single name", "<= 5%", lambda part: share(_unlisted(part)["wrong"])),
    )
    lines = ["| what | gate | paper | enriched |", "|---|---|---|---|"]
    for what, gate, measured in entries:
        cells = [measured(rows[rows["protocol"] == protocol]) for protocol in PROTOCOLS]
        lines.append(f"| {what} | {gate} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _alarms(part: pd.DataFrame) -> str:
    clean = asked(part, "clean")
    return share(clean.loc[clean["noise"] != "drift99", "found"], with_interval=True)


def _worst_alarms(part: pd.DataFrame) -> str:
    clean = asked(part, "clean")
    kinds = clean[clean["noise"] != "drift99"].groupby("noise")["found"]
    if not len(kinds):
        return ""
    worst = str(kinds.mean().idxmax())
    return f"{worst} {share(kinds.get_group(worst), with_interval=True)}"


def _slow_alarms(part: pd.DataFrame) -> str:
    clean = asked(part, "clean")
    return share(clean.loc[clean["noise"] == "drift99", "found"], with_interval=True)


def _clean_gain(part: pd.DataFrame) -> str:
    gain = asked(part, "clean")["gain"]
    if gain.empty:
        return ""
    return f"{gain.median():.1%}, {gain.max():.1%} ({len(gain)})"


def _found(part: pd.DataFrame) -> pd.DataFrame:
    single = asked(part, "single")
    return single[single["found"]]


def _wrong(part: pd.DataFrame) -> str:
    single = asked(part, "single")
    return share(single.loc[single["verdict"] == "named", "wrong"])


def _first(part: pd.DataFrame) -> str:
    single = asked(part, "single")
    flags: list[bool] = []
    for name, protocol in _pairs_of(part):
        size = None if name in ALIKE else power_size(part, name, protocol)
        chosen = (single["hidden"] == name) & (single["size"] == size)
        flags += list(single.loc[chosen, "first"])
    return share(flags)


def _small(part: pd.DataFrame) -> str:
    single = asked(part, "single")
    return share(single.loc[single["size"] == SMALL, "found"])


def _small_effects(part: pd.DataFrame) -> str:
    sizes = [power_size(part, name, protocol) for name, protocol in _pairs_of(part)]
    return share(size <= SMALL for size in sizes if size is not None)


def _pairs_of(part: pd.DataFrame) -> list[tuple[str, str]]:
    return [(name, protocol) for protocol in part["protocol"].unique() for name in EFFECT_NAMES]


def _names(part: pd.DataFrame) -> str:
    names = asked(part, "single")["names"].dropna()
    return f"{names.mean():.2f} ({len(names)})" if len(names) else ""


def _ratio(part: pd.DataFrame, *, found: bool = False) -> str:
    single = asked(part, "single")
    single = single[single["oracle_gain"] >= WORTH]
    if found:
        single = single[single["found"] & single["held"]]
    if single.empty:
        return ""
    ratio = single["gain"] / single["oracle_gain"]
    return f"{ratio.median():.2f}, {ratio.quantile(0.05):.2f} ({len(ratio)})"


def meaningful(part: pd.DataFrame) -> pd.DataFrame:
    """Return the worlds whose base parameters have a truth.

    Those are the clean ones without a finding, and those whose one effect was found alone, if the
    base keeps its meaning beside it.
    """
    clean = asked(part, "clean")
    single = asked(part, "single")
    right = single["alone"] & ~single["sets"].str.contains(";") & single["hidden"].isin(LEAVES_BASE)
    right &= single["verdict"] == "named"
    return pd.concat([clean[~clean["found"]], single[right]])


def _base_coverage(part: pd.DataFrame) -> str:
    rows = meaningful(part)
    return share(
        flag for name in PARAMETERS for flag in holds(rows, name, getattr(PUBLISHED, name))
    )


def holds(rows: pd.DataFrame, name: str, truth: float | pd.Series) -> list[bool]:
    """Return whether the intervals of a number hold its truth, where there are intervals."""
    known = rows[f"{name}_low"].notna()
    inside = (rows[f"{name}_low"] <= truth) & (truth <= rows[f"{name}_high"])
    return list(inside[known])


def coefficients(part: pd.DataFrame) -> pd.DataFrame:
    """Return the worlds whose hidden effect was found, with a coefficient that can be compared."""
    single = asked(part, "single")
    return single[single["coefficient_estimate"].notna()]


def _effect_coverage(part: pd.DataFrame) -> str:
    rows = coefficients(part)
    return share(holds(rows, "coefficient", rows["coefficient_truth"]))


def errors(rows: pd.DataFrame) -> pd.Series:
    """Return the relative errors of the coefficients."""
    return rows["coefficient_estimate"] / rows["coefficient_truth"] - 1.0


def _effect_bias(part: pd.DataFrame) -> str:
    rows = coefficients(part)
    biases = {
        name: float(errors(rows[rows["hidden"] == name]).median())
        for name in COUNTERPARTS
        if (rows["hidden"] == name).any()
    }
    if not biases:
        return ""
    worst = max(biases, key=lambda name: abs(biases[name]))
    return f"{biases[worst]:+.0%} ({worst}; median over {np.sum(rows['hidden'] == worst)})"


def _unlisted(part: pd.DataFrame) -> pd.DataFrame:
    return asked(part, "unlisted")


def _unnamed(part: pd.DataFrame) -> str:
    return share(_unlisted(part)["verdict"] == "unnamed")
