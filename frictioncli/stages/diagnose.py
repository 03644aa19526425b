"""Causes of the misfit between simulated and measured torque: ``diagnose``."""

from dataclasses import asdict
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.document import read_diagnoses
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.documents.other_joint import with_other_joint
from frictioncli.diagnosis.documents.text import verdict_text
from frictioncli.diagnosis.ramps.evidence import ramp_logs
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.documents import write_joints
from frictioncli.errors import NotEnoughData
from frictioncli.model.document import read_models
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import StageResult, existing, stage
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, RAMPS, TORQUES


@stage
def diagnose(
    work: Path, settings: DiagnosisSettings | None = None, *, sizes: bool = True
) -> StageResult:
    """Find what the simulated torque gets wrong: ``diagnosis.json``, ``extended-model.json``.

    Parameters
    ----------
    work : Path
        Work folder with ``torques.parquet`` and ``model.json``.
    settings : DiagnosisSettings, optional
        Significance level and limits of the search.
    sizes : bool, optional
        Whether the smallest size of each effect that would be named is worked out.

    Raises
    ------
    NotEnoughData
        If no joint has data enough.
    TableError
        If a table or the model is missing or damaged.
    """
    settings = settings or DiagnosisSettings()
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    facts = tables.facts(work / TORQUES)
    unit = facts.get("torque_unit", "N·m")
    two_loads = facts.get("two_loads", {})
    ramps = ramp_logs(work / RAMPS, facts.get("sign", {}))
    inputs = existing(work / TORQUES, work / MODEL, work / RAMPS)
    diagnoses, extended, faults = {}, {}, []
    for model in read_models(work / MODEL):
        rows = torques[torques["joint"] == model.joint]
        try:
            if rows.empty:
                raise NotEnoughData(f"{work / TORQUES} has no rows of joint {model.joint}")
            diagnosis = diagnose_joint(
                rows,
                model.temperature,
                unit,
                settings,
                ramps=ramps.get(model.joint),
                doubt=two_loads.get(str(model.joint), ""),
            )
        except NotEnoughData as fault:
            faults.append(str(fault))
        else:
            found = diagnosis_document(diagnosis, settings, sizes=sizes)
            moving = facts.get("other_motion", {}).get(str(model.joint))
            diagnoses[model.joint] = with_other_joint(found, moving)
            extended[model.joint] = extended_document(diagnosis, model)
    if not diagnoses:
        raise NotEnoughData("; ".join(faults) or f"{work / MODEL} has no models")
    provenance = Provenance("diagnose", asdict(settings), input_hashes(inputs))
    main_joint = max(extended, key=lambda joint: extended[joint].n_pairs)
    write_joints(work / DIAGNOSIS, diagnoses, main_joint, provenance)
    write_joints(work / EXTENDED, extended, main_joint, provenance)
    texts = (verdict_text(document) for document in diagnoses.values())
    doubts = [
        f"joint {joint}: no cause of friction has a name: {text}"
        for joint, text in two_loads.items()
        if int(joint) in diagnoses
    ]
    return StageResult(work / DIAGNOSIS, "\n".join([*texts, *doubts, *faults]))


def has_finding(work: Path, *, named_only: bool) -> bool:
    """Return whether the diagnosis of any joint has found something.

    A finding is a cause that is named, a property of the measurement and a change that did not
    last included, or structure without a name. What is listed as visible is none.

    Parameters
    ----------
    work : Path
        Work folder with ``diagnosis.json``.
    named_only : bool
        Whether only causes that have a single name count.
    """
    diagnoses = read_diagnoses(work / DIAGNOSIS).values()
    return any(
        len(cause.effects) == 1 and cause.standing == "named" if named_only else True
        for diagnosis in diagnoses
        for cause in diagnosis.causes
    )
