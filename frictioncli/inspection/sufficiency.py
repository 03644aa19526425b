"""Whether logs suffice for each stage, found out with the stages' own code where that is cheap."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.diagnose import LEAST_PAIRS as LEAST_TO_DIAGNOSE
from frictioncli.errors import NotEnoughData
from frictioncli.inspection.pair_check import FORWARD, REVERSE
from frictioncli.model.fitting import LEAST_PAIRS as LEAST_TO_FIT
from frictioncli.model.identifiability import MIN_SPEED_RATIO, MIN_TEMPERATURE_SPAN
from frictioncli.pairs.separation import HalfDifferences, inferred_sign
from frictioncli.pairs.thermal_phases import SWEEP

YES, IN_PART, NO = "yes", "in part", "no"
STAGES = ("ingest", "pair", "separate", "fit", "diagnose", "simulate")
_SPEEDS_SHOWN = 8
_MOSTLY = 0.8
"""Share of pairs in which friction must oppose motion to be believed."""


@dataclass(frozen=True, slots=True)
class Stage:
    """Whether the logs suffice for a stage (``yes``, ``in part``, ``no``), and why."""

    name: str
    suffices: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSummary:
    """What all logs together hold of one joint, and what they suffice for.

    Attributes
    ----------
    joint : int
        Its number, from 1.
    runs, recordings : int
        Where it was found.
    forward, reverse, pairs : int
        Constant-speed parts in either direction, and pairs of them.
    speeds : tuple of float
        Speeds of the pairs. [deg/s]
    temperature : tuple of float or None
        Lowest and highest motor temperature of the pairs. [°C]
    load : tuple of float or None
        Lowest and highest load torque of the pairs. [N·m or A]
    stages : tuple of Stage
        In their order.
    """

    joint: int
    runs: int
    recordings: int
    forward: int
    reverse: int
    pairs: int
    speeds: tuple[float, ...]
    temperature: tuple[float, float] | None
    load: tuple[float, float] | None
    stages: tuple[Stage, ...]


@dataclass(frozen=True, slots=True)
class RecordingCounts:
    """What is known of the recordings of one joint: how many, of how many runs, and their starts.

    ``time_known`` is false where start times are not known.
    """

    runs: int
    count: int
    time_known: bool


def joint_summary(
    joint: int, moves: Mapping[str, int], recordings: RecordingCounts, pairs: pd.DataFrame
) -> JointSummary:
    """Return what the logs hold of a joint and for which stages it suffices.

    Parameters
    ----------
    joint : int
        Which joint.
    moves : mapping of str to int
        Constant-speed parts ``forward`` and ``reverse``.
    recordings : RecordingCounts
        What is known of its recordings.
    pairs : DataFrame
        Its rows of :func:`frictioncli.inspection.pair_check.pair_heads`.
    """
    stages = [Stage("ingest", YES, _ingest_told(recordings)), _pair(moves, pairs)]
    if len(pairs):
        stages.append(_separate(joint, pairs))
    if len(pairs) and stages[-1].suffices != NO:
        later = [_fit(pairs), _diagnose(pairs, recordings), _simulate(pairs)]
        doubtful = stages[-1].suffices == IN_PART
        stages += [_with_doubt(stage) if doubtful else stage for stage in later]
    missing = STAGES[len(stages) :]
    stages += [Stage(name, NO, f"needs what {stages[-1].name} gives") for name in missing]
    return JointSummary(
        joint=joint,
        runs=recordings.runs,
        recordings=recordings.count,
        forward=moves[FORWARD],
        reverse=moves[REVERSE],
        pairs=len(pairs),
        speeds=tuple(sorted(pairs["speed"].unique().tolist())),
        temperature=_range(pairs["motor_temperature"]),
        load=_range(pd.concat([pairs["load_low"], pairs["load_high"]])),
        stages=tuple(stages),
    )


def _range(values: pd.Series) -> tuple[float, float] | None:
    known = values.dropna()
    return None if known.empty else (float(known.min()), float(known.max()))


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'s' * (count != 1)}"


def _ingest_told(recordings: RecordingCounts) -> str:
    return f"{_counted(recordings.count, 'recording')} in {_counted(recordings.runs, 'run')}"


def _pair(moves: Mapping[str, int], pairs: pd.DataFrame) -> Stage:
    if not len(pairs):
        if not any(moves.values()):
            return Stage("pair", NO, "this joint never holds a constant speed")
        told = f"constant speed {moves[FORWARD]}x forward and {moves[REVERSE]}x in reverse"
        return Stage(
            "pair",
            NO,
            f"{told} makes no pair: a pair needs the same angles, speed, temperature and payload"
            " within some minutes; see --same-speed, --same-temperature and --longest-pause of"
            " pair",
        )
    counts = pairs["speed"].round(1).value_counts().sort_index()
    told = ", ".join(f"{count} at {speed:g}" for speed, count in counts.head(_SPEEDS_SHOWN).items())
    more = f" and {len(counts) - _SPEEDS_SHOWN} other speeds" if len(counts) > _SPEEDS_SHOWN else ""
    return Stage("pair", YES, f"{_counted(len(pairs), 'pair')}: {told}{more} deg/s")


def _separate(joint: int, pairs: pd.DataFrame) -> Stage:
    """Judge the half differences: friction opposes motion in nearly every pair."""
    runs: dict[str, HalfDifferences] = {}
    for run, half in pairs.groupby("run")["half_difference"]:
        runs.setdefault(str(run), HalfDifferences()).add(half.to_numpy(float))
    try:
        friction = inferred_sign(joint, runs) * pairs["half_difference"]
    except NotEnoughData as fault:
        return Stage("separate", NO, str(fault))
    low, high = pairs["load_low"].min(), pairs["load_high"].max()
    told = f"half difference {friction.mean():.3g} on average, load {low:.3g} to {high:.3g}"
    opposing = float(np.mean(friction > 0))
    if opposing < _MOSTLY:
        return Stage(
            "separate",
            IN_PART,
            f"{told}, but it opposes motion in {100 * opposing:.0f} % of the pairs only: is this"
            " torque already freed of friction, or another joint's? Try the other torque or current"
            " columns",
        )
    return Stage("separate", YES, told)


def _with_doubt(stage: Stage) -> Stage:
    """Return what a stage can do with torques in which friction is in doubt."""
    if stage.suffices == NO:
        return stage
    return Stage(stage.name, IN_PART, f"{stage.reason}; friction is in doubt, see separate")


def _fit(heads: pd.DataFrame) -> Stage:
    if len(heads) < LEAST_TO_FIT:
        return Stage(
            "fit", NO, f"{_counted(len(heads), 'pair')}, at least {LEAST_TO_FIT} are needed"
        )
    lacking = [*_temperature_lacking(heads), *_speed_lacking(heads)]
    told = _counted(len(heads), "pair")
    if lacking:
        return Stage("fit", IN_PART, f"{told}, but {'; '.join(lacking)}")
    temperature = _range(heads["motor_temperature"]) or (0.0, 0.0)
    return Stage("fit", YES, f"{told} at {temperature[0]:.0f} to {temperature[1]:.0f} °C")


def _temperature_lacking(heads: pd.DataFrame) -> Iterable[str]:
    temperature = _range(heads["motor_temperature"])
    if temperature is None:
        yield "no motor temperature: terms of temperature are left out"
    elif temperature[1] - temperature[0] < MIN_TEMPERATURE_SPAN:
        yield (
            f"temperature spans {temperature[1] - temperature[0]:.1f} °C: its terms need at least"
            f" {MIN_TEMPERATURE_SPAN:g} °C"
        )


def _speed_lacking(heads: pd.DataFrame) -> Iterable[str]:
    slowest, fastest = heads["speed"].min(), heads["speed"].max()
    if fastest < MIN_SPEED_RATIO * slowest:
        yield (
            f"speeds span {slowest:.3g} to {fastest:.3g} deg/s: viscous and Coulomb friction need"
            f" a ratio of at least {MIN_SPEED_RATIO:g}"
        )


def _diagnose(heads: pd.DataFrame, recordings: RecordingCounts) -> Stage:
    runs = sorted(heads["run"].unique())
    learned = heads if len(runs) == 1 else heads[heads["run"] != runs[-1]]
    if len(learned) < LEAST_TO_DIAGNOSE:
        kept = " before the last run, which is kept for testing" if len(runs) > 1 else ""
        told = f"{_counted(len(learned), 'pair')}{kept}; at least {LEAST_TO_DIAGNOSE} are needed"
        return Stage("diagnose", NO, told)
    lacking = []
    if len(runs) == 1:
        lacking.append("one run only: no day that it has not seen, gains flatter")
    if not recordings.time_known:
        lacking.append(
            "start times are not known: effects of time and temperature history cannot be judged"
        )
    told = f"{_counted(len(learned), 'pair')} to learn from"
    if lacking:
        return Stage("diagnose", IN_PART, f"{told}, but {'; '.join(lacking)}")
    return Stage("diagnose", YES, told)


def _simulate(heads: pd.DataFrame) -> Stage:
    lacking = list(_temperature_lacking(heads))
    if lacking:
        return Stage("simulate", NO, lacking[0])
    phases: Mapping[str, int] = heads.loc[heads["phase"] != SWEEP, "phase"].value_counts().to_dict()
    if not phases:
        return Stage("simulate", NO, "no heat-up or cool-down by 5 °C or more in one run")
    told = ", ".join(f"{count} pairs of {phase}" for phase, count in sorted(phases.items()))
    return Stage("simulate", YES, told)
