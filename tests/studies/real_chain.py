"""One run of the whole chain on real logs, and what a page says of it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from frictioncli import tables
from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.errors import FrictionError
from frictioncli.inspection.document import document
from frictioncli.inspection.inspect import inspect
from frictioncli.logs.settings import IngestSettings
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.schemas import TORQUES as TORQUES_TABLE
from frictioncli.stages.run import analyse
from frictioncli.stages.settings import RunSettings
from frictioncli.workfiles import MODEL, TORQUES
from tests.studies.real_page import diagnosis_sentence

_SAME_SPEED = 0.03
"""Speeds of pairs closer than this share are one speed."""

_FEWEST = 3
"""Pairs from which on their scatter gives an interval."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedFriction:
    """Friction at one speed.

    Attributes
    ----------
    speed : float
        Speed of the joint. [deg/s]
    friction : float
        Mean over pairs, or the regression's. [torque unit]
    ci95 : (float, float) or None
        Its 95 % interval, where it is known. [torque unit]
    """

    speed: float
    friction: float
    ci95: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class JointResult:
    """What the program says of one joint.

    Attributes
    ----------
    joint : int
        Its number.
    unit, side : str
        Unit of the torque, and the side of the gear on which it was measured.
    way : {"pairs", "regression"}
        Where its friction comes from.
    pairs : int
        Pairs, or groups of the regression.
    frictions : list of SpeedFriction
        Friction at its speeds, ascending.
    model : FrictionModel
        Its parameters.
    diagnosis : str
        The diagnosis in a sentence, or why there is none.
    channels : list of str
        Its columns with their units, and why these are believed.
    """

    joint: int
    unit: str
    side: str
    way: str
    pairs: int
    frictions: list[SpeedFriction]
    model: FrictionModel
    diagnosis: str
    channels: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One run of the chain.

    Attributes
    ----------
    refusal : str
        The program's refusal; empty where it gave a result.
    notes : list of str
        What it notes on logs and pairs.
    joints : list of JointResult
        A result for each joint.
    """

    refusal: str = ""
    notes: list[str] = field(default_factory=list)
    joints: list[JointResult] = field(default_factory=list)


def attempt(logs: Sequence[Path], work: Path, map_file: Path | None = None) -> Attempt:
    """Run the chain on logs with default settings.

    Parameters
    ----------
    logs : sequence of Path
        Folders of logs, each one run.
    work : Path
        Work folder.
    map_file : Path, optional
        A mapping file.
    """
    said: dict[str, str] = {}
    settings = RunSettings(ingest=IngestSettings(map_file=map_file))
    try:
        analyse(logs, work, settings, lambda stage, result: said.update({stage: result.text}))
    except FrictionError as refusal:
        return Attempt(refusal=str(refusal))
    facts = tables.facts(work / TORQUES)
    rows = tables.read(work / TORQUES, TORQUES_TABLE)
    documents = read_documents(work)
    channels = channels_of(logs, settings.ingest)
    results = []
    for model in read_models(work / MODEL):
        joint = model.joint
        own = rows[rows["joint"] == joint]
        regression = facts.get("regression", {}).get(str(joint))
        if joint in documents:
            diagnosis = diagnosis_sentence(documents[joint][0])
        else:
            diagnosis = said.get("diagnose", "left out")
        results.append(
            JointResult(
                joint=joint,
                unit=model.torque_unit,
                side=model.torque_side,
                way=facts.get("separated_by", {}).get(str(joint), "pairs"),
                pairs=len(own[["run", "pair"]].drop_duplicates()),
                frictions=of_pairs(own) if regression is None else of_regression(regression),
                model=model,
                diagnosis=diagnosis,
                channels=channels.get(joint, []),
            )
        )
    notes = [*facts.get("notes", []), *facts.get("warnings", []), *_warnings(said["pair"])]
    return Attempt(notes=notes, joints=results)


def channels_of(logs: Sequence[Path], settings: IngestSettings) -> dict[int, list[str]]:
    """Return the channels of each joint as `inspect` believes them, of its first log."""
    found: dict[int, list[str]] = {}
    for file in document(inspect(logs, settings))["files"]:
        for joint in file["joints"]:
            lines = [
                f"{one['quantity']} in {one['unit_believed']}: `{one['column']}`, {one['evidence']}"
                for one in joint["channels"]
            ]
            if any(line.startswith("torque") for line in lines):
                found.setdefault(joint["joint"], lines)
    return found


def of_pairs(rows: pd.DataFrame) -> list[SpeedFriction]:
    """Return the mean friction of pairs of one speed, with the interval of their scatter."""
    pairs = rows.groupby(["run", "pair"], observed=True)[["speed", "friction_torque"]].mean()
    pairs = pairs.sort_values("speed")
    speeds = pairs["speed"].to_numpy()
    group = np.concatenate([[0], np.cumsum(np.diff(speeds) > _SAME_SPEED * speeds[:-1])])
    found = []
    for _, own in pairs.groupby(group):
        values, interval = own["friction_torque"].to_numpy(), None
        mean = float(values.mean())
        if len(values) >= _FEWEST:
            error = values.std(ddof=1) / np.sqrt(len(values))
            half = float(stats.t.ppf(0.975, len(values) - 1) * error)
            interval = (mean - half, mean + half)
        found.append(SpeedFriction(speed=float(own["speed"].mean()), friction=mean, ci95=interval))
    return found


def of_regression(facts: dict[str, Any]) -> list[SpeedFriction]:
    """Return the friction at the speeds that a regression states, with its intervals."""
    return [
        SpeedFriction(speed=one["speed"], friction=one["estimate"], ci95=tuple(one["ci95"]))
        for one in facts["friction"]
    ]


def _warnings(text: str) -> list[str]:
    """Return the warnings and notes in what a stage says."""
    lines = (line.strip() for line in text.splitlines())
    return [line for line in lines if line.startswith(("warning: ", "note: "))]
