"""What was said of ordinary joints before this study judged it, and what is said now."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tests.studies.blind_judged import said_as_such
from tests.studies.blind_rows import Joint, of_kind, percent, text_of
from tests.studies.blind_worlds import LAG, TWELVE

_MOST = 3
"""Number of answers that are listed."""

_BESIDE = (
    *("coulomb_temperature", "position_ripple", "torque_constant", "run_in", "step_change"),
    "reversal_transient",
)
"""Effects beside which the lag was looked for."""

_ALONE = (
    *("stribeck", "velocity_exponent", "linear_viscous", "coulomb_temperature", "drift"),
    "step_change",
)
"""Effects beside which a lag was named that was not there."""


@dataclass(frozen=True)
class Case:
    """One line of the table.

    Attributes
    ----------
    what, before : str
        What was there, and what was said of it.
    chosen : callable
        Returns the joints of the study that have the same.
    now : callable
        Returns in words what is said of them now.
    """

    what: str
    before: str
    chosen: Callable[[Sequence[Joint]], list[Joint]]
    now: Callable[[Sequence[Joint]], str]


def answers(joints: Sequence[Joint]) -> str:
    """Return what is said of joints, most frequent first."""
    said = Counter(_answer(one) for one in joints)
    parts = [f"{text} ({count})" for text, count in said.most_common(_MOST)]
    rest = sum(said.values()) - sum(count for _, count in said.most_common(_MOST))
    return "; ".join(parts + ([f"others ({rest})"] if rest else []))


def _answer(joint: Joint) -> str:
    parts = [f"`{joint.verdict}`"]
    if joint.sets:
        parts.append(text_of(joint.sets))
    if joint.findings:
        parts.append(f"measurement: {text_of(joint.findings)}")
    if joint.structure is not None:
        parts.append(f"structure along {' and '.join(joint.structure['axis'])}")
    return ", ".join(parts)


def _ordinary(name: str) -> Callable[[Sequence[Joint]], list[Joint]]:
    return lambda joints: [one for one in of_kind(joints, "ordinary") if one.world.hidden == name]


def _of_effects(kind: str, *names: str) -> Callable[[Sequence[Joint]], list[Joint]]:
    def chosen(joints: Sequence[Joint]) -> list[Joint]:
        return [
            one
            for one in of_kind(joints, kind)
            if set(one.names) & set(names) and one.world.size == 1.0 and one.possible
        ]

    return chosen


def _changes(history: str) -> Callable[[Sequence[Joint]], list[Joint]]:
    return lambda joints: [one for one in of_kind(joints, "change") if one.world.history == history]


def _with_false_lag(joints: Sequence[Joint]) -> str:
    false = percent(any(LAG in one for one in joint.sets) for joint in joints)
    return f"right name in a set {percent(one.held for one in joints)}; lag as well {false}"


def _with_lag(joints: Sequence[Joint]) -> str:
    lag = percent(any(LAG in one for one in joint.sets) for joint in joints)
    return (
        f"lag named {lag}, both {percent(one.held for one in joints)}; day kept out over floor"
        f" {np.median([one.over_floor for one in joints]):.2f} (median)"
    )


def _floor(joints: Sequence[Joint]) -> str:
    ratios = [one.over_floor for one in joints]
    after = [one.after for one in joints]
    return (
        f"{min(after):.2f} to {max(after):.2f} N·m; over the noise floor {np.median(ratios):.2f}"
        f" (median), {min(ratios):.2f} to {max(ratios):.2f}"
    )


def _as_such(joints: Sequence[Joint]) -> str:
    return f"said as such {percent(said_as_such(one) for one in joints)}: {answers(joints)}"


def _zones(joints: Sequence[Joint]) -> str:
    held = percent(one.held for one in joints)
    rest = sum(any("rest_recovery" in name for name in one.sets) for one in joints)
    return f"true cause in a set {held}, rest_recovery in {rest} of {len(joints)}"


CASES = (
    Case(
        "gravity with a constant part of 2 to 4 N·m that the gear carries",
        "`named`: reversal_transient + dress_pack + position_ripple, p = 1e-118 to 1e-292",
        _ordinary("gravity_constant"),
        answers,
    ),
    Case(
        "torque logged one sample (12 ms) after position",
        "`named`: load_velocity, p = 3e-60",
        _ordinary("torque_delay"),
        answers,
    ),
    Case(
        "torque behind the drive's 40 ms filter",
        "`ambiguous`: quadratic_drag + dress_pack/load_velocity + dress_pack/thermal_lag",
        _ordinary("torque_filter"),
        answers,
    ),
    Case(
        "the three together",
        "load_velocity + position_ripple + unnamed",
        _ordinary("all_three"),
        answers,
    ),
    Case(
        "stribeck, velocity_exponent, linear_viscous, coulomb_temperature, drift or step_change"
        " alone",
        "the right name **and** `thermal_lag`, with heat from friction of -2 to -7 °C",
        _of_effects("single", *_ALONE),
        _with_false_lag,
    ),
    Case(
        "a real lag beside coulomb_temperature, position_ripple, torque_constant, run_in,"
        " step_change, reversal_transient",
        "the lag is not named (6 of 15 with a lag)",
        _of_effects("pair", *_BESIDE),
        _with_lag,
    ),
    Case(
        "the lag beside a ripple (there 1.3 N·m, here 1)",
        "the lag dropped, not even `visible`; 1.00 on the day kept out, floor 0.62",
        _of_effects("pair", "position_ripple"),
        _with_lag,
    ),
    Case(
        "the lag beside Coulomb friction that falls",
        "coulomb_temperature alone, `named`; 1.38 on the day kept out, floor 0.67",
        _of_effects("pair", "coulomb_temperature"),
        _with_lag,
    ),
    Case(
        "payload or friction that steps at noon of every day",
        "**`no_evidence`**, though payload_change stands there with p = 0",
        _changes("recurring"),
        _as_such,
    ),
    Case(
        "12 pairs of a simulated joint",
        '"quadratic_drag or linear_viscous, chance 1" accepted at alpha 0.05',
        _ordinary(TWELVE),
        answers,
    ),
    Case(
        "the default sample joint of `synthesize` with another effect",
        "rest_recovery 99 %, never hidden, in 3 of 6; the true cause demoted",
        lambda joints: of_kind(joints, "zones"),
        _zones,
    ),
    Case(
        "extended model with a lag, on the day kept out",
        "1.0 to 1.4 N·m where the noise floor is 0.62",
        _of_effects("single", LAG),
        _floor,
    ),
)
"""Cases in the order in which they were reported."""


def before_table(joints: Sequence[Joint]) -> str:
    """Return the table of what was said before and what is said now."""
    lines = ["| what was there | what was said before | what is said now |", "|---|---|---|"]
    for case in CASES:
        chosen = case.chosen(joints)
        now = f"{len(chosen)} joints: {case.now(chosen)}" if chosen else "not tried"
        lines.append(f"| {case.what} | {case.before} | {now} |")
    return "\n".join(lines)
