"""The empirical term in documents: as the extended model carries it, and what it gains."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import msgspec

from frictioncli.diagnosis.documents.torque_units import TorqueUnits
from frictioncli.diagnosis.empirical.describe import described, formula_with_numbers
from frictioncli.diagnosis.empirical.estimate import Empirical
from frictioncli.diagnosis.empirical.located import Located
from frictioncli.diagnosis.empirical.term import FADING, EmpiricalTerm
from frictioncli.diagnosis.noise.cosine_series import Range
from frictioncli.model.document import ParameterEstimate

_NOTE = "empirical: what was measured and no known cause explains; not a cause"

_NO_STRUCTURE = "empirical: the smooth error that any model has; neither structure nor a cause"

_EQUATION = (
    "w(x) (sum of forms + sum_k gamma_k prod_j cos(pi k_j u_j) + du/dp b), gamma_k: coefficients of"
    " functions, b: base_changes and gravity_changes;"
    " u from 0 to 1 over the range of a quantity, of the speed over that of its logarithm;"
    " w = 1 - 3 s^2 + 2 s^3 beyond an end of a range, s the distance as a share of fading times the"
    " range, w = 1 within all"
)

_UNITS = {"position": "deg", "speed": "deg/s", "temperature": "°C", "load": "N·m"}


@dataclass(frozen=True, slots=True, kw_only=True)
class EmpiricalRecord(EmpiricalTerm):
    """The empirical term of ``extended-model.json``.

    Attributes
    ----------
    note, equation : str
        What it is, and how it is evaluated.
    torque_unit : str
        Unit of the coefficients.
    units : mapping of str to str
        Units of the ranges.
    fading : float
        Share of a range within which it falls to nothing beyond each end. [1]
    size : float
        Its RMS over the rows that it was estimated from. [torque unit]
    parameters_beside : mapping of str to ParameterEstimate
        Parameters of friction as fitted beside the forms, with intervals: what they are if the
        forms are true. The model is not evaluated with them; empty without forms.
    """

    note: str = _NOTE
    equation: str = _EQUATION
    torque_unit: str
    units: Mapping[str, str]
    fading: float = FADING
    size: float
    parameters_beside: Mapping[str, ParameterEstimate] = field(default_factory=dict)


class LocatedRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A part of the empirical term: where it shows, and how large it is.

    Attributes
    ----------
    axes : tuple of str
        What it depends on: ``position``, ``speed``, ``temperature`` or ``load``.
    channel : {"friction", "load"}
        The torque in which it shows.
    size : float
        RMS of what the base leaves of it. [torque unit]
    ci95 : (float, float)
        95 % interval of that, from five parts of the pairs. [torque unit]
    share : float
        Its mean square relative to that of all parts.
    description : str or None
        What it is in words, where a form describes it.
    formula : str or None
        The formula with numbers: q in deg, v in deg/s, T in °C, L in N·m.
    """

    axes: tuple[str, ...]
    channel: str
    size: float
    ci95: tuple[float, float]
    share: float
    description: str | None = None
    formula: str | None = None


class EmpiricalGainRecord(msgspec.Struct, frozen=True, kw_only=True):
    """What the empirical term of the extended model is worth, beyond base and causes.

    Attributes
    ----------
    size : float
        Its RMS over the rows that it was estimated from. [torque unit]
    size_kept_out : float
        RMS of what it explains on blocks of pairs that were kept out of its estimate. [torque unit]
    basis : {"new_run", "kept_out_blocks"}
        What the following figures are of: a run that was new to all of the extended model, or these
        blocks, which were new to the term alone.
    rmse_before, rmse_after : float
        RMS misfit without and with it. [torque unit]
    reduction : float
        Relative reduction.
    ci95 : (float, float)
        Its 95 % interval.
    noise_floor : float
        RMS of the noise that is new with each pair. [torque unit]
    ranges : mapping of str to (float, float)
        Angle ``position`` [deg], ``speed`` [deg/s], ``temperature`` [°C] and amount of the ``load``
        [N·m] within which it is valid.
    parts : tuple of LocatedRecord
        The forms that describe it, or else its functions; the largest first.
    """

    size: float
    size_kept_out: float
    basis: str
    rmse_before: float
    rmse_after: float
    reduction: float
    ci95: tuple[float, float]
    noise_floor: float
    ranges: Mapping[str, Range]
    parts: tuple[LocatedRecord, ...] = ()

    @property
    def forms(self) -> tuple[LocatedRecord, ...]:
        """The parts that a form describes."""
        return tuple(one for one in self.parts if one.description)


def term_record(
    found: Empirical, torque_unit: str, parameters_beside: Mapping[str, ParameterEstimate]
) -> EmpiricalRecord:
    """Return an empirical term as ``extended-model.json`` has it.

    Parameters
    ----------
    found : Empirical
        The term.
    torque_unit : str
        Unit of torque.
    parameters_beside : mapping of str to ParameterEstimate
        Parameters of friction as fitted beside its forms.
    """
    term = found.term
    return EmpiricalRecord(
        note=_NOTE if found.is_structure else _NO_STRUCTURE,
        forms=term.forms,
        functions=term.functions,
        ranges=term.ranges,
        base_changes=term.base_changes,
        gravity_changes=term.gravity_changes,
        torque_unit=torque_unit,
        units={axis: _UNITS[axis] for axis in term.ranges},
        size=found.size,
        parameters_beside=parameters_beside if term.forms else {},
    )


def gain_record(
    found: Empirical, units: TorqueUnits, *, delay_is_stated: bool
) -> EmpiricalGainRecord:
    """Return what an empirical term gains as ``diagnosis.json`` has it.

    Parameters
    ----------
    found : Empirical
        The term.
    units : TorqueUnits
        Units of torque and of load.
    delay_is_stated : bool
        Whether the delay of the log is stated besides, which is not that of a form.
    """
    gain = found.gain
    return EmpiricalGainRecord(
        size=found.size,
        size_kept_out=found.kept_out,
        basis="new_run" if gain.basis == "new_run" else "kept_out_blocks",
        rmse_before=gain.before,
        rmse_after=gain.after,
        reduction=gain.reduction,
        ci95=gain.interval,
        noise_floor=gain.floor,
        ranges=found.term.ranges,
        parts=tuple(_located_record(one, units, found, delay_is_stated) for one in found.parts),
    )


def _located_record(
    part: Located, units: TorqueUnits, found: Empirical, delay_is_stated: bool
) -> LocatedRecord:
    form, words, largest = part.form, None, found.parts[0]
    if form is not None:
        words = described(
            form,
            *units,
            delay_is_stated=delay_is_stated,
            ranges=found.term.ranges,
            beside=None if part is largest else largest.form,
        )
    return LocatedRecord(
        axes=part.axes,
        channel=part.channel,
        size=part.size,
        ci95=part.interval,
        share=part.share,
        description=words,
        formula=None if form is None else formula_with_numbers(form),
    )
