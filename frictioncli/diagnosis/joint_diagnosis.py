"""The result of the diagnosis of one joint."""

from dataclasses import dataclass

from frictioncli.diagnosis.data.problem import Misfit, Problem
from frictioncli.diagnosis.empirical.estimate import Empirical
from frictioncli.diagnosis.fit.extension import Extension
from frictioncli.diagnosis.fit.gain import Gain
from frictioncli.diagnosis.ramps.evidence import RampEvidence
from frictioncli.diagnosis.ramps.settling import Settling
from frictioncli.diagnosis.ramps.timing_rivals import TimingRivals
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.diagnosis.thermal.estimate import ThermalEstimate
from frictioncli.effects.base import Effect


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """Result of the diagnosis of a joint.

    Attributes
    ----------
    joint : int
        Joint number.
    torque_unit : str
        Unit of everything torque-like.
    verdict : {"no_evidence", "named", "ambiguous", "unnamed"}
        Whether causes were found, and whether each has a single name.
    causes : tuple of Cause
        Causes found, strongest first.
    visible : tuple of Cause
        Causes that are significant but do not improve the prediction enough to be modelled.
    structure : Structure or None
        Structure that no effect of the catalogue explains.
    gain : Gain or None
        Reduction of the misfit by the extension; none where no cause was found.
    corrected : tuple of Cause
        Effects of the measurement that are not named, and that the extension corrects all the same.
    extension : Extension or None
        The base with the causes and what is corrected, refitted.
    predicted : Extension
        The base refitted alone or with what is named, for the rows judged on.
    base : Problem
        The rows without the hold-out run, with the base model about which the extension is linear.
    judged : Problem
        The rows on which the gain is measured: those of the hold-out run where there is one.
    floor : float
        RMS of the noise that is new with each pair, which no model can predict. [N·m]
    search, tried : SearchResult, tuple of Effect
        The last search and the catalogue, for sizes that would have been named.
    margin : float
        Smallest size worth a name. [N·m]
    rmse, worst : float, tuple of Misfit
        RMS misfit of the base model [N·m], and the greatest mean misfits.
    runs, held_out : tuple of str, str or None
        Runs of the diagnosis, and the hold-out run.
    ramps : RampEvidence or None
        Evidence of the ramps of the moves, where the log has them.
    thermal : ThermalEstimate or None
        Temperature of the gear, where a lag of it is a cause.
    timing : TimingRivals or None
        By how much the torque is late, and whether by a delay or a filter.
    load_margin : float or None
        The margin of what shows in a load channel of the log; none without one. [N·m]
    settling : Settling or None
        Bins that were left out because the logged torque had not settled.
    without_temperature : int
        Number of pairs that were left out because the log has no temperature of them.
    stuck_temperature : int
        Number of pairs that were left out because their temperature stood still and then jumped.
    empirical : Empirical or None
        A term for what is left without a known cause; none where it is not worth using.
    """

    joint: int
    torque_unit: str
    verdict: str
    causes: tuple[Cause, ...]
    visible: tuple[Cause, ...]
    structure: Structure | None
    gain: Gain | None
    corrected: tuple[Cause, ...]
    extension: Extension | None
    predicted: Extension
    base: Problem
    judged: Problem
    floor: float
    search: SearchResult
    tried: tuple[Effect, ...]
    margin: float
    rmse: float
    worst: tuple[Misfit, ...]
    runs: tuple[str, ...]
    held_out: str | None
    ramps: RampEvidence | None
    thermal: ThermalEstimate | None = None
    timing: TimingRivals | None = None
    load_margin: float | None = None
    settling: Settling | None = None
    without_temperature: int = 0
    stuck_temperature: int = 0
    empirical: Empirical | None = None
