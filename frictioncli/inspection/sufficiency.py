"""Whether logs suffice for each stage, determined by the code of the stages where that is cheap."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from frictioncli.diagnosis.diagnose import LEAST_PAIRS as LEAST_TO_DIAGNOSE
from frictioncli.errors import NotEnoughData
from frictioncli.inspection.findings import JointInspection
from frictioncli.inspection.pair_check import FORWARD, REVERSE
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.fitting import LEAST_PAIRS as LEAST_TO_FIT
from frictioncli.model.identifiability import MIN_SPEED_RATIO, MIN_TEMPERATURE_SPAN
from frictioncli.model.settings import LEAST_OPPOSING, not_opposing
from frictioncli.pairs.separation import HalfDifferences, inferred_sign
from frictioncli.pairs.thermal_phases import SWEEP

YES, IN_PART, NO = "yes", "in part", "no"
STAGES = ("ingest", "pair", "separate", "fit", "diagnose", "simulate")
_AS_FAR = "as far as the regression gives torques"
_SPEEDS_SHOWN = 8


@dataclass(frozen=True, slots=True)
class StageVerdict:
    """Whether the logs suffice for a stage.

    Attributes
    ----------
    name : str
        The stage.
    suffices : str
        ``yes``, ``in part`` or ``no``.
    reason : str
        Why.
    """

    name: str
    suffices: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class JointSummary:
    """Summary of what all logs hold of one joint, and of the stages for which they suffice.

    Attributes
    ----------
    joint : int
        Its number, from 1.
    runs, recordings : int
        Number of runs and recordings with this joint.
    forward, reverse, pairs : int
        Number of constant-speed segments in either direction, and of pairs.
    speeds : tuple of float
        Speeds of the pairs. [deg/s]
    temperature : tuple of float or None
        Lowest and highest temperature of the pairs. [°C]
    load : tuple of float or None
        Lowest and highest load torque of the pairs. [N·m or A]
    stages : tuple of StageVerdict
        One per stage, in order.
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
    stages: tuple[StageVerdict, ...]


@dataclass(frozen=True, slots=True)
class RecordingCounts:
    """Number of recordings of one joint.

    Attributes
    ----------
    runs, count : int
        Number of runs and recordings.
    time_known : bool
        False where start times are not known.
    """

    runs: int
    count: int
    time_known: bool


def joint_summary(
    joint: int,
    segments: Mapping[str, int],
    recordings: RecordingCounts,
    pairs: pd.DataFrame,
    found: JointInspection,
) -> JointSummary:
    """Return the summary of a joint.

    Parameters
    ----------
    joint : int
        The joint.
    segments : mapping of str to int
        Number of constant-speed segments ``forward`` and ``reverse``.
    recordings : RecordingCounts
        Its recordings.
    pairs : DataFrame
        Its pairs by :func:`frictioncli.inspection.pair_check.segments_and_pairs`.
    found : JointInspection
        What a file holds of it.
    """
    stages = [StageVerdict("ingest", YES, _recordings_text(recordings)), _pair(segments, pairs)]
    if len(pairs):
        stages.append(_separate(pairs, found))
    if len(pairs) and stages[-1].suffices != NO:
        later = [_fit(pairs), _diagnose(pairs, recordings), _simulate(pairs)]
        is_doubtful = stages[-1].suffices == IN_PART
        stages += [_doubtful(stage) if is_doubtful else stage for stage in later]
    if not len(pairs):
        regression = (
            "without pairs, 'separate' uses regression on all motion, and says whether the"
            " result suffices"
        )
        stages.append(StageVerdict("separate", IN_PART, regression))
        stages += [StageVerdict(name, IN_PART, _AS_FAR) for name in STAGES[len(stages) :]]
    missing = STAGES[len(stages) :]
    stages += [StageVerdict(name, NO, f"needs the output of {stages[-1].name}") for name in missing]
    return JointSummary(
        joint=joint,
        runs=recordings.runs,
        recordings=recordings.count,
        forward=segments[FORWARD],
        reverse=segments[REVERSE],
        pairs=len(pairs),
        speeds=tuple(sorted(pairs["speed"].unique().tolist())),
        temperature=_range(pairs["temperature"]),
        load=_range(pd.concat([pairs["load_low"], pairs["load_high"]])),
        stages=tuple(stages),
    )


def _range(values: pd.Series) -> tuple[float, float] | None:
    known = values.dropna()
    return None if known.empty else (float(known.min()), float(known.max()))


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'s' * (count != 1)}"


def _recordings_text(recordings: RecordingCounts) -> str:
    return f"{_counted(recordings.count, 'recording')} in {_counted(recordings.runs, 'run')}"


