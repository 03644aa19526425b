"""The model outside this program: ``export``."""

from pathlib import Path

from frictioncli import __version__, schemas, tables
from frictioncli.correction.settings import ScheduleSettings
from frictioncli.deployment.deployed_model import DeployedModel, middle_speed
from frictioncli.deployment.export import export as exported
from frictioncli.deployment.extension import LAG, DeployedExtension, carried
from frictioncli.deployment.settings import ExportSettings
from frictioncli.diagnosis.documents.reload import read_documents
from frictioncli.errors import OptionError, TableError
from frictioncli.files import write_text
from frictioncli.model.document import FrictionModel, read_models
from frictioncli.provenance import input_hashes
from frictioncli.stages.stage import Done, stage
from frictioncli.workfiles import DIAGNOSIS, EXTENDED, MODEL, TORQUES

EXPORTS = "export"
"""Folder of the work folder that exported files go to."""


@stage
def export(work: Path, settings: ExportSettings) -> Done:
    """Write a joint's model for a controller, a simulator or a table: ``export/``."""
    found = exported(deployed(work, settings), settings)
    target = work / EXPORTS / found.name
    write_text(target, found.text)
    return Done(target, "\n".join([str(target), *found.said]))


def deployed(work: Path, settings: ExportSettings | None = None) -> DeployedModel:
    """Return a joint of a work folder as it is deployed.

    Parameters
    ----------
    work : Path
        Work folder with ``model.json``; for the extended model with all that ``diagnose`` needs.
    settings : ExportSettings, optional
        Joint, correction rule, and whether the extended model goes along.

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
    extension, used = None, [work / source]
    if settings.extended:
        extension = _extension(work, model)
        used += [work / DIAGNOSIS, work / TORQUES]
    return DeployedModel(
        model=model,
        schedule=ScheduleSettings(criterion=settings.criterion, k=settings.k, tmax=settings.tmax),
        correction_speed=middle_speed(model),
        extension=extension,
        origin=input_hashes(used),
        version=__version__,
    )


def _chosen(source: Path, joint: int | None) -> FrictionModel:
    models = {model.joint: model for model in read_models(source)}
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
    documents = read_documents(work)
    if model.joint not in documents:
        raise TableError(
            f"{work / DIAGNOSIS}: has no joint {model.joint}; run 'frictioncli diagnose' first"
        )
    diagnosis, extended = documents[model.joint]
    interval = None
    for fitted, cause in zip(extended.effects, diagnosis.named_causes, strict=True):
        if fitted.effect.name == LAG:
            stated = cause.parameters.get("time_constant")
            interval = stated.ci95 if stated else None
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    return carried(torques[torques["joint"] == model.joint], extended, interval)
