"""The friction that an extended model's effects add to measured rows."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from frictioncli.diagnosis.problem import simulated
from frictioncli.effects import BY_NAME
from frictioncli.errors import TableError
from frictioncli.model.document import PARAMETERS, FrictionModel
from frictioncli.model.friction import FrictionParameters


def read_extensions(path: Path) -> dict[int, dict[str, Any]]:
    """Return per joint what ``extended-model.json`` has beyond the base model.

    Raises
    ------
    TableError
        If the file is missing, damaged, or names an effect that the catalogue does not have.
    """
    if not path.exists():
        raise TableError(f"{path} is missing; run 'frictioncli diagnose' first")
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
        found = {int(part["joint"]): part for part in whole.get("joints", {"": whole}).values()}
        unknown = {e["name"] for part in found.values() for e in part["effects"]} - set(BY_NAME)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise TableError(
            f"{path}: is not an extended model ({error!r}); run 'frictioncli diagnose' again"
        ) from error
    if unknown:
        raise TableError(f"{path}: unknown effects {', '.join(sorted(unknown))}")
    return found


def friction_beyond(
    torques: pd.DataFrame, model: FrictionModel, extension: dict[str, Any]
) -> tuple[pd.Series, FrictionModel]:
    """Return the friction torque beyond the base in each row, and the base. [torque unit].

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of a single joint.
    model : FrictionModel
        The extended model's friction.
    extension : dict
        Its effects and the base about which it is linear, from :func:`read_extensions`.
    """
    added = pd.Series(0.0, index=torques.index)
    if not extension["effects"]:
        return added, model
    about = extension["linear_about"]
    gravity = np.array([extension["gravity_about"][name] for name in ("cosine", "sine", "offset")])
    order, problem = simulated(torques, model.temperature, FrictionParameters(**about), gravity)
    changes = [getattr(model.friction, name) - about[name] for name in PARAMETERS]
    friction = problem.friction_base @ np.array(changes)
    for entry in extension["effects"]:
        effect = BY_NAME[entry["name"]]
        coefficients = [
            entry["coefficients"][parameter.name]["estimate"] for parameter in effect.coefficients
        ]
        friction = friction + problem.basis(effect, entry["shape"]).friction @ coefficients
    added.loc[order] = friction
    base = {name: replace(model.parameters[name], estimate=value) for name, value in about.items()}
    return added, replace(model, parameters=base)


def without_effects(
    torques: pd.DataFrame, model: FrictionModel, extension: dict[str, Any]
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
