"""The fitted model of a joint, and ``model.json`` that holds it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Annotated

import msgspec

from frictioncli import documents
from frictioncli.model.friction import FORM, FrictionParameters
from frictioncli.model.noise import Noise
from frictioncli.provenance import Provenance
from frictioncli.wording import count_text, duration_text

TemperatureKind = Annotated[str, msgspec.Meta(pattern="^(motor|housing|mean)$")]
"""Which temperature the friction function is given: motor, housing, or the mean of both."""

PARAMETERS = ("tau_c", "alpha", "beta", "gamma", "delta")
"""Names of the parameters of equation (16), in the order in which they are shown."""

_LARGEST = 1e30
"""No parameter is larger; sums and squares of larger ones would be infinite. [any unit]"""

_LONGEST_DELAY = 1.0
"""No torque is later; ``fit`` finds delays of up to 0.2 s. [s]"""


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
class InputRange:
    """Least and greatest value of each input of the friction function; none where not measured.

    Attributes
    ----------
    speed : (float, float) or None
        Absolute joint velocity. [deg/s]
    load : (float, float) or None
        Load torque. [load unit]
    temperature : (float, float) or None
        Temperature that the friction function is given. [°C]
    position : (float, float) or None
        Joint angle. [deg]
    """

    speed: tuple[float, float] | None = None
    load: tuple[float, float] | None = None
    temperature: tuple[float, float] | None = None
    position: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionModel:
    """Equation (16) with the parameters of one joint, and how good they are.

    Attributes
    ----------
    form, speed_unit : str
        The equation, and the unit of speed in it.
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
        Pairs used; by regression, groups of one speed, temperature and time.
    separated_by : {"pairs", "regression"}
        Where its torques come from.
    noise : Noise
        The noise of the measurements. [torque unit]
    correlation : mapping of str to mapping of str to float
        Correlations of the fitted parameters.
    range : InputRange
        Range of each input in the data.
    notes : tuple of str
        What a user should know before relying on it.
    delay : ParameterEstimate or None
        Mean time by which the logged torque is late; its effect was taken off the friction. None
        where the data do not determine it. [s]
    """

    form: str = FORM
    speed_unit: str = "deg/s"
    joint: int = 1
    method: str = "joint"
    temperature: TemperatureKind
    torque_unit: str
    torque_side: str = "joint"
    sign: int
    parameters: Mapping[str, ParameterEstimate]
    rmse: float
    n_pairs: int
    noise: Noise
    correlation: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    range: InputRange
    notes: tuple[str, ...] = ()
    separated_by: str = "pairs"
    delay: ParameterEstimate | None = None

    def __post_init__(self) -> None:
        missing = [name for name in PARAMETERS if name not in self.parameters]
        if missing:
            raise ValueError(f"parameters: expected {', '.join(missing)} as well")
        unusual = [name for name in PARAMETERS if abs(self.parameters[name].estimate) > _LARGEST]
        if unusual:
            raise ValueError(f"parameters: expected {', '.join(unusual)} below {_LARGEST:g}")
        if not 0 <= self.rmse <= _LARGEST:
            raise ValueError("rmse: expected an error, from 0")
        if self.late_by is not None and not abs(self.late_by) <= _LONGEST_DELAY:
            raise ValueError(f"delay: expected at most {_LONGEST_DELAY:g} s")

    @property
    def friction(self) -> FrictionParameters:
        """The parameters as numbers, for the functions of :mod:`frictioncli.model.friction`."""
        return FrictionParameters(**{name: self.parameters[name].estimate for name in PARAMETERS})

    @property
    def late_by(self) -> float | None:
        """Time [s] by which the torque is late; None where it is not known."""
        return None if self.delay is None else self.delay.estimate

    @property
    def knows_temperature(self) -> bool:
        """Whether the data tell how friction falls with temperature."""
        return self.friction.gamma > 0 and self.friction.delta > 0

    @property
    def row_noun(self) -> str:
        """What one of its observations is called: ``pair``, or ``group`` by regression."""
        return "group" if self.separated_by == "regression" else "pair"

    def table(self) -> str:
        """Return the parameters with units and 95 % intervals, and what is not determined."""
        warm = f" on {self.temperature} temperature" if self.knows_temperature else ""
        lines = [
            f"joint {self.joint}: {FORM}, {self.method} fit{warm}",
            f"  {'parameter':9s} {'estimate':>10s}  {'95 % interval':>22s}  unit",
        ]
        for name, entry in self.parameters.items():
            interval = "" if entry.ci95 is None else f"{entry.ci95[0]:.4g} to {entry.ci95[1]:.4g}"
            line = f"  {name:9s} {entry.estimate:10.4g}  {interval:>22s}  {entry.unit}"
            mark = "" if entry.determined else "not determined: "
            lines.append(line + (f"  ({mark}{entry.reason})" if entry.reason else ""))
        lines.append(
            f"  rmse {self.rmse:.3g} {self.torque_unit} over"
            f" {count_text(self.n_pairs, self.row_noun)}; noise: point {self.noise.point:.2g},"
            f" {self.row_noun} {self.noise.pair:.2g}, drift {self.noise.drift:.2g}"
            f" {self.torque_unit} over {duration_text(self.noise.drift_time)}"
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
    main_joint = max(models, key=lambda model: (model.n_pairs, -model.joint)).joint
    documents.write_joints(path, {model.joint: model for model in models}, main_joint, provenance)


def read_models(path: Path, command: str = "fit") -> list[FrictionModel]:
    """Return the models of ``model.json``, one per joint.

    Parameters
    ----------
    path : Path
        The file.
    command : str
        The command that makes it.

    Raises
    ------
    TableError
        If the file is missing or not of the form that :func:`write_models` gives it.
    """
    return documents.read_joints(path, FrictionModel, command)
