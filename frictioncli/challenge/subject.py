"""The joint of a log into which effects are planted: what its log, pairs and diagnosis hold."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc

from frictioncli import schemas, tables
from frictioncli.challenge.log_state import LogState, log_states
from frictioncli.challenge.logged_run import logged_runs
from frictioncli.challenge.planting import LogTiming
from frictioncli.challenge.shapes import LogScale, log_scale
from frictioncli.diagnosis.documents.document import DiagnosisDocument, read_diagnoses
from frictioncli.effects import BY_NAME
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.workfiles import DIAGNOSIS, MODEL, SAMPLES, TORQUES

ROW = ["run", "pair", "position"]
"""Columns that tell the rows of the torques of a joint apart."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """A joint as it was logged.

    Attributes
    ----------
    samples : DataFrame
        Its samples, numbered from 0.
    states : tuple of LogState
        Its state in each run.
    torques : DataFrame
        Its pairs and angle bins with friction and load torque.
    model : FrictionModel
        Its fitted model.
    diagnosis : DiagnosisDocument
        Its diagnosis as it is.
    scale : LogScale
        What its log spans.
    timing : LogTiming
        How late the log holds torque, as far as the diagnosis tells.
    """

    samples: pd.DataFrame
    states: tuple[LogState, ...]
    torques: pd.DataFrame
    model: FrictionModel
    diagnosis: DiagnosisDocument
    scale: LogScale
    timing: LogTiming

    @property
    def joint(self) -> int:
        """Its number, from 1."""
        return self.model.joint

    def channel_of(self, effect: str) -> str:
        """Return the channel in which an effect shows most, friction for one not listed."""
        return BY_NAME[effect].channel if effect in BY_NAME else "friction"

    def reference(self, channel: str) -> float:
        """Return what sizes in a channel are shares of: the mean friction, or the RMS load.

        Parameters
        ----------
        channel : {"friction", "load"}
            The channel; load counts where the log has a load channel of another unit.
        """
        seen = self.torques[self.torques["run"].isin(self.diagnosis.runs)]
        if channel == "load" and self.diagnosis.load_unit is not None:
            return float(np.sqrt(np.mean(np.square(seen["load_torque"].to_numpy(float)))))
        return float(np.mean(np.abs(seen["friction_torque"].to_numpy(float))))


def read_subjects(work: Path) -> list[Subject]:
    """Return the joints of a work folder that have a diagnosis.

    The samples of a joint are held in memory: about 200 bytes per sample.

    Parameters
    ----------
    work : Path
        Work folder after ``diagnose``.

    Raises
    ------
    TableError
        If a table or document is missing or damaged.
    """
    diagnoses = read_diagnoses(work / DIAGNOSIS)
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    return [
        _subject(work, model, diagnoses[model.joint], torques[torques["joint"] == model.joint])
        for model in read_models(work / MODEL)
        if model.joint in diagnoses
    ]


def _subject(
    work: Path, model: FrictionModel, diagnosis: DiagnosisDocument, torques: pd.DataFrame
) -> Subject:
    samples = _samples(work / SAMPLES, model.joint)
    states = log_states(logged_runs(samples), torques, model)
    return Subject(
        samples=samples,
        states=tuple(states),
        torques=torques.reset_index(drop=True),
        model=model,
        diagnosis=diagnosis,
        scale=log_scale(torques, states, diagnosis.runs),
        timing=timing_of(diagnosis),
    )


def _samples(path: Path, joint: int) -> pd.DataFrame:
    """Return the samples of one joint."""
    parts = [
        batch.filter(pc.equal(batch.column("joint"), joint))
        for batch in tables.batches(path, schemas.SAMPLES)
    ]
    frame = pa.Table.from_batches(parts).unify_dictionaries().to_pandas()
    for column in schemas.SAMPLES.columns:
        if column.name not in frame:
            frame[column.name] = np.nan
    return frame.astype({"run": str, "recording": str})


def timing_of(diagnosis: DiagnosisDocument) -> LogTiming:
    """Return how late a log holds torque, where its diagnosis tells a delay or a filter.

    Of a set of both it is the one whose parameters are stated; what physics or the starts of moves
    contradict is none.

    Parameters
    ----------
    diagnosis : DiagnosisDocument
        The diagnosis of the log as it is.
    """
    for cause in (*diagnosis.causes, *diagnosis.visible):
        is_timing = bool(cause.effects) and set(cause.effects) <= {"torque_delay", "torque_filter"}
        if is_timing and cause.standing != "undetermined":
            values = {
                name: max(one.estimate, 0.0)
                for name, one in cause.parameters.items()
                if one.unit == "s"
            }
            return LogTiming(
                delay=values.get("delay", 0.0), time_constant=values.get("time_constant", 0.0)
            )
    return LogTiming()
