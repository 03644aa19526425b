"""Contents of a work folder as the report uses them, read once and passed on."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli import schemas, tables
from frictioncli.arrays import Array
from frictioncli.challenge_schema import CHALLENGE
from frictioncli.design.document import PlanDocument
from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.extended_document import ExtendedDocument
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.diagnosis.documents.reload import Reloaded, is_current, read_documents, reload
from frictioncli.errors import TableError
from frictioncli.files import is_there
from frictioncli.logs.runs.run_order import runs_in_order
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.model.friction import friction_torque
from frictioncli.model.late_torque import without_delay
from frictioncli.model.zero_load import PAIR_KEY, friction_at_zero_load, temperature_of
from frictioncli.report.belonging import belonging_files
from frictioncli.report.folder_reading import (
    read_extended_models,
    read_if_present,
    read_metadata,
    read_plan,
)
from frictioncli.report.style import PHASES, SpeedStyle, speed_styles
from frictioncli.workfiles import DIAGNOSIS, EVALUATION, EXTENDED, MODEL, PLAN, SCHEDULE, TORQUES

MOST_RUNS = 3
"""Greatest number of runs drawn in a figure, to fit a page."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointResults:
    """Results of one joint.

    Attributes
    ----------
    model : FrictionModel
        Friction model.
    torques : DataFrame
        The joint's rows of :data:`frictioncli.schemas.TORQUES`.
    pairs : DataFrame
        One row per pair with the friction torque at zero load, ``temperature``, the one that the
        model uses, and ``bins``, the number of its angle bins.
    schedule, evaluation : DataFrame
        The joint's rows of these tables; empty if the stage has not been run.
    styles : dict
        Colour and marker per speed.
    simulated_extended : bool
        Whether the schedule was simulated with the extended model.
    evaluation_settings : mapping
        Settings of the evaluation; empty without one.
    extended_model : ExtendedDocument or None
        The extended model: its friction function, and the records of its effects.
    extension : ExtendedModel or None
        Effects of the extended model.
    diagnosis : Reloaded or None
        Diagnosis of these runs.
    diagnosis_missing : str
        Why there is no diagnosis of these runs; empty if there is one.
    plan : PlanDocument or None
        The next experiment.
    challenge : DataFrame
        Effects planted in these logs; empty if none were.
    """

    model: FrictionModel
    torques: pd.DataFrame
    pairs: pd.DataFrame
    schedule: pd.DataFrame
    evaluation: pd.DataFrame
    styles: Mapping[float, SpeedStyle] = field(default_factory=dict)
    simulated_extended: bool = False
    evaluation_settings: Mapping[str, Any] = field(default_factory=dict)
    extended_model: ExtendedDocument | None = None
    extension: ExtendedModel | None = None
    diagnosis: Reloaded | None = None
    diagnosis_missing: str = ""
    plan: PlanDocument | None = None
    challenge: pd.DataFrame = field(default_factory=pd.DataFrame)

    @property
    def joint(self) -> int:
        """Joint number, from 1."""
        return self.model.joint

    @property
    def unit(self) -> str:
        """Unit of friction torque."""
        return self.model.torque_unit

    @property
    def row_noun(self) -> str:
        """What a row of ``pairs`` is called: ``pair``, or ``group`` by regression."""
        return self.model.row_noun

    @property
    def rows_meaning(self) -> str:
        """What a row of ``pairs`` is, to follow its noun."""
        by_regression = "of samples at one speed, temperature and time, by regression,"
        return "of counter-directed moves" if self.row_noun == "pair" else by_regression

    @property
    def load_unit(self) -> str:
        """Unit of load torque: N·m if the log has a load channel, else that of friction torque."""
        return "N·m" if self.torques["load"].notna().any() else self.unit

    @property
    def runs(self) -> list[str]:
        """Names of the joint's runs, in order."""
        return runs_in_order(self.torques)

    @property
    def thermal_pairs(self) -> pd.DataFrame:
        """Pairs of the heating and cooling phases."""
        return self.pairs[self.pairs["phase"].isin(PHASES)]

    @property
    def evaluated_extended(self) -> bool:
        """Whether corrections were evaluated with the extended model."""
        return bool(self.evaluation_settings.get("extended"))

    def style(self, speed: float) -> SpeedStyle:
        """Return colour and marker of the measured speed nearest to ``speed``.

        Parameters
        ----------
        speed : float
            Joint speed. [deg/s]
        """
        return self.styles[min(self.styles, key=lambda known: abs(known - speed))]

    def predict(self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike) -> Array:
        """Return the modelled friction torque [torque unit].

        Parameters
        ----------
        load : array_like
            Load torque. [torque unit]
        speed : array_like
            Absolute joint velocity. [deg/s]
        temperature : array_like
            Temperature parameter; ignored by a model without temperature. [°C]
        """
        known = np.asarray(temperature, dtype=float)
        if not self.model.knows_temperature:
            known = np.zeros_like(known)
        return friction_torque(self.model.friction, load=load, speed=speed, temperature=known)

    def friction(self) -> pd.DataFrame:
        """Return the torques with friction that is freed of a delay, as it was fitted."""
        return without_delay(self.torques, self.model.late_by)

    def has(self, column: str) -> bool:
        """Return whether any pair has a value in ``column``."""
        return bool(self.pairs[column].notna().any())


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkFolderResults:
    """Contents of a work folder.

    Attributes
    ----------
    joints : tuple of JointResults
        Results of each joint that has a model.
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of all joints.
    recordings, rejected : DataFrame
        Recordings and rejected rows of the logs; empty if there is no such table.
    metadata : mapping of str to mapping
        Per file its provenance and, for tables, facts about their rows.
    files : frozenset of str
        Names of the files of the work folder that belong together.
    left_out : tuple of str
        Parts that belong to other torques or another model and are not shown, one sentence each.
    """

    joints: tuple[JointResults, ...]
    torques: pd.DataFrame
    recordings: pd.DataFrame
    rejected: pd.DataFrame
    metadata: Mapping[str, Mapping[str, Any]]
    files: frozenset[str] = frozenset()
    left_out: tuple[str, ...] = ()

    @property
    def runs(self) -> list[str]:
        """Names of all runs, in order."""
        return runs_in_order(self.torques)

    @property
    def log_files(self) -> pd.DataFrame:
        """The recordings, each once; the table has one row per recording and joint."""
        return self.recordings.drop_duplicates(["run", "recording"])


