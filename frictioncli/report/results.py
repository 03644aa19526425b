"""What the report draws from: the tables of one joint, read from the work folder."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from frictioncli import schemas, tables
from frictioncli.arrays import Array
from frictioncli.errors import TableError
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.model.friction import friction_torque
from frictioncli.model.zero_load import PAIR_KEY, friction_at_zero_load, temperature_of
from frictioncli.report.style import PHASES, SpeedStyle, speed_styles
from frictioncli.workfiles import MODEL, TORQUES

MOST_RUNS = 3
"""Runs drawn in a figure; more would not fit a page."""

_CORRECTED = (schemas.SCHEDULE, schemas.EVALUATION)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointResults:
    """Everything the report knows of one joint.

    Attributes
    ----------
    model : FrictionModel
        Its friction model.
    torques : DataFrame
        Its rows of :data:`frictioncli.schemas.TORQUES`.
    pairs : DataFrame
        One row per pair with the friction torque at zero load, ``temperature``, the one that the
        model uses, and ``bins``, the number of its angle bins.
    schedule, evaluation : DataFrame
        Its rows of these tables; empty where the stage has not been run.
    styles : dict
        Colour and marker per speed.
    simulated_extended, evaluated_extended : bool
        Whether these two tables are of the extended model.
    """

    model: FrictionModel
    torques: pd.DataFrame
    pairs: pd.DataFrame
    schedule: pd.DataFrame
    evaluation: pd.DataFrame
    styles: Mapping[float, SpeedStyle] = field(default_factory=dict)
    simulated_extended: bool = False
    evaluated_extended: bool = False

    @property
    def joint(self) -> int:
        """Joint number, from 1."""
        return self.model.joint

    @property
    def unit(self) -> str:
        """Unit of friction torque."""
        return self.model.torque_unit

    @property
    def load_unit(self) -> str:
        """Unit of the load torque, N·m where the log has a load channel of its own."""
        return "N·m" if self.torques["load"].notna().any() else self.unit

    @property
    def runs(self) -> list[str]:
        """Names of the joint's runs, in order."""
        return sorted(str(run) for run in self.torques["run"].unique())

    @property
    def thermal_pairs(self) -> pd.DataFrame:
        """Pairs of the heating and cooling phases."""
        return self.pairs[self.pairs["phase"].isin(PHASES)]

    def style(self, speed: float) -> SpeedStyle:
        """Return colour and marker of the known speed nearest to ``speed``, in deg/s."""
        return self.styles[min(self.styles, key=lambda known: abs(known - speed))]

    def predict(self, *, load: ArrayLike, speed: ArrayLike, temperature: ArrayLike) -> Array:
        """Return the modelled friction torque; a model without temperature needs none.

        Parameters
        ----------
        load : array_like
            Load torque. [torque unit]
        speed : array_like
            Absolute joint velocity. [deg/s]
        temperature : array_like
            Temperature parameter. [°C]
        """
        known = np.asarray(temperature, dtype=float)
        if not self.model.knows_temperature:
            known = np.zeros_like(known)
        return friction_torque(self.model.friction, load=load, speed=speed, temperature=known)

    def has(self, column: str) -> bool:
        """Return whether any pair has a value in ``column``."""
        return bool(self.pairs[column].notna().any())


def joint_results(
    model: FrictionModel, torques: pd.DataFrame, schedule: pd.DataFrame, evaluation: pd.DataFrame
) -> JointResults:
    """Pick one joint's rows out of the tables and reduce its torques to pairs.

    Parameters
    ----------
    model : FrictionModel
        The joint's model.
    torques, schedule, evaluation : DataFrame
        Whole tables.
    """
    own = torques[torques["joint"] == model.joint].reset_index(drop=True)
    if own.empty:
        raise TableError(
            f"model.json: has joint {model.joint}, which torques.parquet has not;"
            " run 'frictioncli fit' again"
        )
    pairs = friction_at_zero_load(own, model.friction.alpha)
    bins = own.groupby(PAIR_KEY).size().rename("bins").reset_index()
    pairs = pairs.merge(bins, on=PAIR_KEY).assign(
        temperature=temperature_of(pairs, model.temperature)
    )
    return JointResults(
        model=model,
        torques=own,
        pairs=pairs,
        schedule=schedule[schedule["joint"] == model.joint].reset_index(drop=True),
        evaluation=evaluation[evaluation["joint"] == model.joint].reset_index(drop=True),
        styles=speed_styles(pairs),
    )


def by_speed(rows: pd.DataFrame) -> list[tuple[float, pd.DataFrame]]:
    """Return the rows of each speed, slowest first."""
    return [(float(str(speed)), group) for speed, group in rows.groupby("speed")]


def read_results(work: Path) -> list[JointResults]:
    """Read what the report draws from, one entry per joint.

    Parameters
    ----------
    work : Path
        The work folder.

    Raises
    ------
    TableError
        If ``torques.parquet`` or ``model.json`` is missing or damaged.
    """
    path = work / TORQUES
    if not path.exists():
        raise TableError(f"{path} is missing; 'frictioncli separate -w {work}' makes it")
    torques = tables.read(path, schemas.TORQUES)
    models = read_models(work / MODEL)
    schedule = read_optional(work, schemas.SCHEDULE)
    evaluation = read_optional(work, schemas.EVALUATION)
    joints = [joint_results(model, torques, schedule, evaluation) for model in models]
    simulated, evaluated = (_is_extended(work, table) for table in _CORRECTED)
    return [
        replace(joint, simulated_extended=simulated, evaluated_extended=evaluated)
        for joint in joints
    ]


def _is_extended(work: Path, table: schemas.Table) -> bool:
    path = work / f"{table.name}.parquet"
    settings = tables.document(path).get("settings") or {} if path.exists() else {}
    return bool(settings.get("extended"))


def read_optional(work: Path, table: schemas.Table) -> pd.DataFrame:
    """Return a table of the work folder, without rows where the file does not exist."""
    path = work / f"{table.name}.parquet"
    if path.exists():
        return tables.read(path, table)
    return pd.DataFrame(columns=list(table.names))
