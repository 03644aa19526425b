"""The records of ``diagnosis.json``."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import msgspec

from frictioncli import documents
from frictioncli.diagnosis.data.problem import Misfit
from frictioncli.diagnosis.documents.empirical_record import EmpiricalGainRecord
from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.documents.ramps_record import RampsRecord
from frictioncli.diagnosis.documents.remainder_record import Channel, RemainderRecord
from frictioncli.diagnosis.ramps.settling import Settling
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME

Kind = Annotated[str, msgspec.Meta(pattern="^(friction|load|measurement)$")]
"""What a cause is a property of."""

Standing = Annotated[str, msgspec.Meta(pattern="^(named|visible|negligible|undetermined)$")]
"""What may be said of a cause."""

Verdict = Annotated[str, msgspec.Meta(pattern="^(no_evidence|named|ambiguous|unnamed)$")]
"""What a diagnosis says as a whole."""

OTHER_JOINT = "other_joint"
"""Name of the motion of other joints: of the measurement, without a term in the extended model."""

EffectName = Annotated[str, msgspec.Meta(pattern=f"^({'|'.join((*BY_NAME, OTHER_JOINT))})$")]
"""An effect of the catalogue, or the motion of other joints."""


class CauseRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A cause of what the simulated torque misses.

    Files of versions that did not judge standings lack some of the keys; these have defaults.

    Attributes
    ----------
    kind : {"friction", "load", "measurement"} or None
        Whether it is a property of the joint's friction, of its load, or of the log; None for
        structure without a name.
    standing : {"named", "visible", "negligible", "undetermined"}
        What may be said of it: it is named; it stands out of the noise, but is not named; it is
        smaller than the margin; its size is not known well enough.
    holds_on_new_run, only_on_new_run : bool or None, bool
        Whether it is there on the hold-out run: if not, it is a change that did not last; None
        where that cannot be tested. Whether it begins there: then it was found and fitted there.
    reason : str
        Why it is not named; empty where it is.
    effects : tuple of str
        The credible set: effects that these data cannot tell apart; empty for structure that no
        effect of the catalogue explains.
    probabilities : mapping of str to float
        Probability of each effect. [1]
    channel : {"friction", "load"}
        The part of the torque in which it shows.
    statement, claim, equation : str
        The cause in a sentence with values, what is seen of it, and the cause in symbols.
    when : str
        The runs and hours in which it was there; empty where it always is.
    parameters : mapping of str to ParameterRecord
        Its shape parameters and coefficients.
    size : float or None
        RMS in these data; of the motion of other joints, RMS while they move, None where that is
        not known. [torque unit]
    size_ci95 : (float, float) or None
        95 % interval of that. [torque unit]
    visible_size : float or None
        RMS of what the base model leaves of it; its parameters have the rest. [torque unit]
    visible_ci95 : (float, float) or None
        95 % interval of that. [torque unit]
    p_value : float
        Probability that noise alone gives as much, corrected for the number of candidates. [1]
    seen_in : str
        The quantity against which it shows best.
    figure : str or None
        Name of its figure in the report.
    experiment : str
        What to measure next.
    """

    kind: Kind | None = None
    standing: Standing = "named"
    holds_on_new_run: bool | None = None
    only_on_new_run: bool = False
    reason: str = ""
    effects: tuple[EffectName, ...]
    probabilities: Mapping[str, float]
    channel: Channel
    statement: str = ""
    claim: str
    equation: str
    when: str = ""
    parameters: Mapping[str, ParameterRecord]
    size: float | None
    size_ci95: tuple[float, float] | None = None
    visible_size: float | None = None
    visible_ci95: tuple[float, float] | None = None
    p_value: float
    seen_in: str
    figure: str | None
    experiment: str

    @property
    def is_measurement(self) -> bool:
        """Whether it is a property of the log, which the extended model corrects."""
        return self.kind == "measurement"


class StructureRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Structure of the misfit that no effect of the catalogue explains.

    Attributes
    ----------
    axis : tuple of str
        The columns along which it shows: ``position``, ``speed``, ``temperature``, ``time`` or
        ``load``.
    channel : {"friction", "load"}
        The part of the torque in which it shows.
    description : str
        The structure in words.
    formula : str or None
        An equation that describes it, if there is one.
    size : float
        RMS in these data. [torque unit]
    ci95 : (float, float) or None
        95 % interval of that. [torque unit]
    """

    axis: tuple[str, ...]
    channel: Channel
    description: str
    formula: str | None = None
    size: float
    ci95: tuple[float, float] | None = None


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
    rmse_without_level : (float, float) or null
        The two misfits without the mean of each: apart from what is the same over the whole run.
        [torque unit]
    """

    basis: str
    rmse_before: float
    rmse_after: float
    reduction: float
    ci95: tuple[float, float]
    noise_floor: float
    rmse_without_level: tuple[float, float] | None = None


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


class DiagnosisDocument(msgspec.Struct, frozen=True, kw_only=True):
    """One joint of ``diagnosis.json``.

    Attributes
    ----------
    joint : int
        Joint number, from 1.
    verdict : {"no_evidence", "named", "ambiguous", "unnamed"}
        Whether all causes have one name, several, or none.
    causes : tuple of CauseRecord
        The causes that are named, strongest first; structure without a name is the last.
    visible : tuple of CauseRecord
        Everything else that was found and is not named, with the reason.
    structure : StructureRecord or None
        The structure without a name.
    margin : float or None
        Smallest size worth a name; None in files of versions without it. [torque unit]
    load_margin : float or None
        The same of what shows in a load channel of the log; None without one. [load unit]
    gain : GainRecord or None
        How much less the extended model misses; none without causes.
    empirical : EmpiricalGainRecord or None
        What the empirical term of the extended model gains; none where there is no such term.
    discrepancy : EmpiricalGainRecord or None
        The same where the term is no structure, but the smooth error that is expected of any model.
    remainder : RemainderRecord or None
        What the extended model still misses; none where it is hardly more than noise.
    detectable : mapping of str to (float or None)
        Smallest RMS of each effect that is found four times in five; none where these data cannot
        show it. [torque unit; load unit of effects of the load, where the log has a load channel]
    undetectable : mapping of str to str
        Of each effect without such a size the reason; empty in files of versions without it.
    simulation : SimulationRecord
        What the base model misses.
    ramps : RampsRecord or None
        What the ramps show; none where the log has no ramps.
    settling : Settling or None
        Bins that were left out because the logged torque had not settled; none where none were.
    without_temperature : int
        Number of pairs that were left out because the log has no temperature of them.
    stuck_temperature : int
        Number of pairs that were left out because their temperature stood still and then jumped.
    torque_unit : str
        Unit of torque.
    load_unit : str or None
        Unit of what shows in the load, where the log has a load channel of its own; else None.
    runs : tuple of str
        Runs that the diagnosis has used.
    held_out : str or None
        The run that was kept for the gain.
    settings : DiagnosisSettings
        Settings of the diagnosis.
    """

    joint: int
    verdict: Verdict
    causes: tuple[CauseRecord, ...]
    visible: tuple[CauseRecord, ...] = ()
    structure: StructureRecord | None = None
    margin: float | None = None
    load_margin: float | None = None
    gain: GainRecord | None
    empirical: EmpiricalGainRecord | None = None
    discrepancy: EmpiricalGainRecord | None = None
    remainder: RemainderRecord | None = None
    detectable: Mapping[EffectName, float | None]
    undetectable: Mapping[str, str] = {}
    simulation: SimulationRecord
    ramps: RampsRecord | None = None
    settling: Settling | None = None
    without_temperature: int = 0
    stuck_temperature: int = 0
    torque_unit: str
    load_unit: str | None = None
    runs: tuple[str, ...]
    held_out: str | None
    settings: DiagnosisSettings

    @property
    def named_causes(self) -> tuple[CauseRecord, ...]:
        """The causes that have a name, or several that may be meant."""
        return tuple(cause for cause in self.causes if cause.effects)

    @property
    def modelled_causes(self) -> tuple[CauseRecord, ...]:
        """The causes that the extended model has a term for, in the order of its terms."""
        return tuple(cause for cause in self.named_causes if OTHER_JOINT not in cause.effects)

    @property
    def found(self) -> frozenset[str]:
        """The effects that a cause names alone."""
        return frozenset(cause.effects[0] for cause in self.causes if len(cause.effects) == 1)

    def unit_of(self, channel: str) -> str:
        """Return the unit of sizes in a channel.

        Parameters
        ----------
        channel : {"friction", "load"}
            The channel.
        """
        return (self.load_unit if channel == "load" else None) or self.torque_unit


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