def by_speed(rows: pd.DataFrame) -> list[tuple[float, pd.DataFrame]]:
    """Return the rows of each speed, slowest first."""
    return [(float(str(speed)), group) for speed, group in rows.groupby("speed")]


def read_results(work: Path) -> WorkFolderResults:
    """Read everything in a work folder that the report uses.

    Parameters
    ----------
    work : Path
        The work folder.

    Raises
    ------
    TableError
        If ``torques.parquet`` or ``model.json`` is missing, or a file is damaged.
    """
    path = work / TORQUES
    if not is_there(path):
        raise TableError(f"{path} is missing; 'frictioncli separate -w {work}' makes it")
    torques = tables.read(path, schemas.TORQUES)
    models = read_models(work / MODEL)
    belonging = belonging_files(work)
    schedule, evaluation, recordings, rejected = (
        read_if_present(work, table, belonging.files)
        for table in (schemas.SCHEDULE, schemas.EVALUATION, schemas.RECORDINGS, schemas.REJECTED)
    )
    diagnoses = read_documents(work) if belonging.files >= {DIAGNOSIS, EXTENDED} else {}
    extended_models, extensions = (
        read_extended_models(work) if EXTENDED in belonging.files else ({}, {})
    )
    planted = read_if_present(work, CHALLENGE, belonging.files)
    plan = read_plan(work) if PLAN in belonging.files else None
    metadata = dict(read_metadata(work, belonging.files))
    simulated_extended = bool(_settings(metadata, SCHEDULE).get("extended"))
    joints = []
    for model in models:
        own, pairs = _pairs_of(torques, model)
        diagnosis, missing = _diagnosis_of(model.joint, own, diagnoses)
        joints.append(
            JointResults(
                model=model,
                torques=own,
                pairs=pairs,
                schedule=_rows_of(schedule, model.joint),
                evaluation=_rows_of(evaluation, model.joint),
                styles=speed_styles(pairs),
                simulated_extended=simulated_extended,
                evaluation_settings=_settings(metadata, EVALUATION),
                extended_model=extended_models.get(model.joint),
                extension=extensions.get(model.joint),
                diagnosis=diagnosis,
                diagnosis_missing=missing,
                plan=plan if plan is not None and plan.joint == model.joint else None,
                challenge=_rows_of(planted, model.joint),
            )
        )
    return WorkFolderResults(
        joints=tuple(joints),
        torques=torques,
        recordings=recordings,
        rejected=rejected,
        metadata=metadata,
        files=belonging.files,
        left_out=belonging.left_out,
    )


def _settings(metadata: Mapping[str, Mapping[str, Any]], file: str) -> Mapping[str, Any]:
    return metadata.get(file, {}).get("settings") or {}


def _rows_of(table: pd.DataFrame, joint: int) -> pd.DataFrame:
    return table[table["joint"] == joint].reset_index(drop=True)


def _pairs_of(torques: pd.DataFrame, model: FrictionModel) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the joint's torques, and its pairs with friction torque at zero load."""
    own = _rows_of(torques, model.joint)
    if own.empty:
        raise TableError(
            f"model.json: has joint {model.joint}, which torques.parquet lacks;"
            " run 'frictioncli fit' again"
        )
    pairs = friction_at_zero_load(without_delay(own, model.late_by), model.friction.alpha)
    bins = own.groupby(PAIR_KEY).size().rename("bins").reset_index()
    temperature = temperature_of(pairs, model.temperature)
    return own, pairs.merge(bins, on=PAIR_KEY).assign(temperature=temperature)


def _diagnosis_of(
    joint: int,
    torques: pd.DataFrame,
    diagnoses: Mapping[int, tuple[DiagnosisDocument, ExtendedModel]],
) -> tuple[Reloaded | None, str]:
    """Return the joint's diagnosis if it is of these runs, else None and the reason."""
    if not diagnoses:
        return None, "The simulation has not been diagnosed yet; 'frictioncli diagnose' does it."
    if joint not in diagnoses:
        return None, "This joint has no diagnosis; 'frictioncli diagnose' says why."
    document, extension = diagnoses[joint]
    if not is_current(document, torques):
        return None, (
            "The diagnosis is of other runs than those measured; run 'frictioncli diagnose' again."
        )
    return reload(torques, document, extension), ""