def _pair(segments: Mapping[str, int], pairs: pd.DataFrame) -> StageVerdict:
    if not len(pairs):
        if not any(segments.values()):
            return StageVerdict("pair", NO, "this joint never moves at constant speed")
        text = f"constant speed {segments[FORWARD]}x forward and {segments[REVERSE]}x in reverse"
        return StageVerdict(
            "pair",
            NO,
            f"{text} makes no pair: a pair needs the same angles, speed, temperature and payload"
            " within some minutes; see --same-speed, --same-temperature and --longest-pause of"
            " pair",
        )
    counts = pairs["speed"].round(1).value_counts().sort_index()
    text = ", ".join(f"{count} at {speed:g}" for speed, count in counts.head(_SPEEDS_SHOWN).items())
    more = f" and {len(counts) - _SPEEDS_SHOWN} other speeds" if len(counts) > _SPEEDS_SHOWN else ""
    return StageVerdict("pair", YES, f"{_counted(len(pairs), 'pair')}: {text}{more} deg/s")


def _separate(pairs: pd.DataFrame, found: JointInspection) -> StageVerdict:
    """Check the sign of the half differences: friction opposes motion in nearly every pair."""
    runs: dict[str, HalfDifferences] = {}
    for run, half in pairs.groupby("run")["half_difference"]:
        runs.setdefault(str(run), HalfDifferences()).add(half.to_numpy(float))
    try:
        friction = inferred_sign(found.joint, runs) * pairs["half_difference"]
    except NotEnoughData as error:
        return StageVerdict("separate", NO, str(error))
    low, high = pairs["load_low"].min(), pairs["load_high"].max()
    text = (
        f"friction {friction.mean():.3g} {found.torque_unit} on average, load {low:.3g} to"
        f" {high:.3g} {found.load_unit}"
    )
    opposing = float(np.mean(friction > 0))
    if opposing < LEAST_OPPOSING:
        return StageVerdict("separate", IN_PART, f"{text}, but {not_opposing(opposing)}")
    return StageVerdict("separate", YES, text)


def _doubtful(stage: StageVerdict) -> StageVerdict:
    """Return the verdict on a stage whose friction torque is doubtful."""
    if stage.suffices == NO:
        return stage
    return StageVerdict(stage.name, IN_PART, f"{stage.reason}; friction is in doubt, see separate")


def _fit(pairs: pd.DataFrame) -> StageVerdict:
    if len(pairs) < LEAST_TO_FIT:
        return StageVerdict(
            "fit", NO, f"{_counted(len(pairs), 'pair')}, at least {LEAST_TO_FIT} are needed"
        )
    limitations = [*_temperature_limitations(pairs), *_speed_limitations(pairs)]
    text = _counted(len(pairs), "pair")
    if limitations:
        return StageVerdict("fit", IN_PART, f"{text}, but {'; '.join(limitations)}")
    temperature = _range(pairs["temperature"]) or (0.0, 0.0)
    return StageVerdict("fit", YES, f"{text} at {temperature[0]:.0f} to {temperature[1]:.0f} °C")


def _temperature_limitations(pairs: pd.DataFrame) -> Iterable[str]:
    temperature = _range(pairs["temperature"])
    if temperature is None:
        yield "no motor or housing temperature: terms of temperature are left out"
    elif temperature[1] - temperature[0] < MIN_TEMPERATURE_SPAN:
        yield (
            f"temperature spans {temperature[1] - temperature[0]:.1f} °C: its terms need at least"
            f" {MIN_TEMPERATURE_SPAN:g} °C"
        )


def _speed_limitations(pairs: pd.DataFrame) -> Iterable[str]:
    slowest, fastest = pairs["speed"].min(), pairs["speed"].max()
    if fastest < MIN_SPEED_RATIO * slowest:
        yield (
            f"speeds span {slowest:.3g} to {fastest:.3g} deg/s: viscous and Coulomb friction need"
            f" a ratio of at least {MIN_SPEED_RATIO:g}"
        )


def _diagnose(pairs: pd.DataFrame, recordings: RecordingCounts) -> StageVerdict:
    runs = runs_in_order(pairs)
    training = pairs if len(runs) == 1 else pairs[pairs["run"] != runs[-1]]
    if len(training) < LEAST_TO_DIAGNOSE:
        kept = " before the last run, which is kept for testing" if len(runs) > 1 else ""
        text = f"{_counted(len(training), 'pair')}{kept}; at least {LEAST_TO_DIAGNOSE} are needed"
        return StageVerdict("diagnose", NO, text)
    limitations = []
    if len(runs) == 1:
        limitations.append("one run only: gains are measured on training data (optimistic)")
    if not recordings.time_known:
        limitations.append(
            "start times are not known: effects of time and temperature history cannot be judged"
        )
    text = f"{_counted(len(training), 'pair')} to learn from"
    if limitations:
        return StageVerdict("diagnose", IN_PART, f"{text}, but {'; '.join(limitations)}")
    return StageVerdict("diagnose", YES, text)


def _simulate(pairs: pd.DataFrame) -> StageVerdict:
    limitations = list(_temperature_limitations(pairs))
    if limitations:
        return StageVerdict("simulate", NO, limitations[0])
    phases: Mapping[str, int] = pairs.loc[pairs["phase"] != SWEEP, "phase"].value_counts().to_dict()
    if not phases:
        return StageVerdict("simulate", NO, "no heat-up or cool-down by 5 °C or more in one run")
    text = ", ".join(f"{count} pairs of {phase}" for phase, count in sorted(phases.items()))
    return StageVerdict("simulate", YES, text)
