"""The friction that an extended model's effects add to measured rows."""

from dataclasses import asdict, replace

import pandas as pd

from frictioncli.diagnosis.data.build_problem import simulated
from frictioncli.diagnosis.data.gravity_document import stated_gravity
from frictioncli.diagnosis.documents.extended_model import ExtendedModel
from frictioncli.model.document import FrictionModel


def friction_beyond(
    torques: pd.DataFrame, model: FrictionModel, extension: ExtendedModel
) -> tuple[pd.Series, FrictionModel]:
    """Return the friction torque beyond the base in each row, and the base [torque unit].

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    model : FrictionModel
        The extended model's friction.
    extension : ExtendedModel
        The extended model.
    """
    added = pd.Series(0.0, index=torques.index)
    if extension.adds_nothing:
        return added, model
    about = extension.gravity_about
    order, problem = simulated(
        torques,
        extension.temperature,
        extension.about,
        stated_gravity(about),
        form=about.form,
    )
    added.loc[order] = extension.beyond(problem).friction
    started = asdict(extension.about)
    base = {name: replace(model.parameters[name], estimate=at) for name, at in started.items()}
    return added, replace(model, parameters=base)


def without_effects(
    torques: pd.DataFrame, model: FrictionModel, extension: ExtendedModel
) -> tuple[pd.DataFrame, FrictionModel, pd.Series]:
    """Return the rows without friction beyond the base, the base, and that friction per pair."""
    added, base = friction_beyond(torques, model, extension)
    bare = torques.assign(friction_torque=torques["friction_torque"] - added)
    return bare, base, added.groupby([torques["run"], torques["pair"]]).mean()


def with_effects(rows: pd.DataFrame, added: pd.Series) -> pd.DataFrame:
    """Return rows of a schedule with the effects' friction put back; others as they are."""
    if "friction_predicted" not in rows:
        return rows
    back = added.reindex(pd.MultiIndex.from_frame(rows[["run", "pair"]])).to_numpy()
    names = ("friction_torque", "friction_smoothed", "friction_predicted")
    return rows.assign(**{name: rows[name] + back for name in names})
