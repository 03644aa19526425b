"""Export of a model to controllers, simulators and tables: ``export``."""

from pathlib import Path

from frictioncli import __version__, schemas, tables
from frictioncli.correction.settings import ScheduleSettings
from frictioncli.deployment.deployed_model import DeployedModel, default_correction_speed
from frictioncli.deployment.export import export as export_model
from frictioncli.deployment.extension import LAG, DeployedExtension, deployable_extension
from frictioncli.deployment.settings import ExportSettings
from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.errors import OptionError, TableError
from frictioncli.files import write_text
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.provenance import input_hashes
from frictioncli.stages.correction_table import other_joint
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, TORQUES

EXPORTS = "export"
"""Subfolder of the work folder for exported files."""


@stage
def export(work: Path, settings: ExportSettings) -> StageResult:
    """Write the model of a joint for a controller, a simulator or a table: ``export/``.

    Parameters
    ----------
    work : Path
        Work folder, see :func:`deployed`.
    settings : ExportSettings
        Form of the file and what it holds.

    Raises
    ------
    OptionError
        If there are several joints and none is chosen, or not that one.
    TableError
        If a file is missing or damaged.
    """
    exported = export_model(deployed(work, settings), settings)
    target = work / EXPORTS / exported.name
    write_text(target, exported.text)
    return StageResult(target, "\n".join([str(target), *exported.notes]))


def deployed(work: Path, settings: ExportSettings | None = None) -> DeployedModel:
    """Return the model of a joint for use outside the work folder.

    Parameters
    ----------
    work : Path
        Work folder with ``model.json``; for the extended model also the outputs of ``diagnose``.
    settings : ExportSettings, optional
        Joint, criterion of the corrections, and whether the extended model is used.

    Raises
    ------
    OptionError
        If there are several joints and none is chosen, or not that one.
    TableError
        If a file is missing or damaged.
    """
    settings = settings or ExportSettings(to="json")
    source = EXTENDED if settings.extended else MODEL
    model = _chosen(work / source, settings.joint)
    if (work / TORQUES).exists():
        joints = tables.read(work / TORQUES, schemas.TORQUES)["joint"].unique().tolist()
        if model.joint not in joints:
            raise other_joint(work / source, model.joint, joints)
    extension, inputs = None, [work / source]
    if settings.extended:
        extension = _extension(work, model)
        inputs += [work / DIAGNOSIS, work / TORQUES]
    return DeployedModel(
        model=model,
        schedule=ScheduleSettings(criterion=settings.criterion, k=settings.k, tmax=settings.tmax),
        correction_speed=default_correction_speed(model),
        extension=extension,
        origin=input_hashes(inputs),
        version=__version__,
    )


def _chosen(source: Path, joint: int | None) -> FrictionModel:
    """Return the model of the chosen joint, or the only one."""
    models = {
        model.joint: model
        for model in read_models(source, "diagnose" if source.name == EXTENDED else "fit")
    }
    if joint is None and len(models) == 1:
        return next(iter(models.values()))
    if joint not in models:
        known = ", ".join(str(number) for number in sorted(models))
        raise OptionError(
            f"--joint {joint if joint is not None else 'not given'}: {source} has joint(s) {known};"
            " choose one of them"
        )
    return models[joint]


def _extension(work: Path, model: FrictionModel) -> DeployedExtension | None:
    """Return the effects of the extended model that can be deployed."""
    documents = read_documents(work)
    if model.joint not in documents:
        raise TableError(
            f"{work / DIAGNOSIS}: has no joint {model.joint}; run 'frictioncli diagnose' first"
        )
    diagnosis, extended = documents[model.joint]
    interval = None
    for fitted, cause in zip(extended.effects, diagnosis.modelled_causes, strict=False):
        if fitted.effect.name == LAG:
            stated = cause.parameters.get("time_constant")
            interval = stated.ci95 if stated else None
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    return deployable_extension(torques[torques["joint"] == model.joint], extended, interval)
