"""The gates of the blind study, with what was measured."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from frictioncli.model.document import PARAMETERS
from frictioncli.model.friction import PUBLISHED
from tests.studies.blind_judged import said_as_such, unnamed_and_located
from tests.studies.blind_rows import Joint, median_interval, of_kind, share
from tests.studies.blind_truth import LATE, delay_and_filter
from tests.studies.blind_worlds import MEASUREMENT

LEAVES_BASE = (
    *("stribeck", "linear_viscous", "load_linear", "thermal_lag", "rest_recovery", "step_change"),
    *("direction_asymmetry", "payload_change", "dress_pack", "position_ripple", "inertia"),
    "reversal_transient",
)
"""Effects beside which the base parameters keep their meaning: others count from a temperature,
a load or a time that the catalogue sets elsewhere, which shifts tau_c, alpha, beta or gamma."""

MISSED = "**missed**"


@dataclass(frozen=True)
class Gate:
    """A figure that must be reached.

    Attributes
    ----------
    what, must : str
        The figure and its bound, in words.
    low, high : float
        Bounds of the figure.
    measured : callable
        Returns flags of joints, of which the share counts; or numbers, of which the median does.
    """

    what: str
    must: str
    measured: Callable[[Sequence[Joint]], Iterable[bool] | Iterable[float]]
    low: float = -np.inf
    high: float = np.inf
    of_median: bool = False

    def figure(self, joints: Sequence[Joint]) -> float:
        """Return the figure; NaN where no joint counts."""
        values = np.array(list(self.measured(joints)), dtype=float)
        if not values.size:
            return float("nan")
        return float(np.median(values) if self.of_median else np.mean(values))

    def text(self, joints: Sequence[Joint]) -> str:
        """Return the figure with its count and 95 % interval."""
        values = list(self.measured(joints))
        if not values:
            return "no joints"
        if not self.of_median:
            return share(values)
        median, low, high = median_interval(values)
        return f"{median:.2f} ({len(values)}) [{low:.2f}, {high:.2f}]"

    def status(self, joints: Sequence[Joint]) -> str:
        """Return whether it is reached."""
        figure = self.figure(joints)
        if np.isnan(figure):
            return "not measured"
        return "reached" if self.low <= figure <= self.high else MISSED


def one_newton_metre(joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints with one effect of 1 N·m of which the base leaves the margin or more."""
    return [one for one in of_kind(joints, "single") if one.world.size == 1.0 and one.shows]


def _any_name(joints: Sequence[Joint]) -> Iterator[bool]:
    return (bool(one.wrong) for one in of_kind(joints, "clean"))


def _pairs(joints: Sequence[Joint], *, showing: bool) -> list[Joint]:
    return [one for one in of_kind(joints, "pair") if (one.shows if showing else one.possible)]


