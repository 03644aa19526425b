"""One joint of the blind study diagnosed: from torques per angle bin, or from logs."""

import json
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from frictioncli import documents
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.margin import margin_of
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import EFFECTS
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from frictioncli.simulator.synthesize import synthesize
from frictioncli.stages.diagnose import diagnose
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from frictioncli.workfiles import DIAGNOSIS, EXTENDED
from tests.studies.blind_truth import TEMPERATURE
from tests.studies.blind_worlds import World

SETTINGS = DiagnosisSettings()
FIT = FitSettings(temperature=TEMPERATURE)


@dataclass(frozen=True, slots=True)
class Said:
    """What the program says of a joint.

    Attributes
    ----------
    diagnosis, model : dict
        As ``diagnosis.json`` and ``extended-model.json`` have it.
    seconds : float
        Time that the diagnosis took of one core. [s]
    """

    diagnosis: dict[str, Any]
    model: dict[str, Any]
    seconds: float


def said_of_torques(torques: pd.DataFrame) -> Said:
    """Diagnose torques per angle bin."""
    model = fit_joint(torques, {}, FIT)
    began = time.process_time()
    diagnosis = diagnose_joint(torques, TEMPERATURE, "N·m", SETTINGS)
    document = diagnosis_document(diagnosis, SETTINGS)
    seconds = time.process_time() - began
    return Said(
        _plain(document),
        _plain(extended_document(diagnosis, model)),
        seconds,
    )


def said_of_logs(world: World) -> Said:
    """Simulate the logs of a joint, and read, pair, separate, fit and diagnose them."""
    with tempfile.TemporaryDirectory() as folder:
        logs, work = Path(folder) / "logs", Path(folder) / "run"
        synthesize(logs, world.settings(world.names))
        ingest(sorted(path for path in logs.iterdir() if path.is_dir()), work)
        pair(work)
        separate(work)
        fit(work, FIT)
        began = time.process_time()
        diagnose(work, SETTINGS)
        seconds = time.process_time() - began
        diagnosis, model = (
            json.loads((work / name).read_text(encoding="utf-8")) for name in (DIAGNOSIS, EXTENDED)
        )
    return Said(diagnosis, model, seconds)


def sizes_without_discrepancy(torques: pd.DataFrame) -> dict[str, float | None]:
    """Return the sizes that would be found if the base were exactly true but for the causes."""
    runs = sorted(torques["run"].unique())
    problem, _ = build_problems(torques, TEMPERATURE, str(runs[-1]))
    margin = margin_of(problem, "N·m", SETTINGS)
    found = find_causes(problem, EFFECTS, SETTINGS, margin, discrepancy=0.0)
    return found.detectable_sizes(EFFECTS, SETTINGS.alpha, margin)


def _plain(document: object) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(documents.to_json(document))
    return found
