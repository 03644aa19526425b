"""The fitted model of a joint, and ``model.json`` that holds it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from html import escape
from pathlib import Path
from typing import Any

from frictioncli.errors import TableError
from frictioncli.files import write_text
from frictioncli.model.friction import FORM, FrictionParameters
from frictioncli.model.noise import Noise
from frictioncli.provenance import Provenance, to_json

PARAMETERS = ("tau_c", "alpha", "beta", "gamma", "delta")
"""Names of the parameters of equation (16), in the order in which they are shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterEstimate:
    """One parameter as the data tell it.

    Attributes
    ----------
    estimate : float
        Its value; 0 where the term was dropped.
    ci95 : (float, float) or None
        95 % confidence interval; none where it was not fitted.
    unit : str
        Its unit.
    determined : bool
        Whether the data tell it.
    reason : str or None
        Why not, and what was done instead; or what else the value holds.
    """

    estimate: float
    ci95: tuple[float, float] | None
    unit: str
    determined: bool
    reason: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionModel:
    """Equation (16) with the parameters of one joint, and how good they are.

    Attributes
    ----------
    joint : int
        Joint number, from 1.
    method : {"joint", "paper"}
        How it was identified.
    temperature : {"motor", "housing", "mean"}
        The temperature that the friction function is given.
    torque_unit, torque_side : str
        Unit of everything torque-like, and the side of the gear on which it was measured.
    sign : int
        +1 where the log holds load plus friction while moving forward, -1 where the difference.
    parameters : mapping of str to ParameterEstimate
        The five parameters.
    rmse : float
        Root mean square error over all pairs and angle bins. [torque unit]
    n_pairs : int
        Pairs used.
    noise : Noise
        The noise of the measurements. [torque unit]
    correlation : mapping of str to mapping of str to float
        Correlations of the fitted parameters.
    range : mapping of str to (float, float)
        Least and greatest value of each input in the data.
    notes : tuple of str
        What a user should know before relying on it.
    """

    joint: int
    method: str
    temperature: str
    torque_unit: str
    torque_side: str
    sign: int
    parameters: Mapping[str, ParameterEstimate]
    rmse: float
    n_pairs: int
    noise: Noise
    correlation: Mapping[str, Mapping[str, float]]
    range: Mapping[str, tuple[float, float] | None]
    notes: tuple[str, ...] = ()

    @property
    def friction(self) -> FrictionParameters:
        """The parameters as numbers, for the functions of :mod:`frictioncli.model.friction`."""
        return FrictionParameters(**{name: self.parameters[name].estimate for name in PARAMETERS})

    @property
    def knows_temperature(self) -> bool:
        """Whether the data tell how friction falls with temperature."""
        return self.friction.gamma > 0 and self.friction.delta > 0

    def table(self) -> str:
        """Return the parameters with units and 95 % intervals, and what is not determined."""
        lines = [
            f"joint {self.joint}: {FORM}, {self.method} fit on {self.temperature} temperature",
            f"  {'parameter':9s} {'estimate':>10s}  {'95 % interval':>22s}  unit",
        ]
        for name, entry in self.parameters.items():
            interval = "" if entry.ci95 is None else f"{entry.ci95[0]:.4g} to {entry.ci95[1]:.4g}"
            line = f"  {name:9s} {entry.estimate:10.4g}  {interval:>22s}  {entry.unit}"
            mark = "" if entry.determined else "not determined: "
            lines.append(line + (f"  ({mark}{entry.reason})" if entry.reason else ""))
        lines.append(
            f"  rmse {self.rmse:.3g} {self.torque_unit} over {self.n_pairs} pairs; noise: point"
            f" {self.noise.point:.2g}, pair {self.noise.pair:.2g}, drift {self.noise.drift:.2g}"
            f" {self.torque_unit} over {self.noise.drift_time / 60:.0f} min"
        )
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])

    def _repr_html_(self) -> str:
        """Return the parameters as an HTML table, for notebooks."""
        rows = [("parameter", "estimate", "95 % interval", "unit", "")]
        for name, entry in self.parameters.items():
            interval = "" if entry.ci95 is None else f"{entry.ci95[0]:.4g} to {entry.ci95[1]:.4g}"
            rows.append((name, f"{entry.estimate:.4g}", interval, entry.unit, entry.reason or ""))
        cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
        body = "".join(f"<tr>{row}</tr>" for row in cells)
        caption = f"joint {self.joint}: {FORM}; rmse {self.rmse:.3g} {self.torque_unit}"
        return f"<table><caption>{escape(caption)}</caption>{body}</table>"


def write_models(path: Path, models: list[FrictionModel], provenance: Provenance) -> None:
    """Write ``model.json``: the joint with the most pairs on top, all under ``joints`` if several.

    Parameters
    ----------
    path : Path
        The file.
    models : list of FrictionModel
        One per joint.
    provenance : Provenance
        What made them.
    """
    chief = max(models, key=lambda model: (model.n_pairs, -model.joint)).joint
    documents = {model.joint: model_document(model) for model in models}
    write_text(path, to_json(by_joint(documents, chief, provenance)))


def by_joint(
    documents: Mapping[int, dict[str, Any]], chief: int, provenance: Provenance
) -> dict[str, Any]:
    """Return one document for several joints: the chief one on top, all under ``joints``.

    Parameters
    ----------
    documents : mapping of int to dict
        Joint -> its own document.
    chief : int
        The joint whose document stands on top.
    provenance : Provenance
        What made them.
    """
    whole = dict(documents[chief])
    if len(documents) > 1:
        whole["joints"] = {str(joint): documents[joint] for joint in sorted(documents)}
    return whole | {"provenance": provenance.as_dict()}


def read_models(path: Path) -> list[FrictionModel]:
    """Return the models of ``model.json``, one per joint.

    Raises
    ------
    TableError
        If the file is missing or not of the form that :func:`write_models` gives it.
    """
    if not path.exists():
        raise TableError(f"{path} is missing; run 'frictioncli fit' first")
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
        return [_model(part) for part in whole.get("joints", {"": whole}).values()]
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        raise TableError(
            f"{path}: is not a model of this program ({error!r}); run 'frictioncli fit' again"
        ) from error


def model_document(model: FrictionModel) -> dict[str, Any]:
    """Return a model as plain values, in the form of ``model.json``."""
    return {"form": FORM, "speed_unit": "deg/s"} | asdict(model)


def _model(document: Mapping[str, Any]) -> FrictionModel:
    estimates = {}
    for name in PARAMETERS:
        entry = document["parameters"][name]
        interval = entry["ci95"]
        estimates[name] = ParameterEstimate(
            estimate=float(entry["estimate"]),
            ci95=None if interval is None else (float(interval[0]), float(interval[1])),
            unit=entry["unit"],
            determined=bool(entry["determined"]),
            reason=entry.get("reason"),
        )
    return FrictionModel(
        joint=int(document.get("joint", 1)),
        method=document.get("method", "joint"),
        temperature=document["temperature"],
        torque_unit=document["torque_unit"],
        torque_side=document.get("torque_side", "joint"),
        sign=int(document["sign"]),
        parameters=estimates,
        rmse=float(document["rmse"]),
        n_pairs=int(document["n_pairs"]),
        noise=Noise(**document["noise"]),
        correlation=document.get("correlation", {}),
        range={
            name: None if limits is None else (float(limits[0]), float(limits[1]))
            for name, limits in document["range"].items()
        },
        notes=tuple(document.get("notes", ())),
    )