def in_catalogue(joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints whose cause the catalogue has, and shows: their error can be removed."""
    return [one for one in of_kind(joints, "single", "pair", "network") if one.shows]


def meaningful(joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints whose base parameters have a truth.

    Those are the clean ones without a name, and those whose one effect was found alone, if the
    base keeps its meaning beside it.
    """
    clean = [one for one in of_kind(joints, "clean") if not one.sets]
    return clean + [
        one
        for one in of_kind(joints, "single")
        if one.world.hidden in LEAVES_BASE and one.sets == [[one.world.hidden]]
    ]


def held_by(interval: Sequence[float | None], truth: float) -> bool | None:
    """Return whether an interval holds a number; None where there is none."""
    low, high = interval[-2], interval[-1]
    return None if low is None or high is None else low <= truth <= high


def base_intervals(joints: Sequence[Joint]) -> list[bool]:
    """Return whether the intervals of the base's parameters hold what is simulated."""
    found = [
        held_by(joint.parameters.get(name, (None, None, None)), getattr(PUBLISHED, name))
        for joint in meaningful(joints)
        for name in PARAMETERS
    ]
    return [one for one in found if one is not None]


def coefficient_intervals(joints: Sequence[Joint]) -> list[bool]:
    """Return whether intervals of coefficients hold what was planted, where found by name."""
    found = []
    for joint in of_kind(joints, "single", "pair"):
        for one in joint.hidden:
            for cause in joint.causes:
                known = cause.get("parameters", {}).get(one["coefficient"])
                if cause["effects"][0] == one["name"] and known is not None:
                    found.append(held_by(known, one["value"]))
    return [one for one in found if one is not None]


def size_intervals(joints: Sequence[Joint]) -> list[bool]:
    """Return whether intervals of what is left of an effect hold what is left of it.

    Left by the base and by those effects of the measurement that the diagnosis set beside it: what
    it gave up leaves more. Of a change that is said to begin on the day kept out its torque on
    that day counts, by whatever little of it the day seen has.
    """
    found = []
    for joint in of_kind(joints, "single", "pair"):
        for one in joint.hidden:
            for cause in joint.causes:
                begins = cause.get("only_on_new_run", False)
                truth = one["on_new_run"] if begins else one["left_beside"]
                if one["name"] in cause["effects"] and truth > 0:
                    found.append(held_by(cause.get("visible_ci95") or (None, None), truth))
    return [one for one in found if one is not None]


def measurement_intervals(
    joints: Sequence[Joint], names: Sequence[str] = MEASUREMENT
) -> list[bool]:
    """Return whether intervals of what is found of the measurement hold the truth.

    Of a set whose first effect is a property of the joint, as a lag of the gear or of a sensor, the
    parameters are those of that property.
    """
    found = []
    for joint in joints:
        for cause in joint.causes:
            if cause["kind"] != "measurement":
                continue
            stated = cause.get("parameters", {})
            for name in set(cause["effects"]) & set(names):
                truth = joint.nuisances.get(name, {})
                if name in LATE and "time_constant" in stated:
                    # delay and filter are then stated apart, not their moments
                    truth = delay_and_filter(joint.nuisances)
                for parameter, value in truth.items():
                    known = stated.get(parameter)
                    if known is not None:
                        found.append(held_by(known, value))
    return [one for one in found if one is not None]


GATES = (
    Gate("any name on joints with nothing hidden", "<= 5 %", _any_name, high=0.05),
    Gate(
        "one effect of 1 N·m that leaves the margin or more: right name in a set",
        ">= 90 %",
        lambda joints: (one.held for one in one_newton_metre(joints)),
        low=0.90,
    ),
    Gate(
        "the same: alone",
        ">= 80 %",
        lambda joints: (one.alone for one in one_newton_metre(joints)),
        low=0.80,
    ),
    Gate(
        "the same: any wrong name beside it or instead",
        "<= 5 %",
        lambda joints: (bool(one.wrong) for one in one_newton_metre(joints)),
        high=0.05,
    ),
    Gate(
        "lag and another effect of 1 N·m: both in a set",
        ">= 85 %",
        lambda joints: (one.held for one in _pairs(joints, showing=False)),
        low=0.85,
    ),
    Gate(
        "the same, where both leave the margin or more",
        ">= 85 %",
        lambda joints: (one.held for one in _pairs(joints, showing=True)),
        low=0.85,
    ),
    Gate(
        "lag and another effect: any wrong name",
        "<= 5 %",
        lambda joints: (bool(one.wrong) for one in _pairs(joints, showing=False)),
        high=0.05,
    ),
    Gate(
        "unlisted effects: unnamed, located on the right axis",
        ">= 85 %",
        lambda joints: (unnamed_and_located(one) for one in of_kind(joints, "unlisted")),
        low=0.85,
    ),
    Gate(
        "unlisted effects: wrong name",
        "<= 5 %",
        lambda joints: (bool(one.wrong) for one in of_kind(joints, "unlisted")),
        high=0.05,
    ),
    Gate(
        "recurring, vanishing and lasting changes: said as such",
        ">= 90 %",
        lambda joints: (said_as_such(one) for one in of_kind(joints, "change")),
        low=0.90,
    ),
    Gate("95 % intervals, base", "92 to 98 %", base_intervals, low=0.92, high=0.98),
    Gate(
        "95 % intervals, effects' coefficients",
        "92 to 98 %",
        coefficient_intervals,
        low=0.92,
        high=0.98,
    ),
    Gate(
        "95 % intervals, what is left of an effect",
        "92 to 98 %",
        size_intervals,
        low=0.92,
        high=0.98,
    ),
    Gate(
        "95 % intervals, measurement",
        "92 to 98 %",
        measurement_intervals,
        low=0.92,
        high=0.98,
    ),
    Gate(
        "day kept out / noise floor, cause in the catalogue: median",
        "<= 1.25",
        lambda joints: (one.over_floor for one in in_catalogue(joints)),
        high=1.25,
        of_median=True,
    ),
    Gate(
        "the same, joints that are thermal networks with constant coefficients",
        "<= 1.25",
        lambda joints: (one.over_floor for one in of_kind(joints, "network")),
        high=1.25,
        of_median=True,
    ),
    Gate(
        "diagnose, seconds per joint: median",
        "<= 5 s",
        lambda joints: (one.numbers["diagnosed"] for one in joints if one.judged),
        high=5.0,
        of_median=True,
    ),
    Gate(
        "joints on which the program broke down",
        "none",
        lambda joints: (one.verdict == "failed" for one in joints),
        high=0.0,
    ),
)
"""The gates, in the order of the page."""


def gate_table(joints: Sequence[Joint]) -> str:
    """Return the table of the gates."""
    lines = ["| figure | must reach | measured | |", "|---|---|---|---|"]
    lines += [
        f"| {one.what} | {one.must} | {one.text(joints)} | {one.status(joints)} |" for one in GATES
    ]
    return "\n".join(lines)


def verdict(joints: Sequence[Joint]) -> str:
    """Return in words which gates are missed."""
    missed = [one for one in GATES if one.status(joints) == MISSED]
    unmeasured = [one.what for one in GATES if one.status(joints) == "not measured"]
    reached = len(GATES) - len(missed) - len(unmeasured)
    text = f"{reached} of {len(GATES)} gates are reached."
    if missed:
        parts = [f"{one.what}: {one.text(joints)}, must be {one.must}" for one in missed]
        text += " Missed: " + "; ".join(parts) + "."
    if unmeasured:
        text += " Not measured: " + "; ".join(unmeasured) + "."
    return text
