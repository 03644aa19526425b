"""The records of ``diagnosis.json``."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import msgspec

from frictioncli import documents
from frictioncli.diagnosis.data.problem import Misfit
from frictioncli.diagnosis.documents.extended_model import ParameterRecord
from frictioncli.diagnosis.settings import DiagnosisSettings

Channel = Annotated[str, msgspec.Meta(pattern="^(friction|load)$")]
"""The part of the torque in which something shows."""


class CauseRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A cause of what the simulated torque misses.

    Attributes
    ----------
    effects : tuple of str
        The credible set: effects that these data cannot tell apart; empty for structure that no
        effect of the catalogue explains.
    probabilities : mapping of str to float
        Probability of each effect. [1]
    channel : {"friction", "load"}
        The part of the torque in which it shows.
    claim, equation : str
        The cause in words and in symbols.
    parameters : mapping of str to ParameterRecord
        Its shape parameters and coefficients.
    size : float
        RMS in these data. [torque unit]
    p_value : float
        Probability that noise alone gives as much, corrected for the number of candidates. [1]
    seen_in : str
        The quantity against which it shows best.
    figure : str or None
        Name of its figure in the report.
    experiment : str
        What to measure next.
    """

    effects: tuple[str, ...]
    probabilities: Mapping[str, float]
    channel: Channel
    claim: str
    equation: str
    parameters: Mapping[str, ParameterRecord]
    size: float
    p_value: float
    seen_in: str
    figure: str | None
    experiment: str


class VisibleRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A cause that stands out of the noise, but does not improve the extended model.

    Attributes
    ----------
    effects : tuple of str
        The credible set.
    size : float
        RMS in these data. [torque unit]
    p_value : float
        Probability that noise alone gives as much. [1]
    """

    effects: tuple[str, ...]
    size: float
    p_value: float


class GainRecord(msgspec.Struct, frozen=True, kw_only=True):
    """How much less the extended model misses the torque.

    Attributes
    ----------
    basis : {"new_run", "within_run"}
        Whether it was measured on a run that the diagnosis has not used.
    rmse_before, rmse_after : float
        RMS misfit of the base model and of the extended model. [torque unit]
    reduction : float
        1 - rmse_after / rmse_before. [1]
    ci95 : (float, float)
        95 % confidence interval of the reduction. [1]
    noise_floor : float
        RMS of the noise, which no model can predict. [torque unit]
    """

    basis: str
    rmse_before: float
    rmse_after: float
    reduction: float
    ci95: tuple[float, float]
    noise_floor: float


class SimulationRecord(msgspec.Struct, frozen=True, kw_only=True):
    """What the simulated torque of the base model misses.

    Attributes
    ----------
    rmse : float
        RMS misfit. [torque unit]
    worst : tuple of Misfit
        Where it misses most.
    """

    rmse: float
    worst: tuple[Misfit, ...] = ()


class RampsRecord(msgspec.Struct, frozen=True, kw_only=True):
    """What the ramps of the moves show.

    Attributes
    ----------
    inertia : ParameterRecord
        Inertia.
    rmse_before, rmse_after : float
        RMS misfit of the ramps without and with inertia and transient. [torque unit]
    log_odds_reversal_transient : float
        Natural logarithm of the odds of a transient after reversals. [1]
    moves : int
        Moves that begin with a reversal.
    """

    inertia: ParameterRecord
    rmse_before: float
    rmse_after: float
    log_odds_reversal_transient: float
    moves: int


class DiagnosisDocument(msgspec.Struct, frozen=True, kw_only=True):
    """One joint of ``diagnosis.json``.

    Attributes
    ----------
    joint : int
        Joint number, from 1.
    verdict : {"no_evidence", "named", "ambiguous", "unnamed"}
        Whether all causes have one name, several, or none.
    causes : tuple of CauseRecord
        The causes, strongest first; structure without a name is the last.
    visible : tuple of VisibleRecord
        Causes that do not improve the extended model.
    gain : GainRecord or None
        How much less the extended model misses; none without causes.
    detectable : mapping of str to (float or None)
        Smallest RMS of each effect that is found four times in five; none where these data cannot
        show it. [torque unit]
    simulation : SimulationRecord
        What the base model misses.
    ramps : RampsRecord or None
        What the ramps show; none where the log has no ramps.
    torque_unit : str
        Unit of torque.
    runs : tuple of str
        Runs that the diagnosis has used.
    held_out : str or None
        The run that was kept for the gain.
    settings : DiagnosisSettings
        Settings of the diagnosis.
    """

    joint: int
    verdict: str
    causes: tuple[CauseRecord, ...]
    visible: tuple[VisibleRecord, ...] = ()
    gain: GainRecord | None
    detectable: Mapping[str, float | None]
    simulation: SimulationRecord
    ramps: RampsRecord | None = None
    torque_unit: str
    runs: tuple[str, ...]
    held_out: str | None
    settings: DiagnosisSettings

    @property
    def named_causes(self) -> tuple[CauseRecord, ...]:
        """The causes that effects of the catalogue explain, in the order of the extended model."""
        return tuple(cause for cause in self.causes if cause.effects)


def read_diagnoses(path: Path) -> dict[int, DiagnosisDocument]:
    """Return the diagnosis of each joint, by number.

    Parameters
    ----------
    path : Path
        ``diagnosis.json``.

    Raises
    ------
    TableError
        If the file is missing or damaged.
    """
    return {one.joint: one for one in documents.read_joints(path, DiagnosisDocument, "diagnose")}
