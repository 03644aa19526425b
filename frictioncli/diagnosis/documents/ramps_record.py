"""What the ramps of the moves show, as ``diagnosis.json`` states it."""

import msgspec

from frictioncli.diagnosis.documents.extended_document import ParameterRecord
from frictioncli.diagnosis.ramps.evidence import RampEvidence


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


def ramps_record(ramps: RampEvidence, torque_unit: str) -> RampsRecord:
    """Return what the ramps show as a record.

    Parameters
    ----------
    ramps : RampEvidence
        The evidence.
    torque_unit : str
        Unit of torque.
    """
    return RampsRecord(
        inertia=ParameterRecord(
            estimate=ramps.inertia.value,
            ci95=(ramps.inertia.low, ramps.inertia.high),
            unit=f"{torque_unit}/(deg/s²)",
        ),
        rmse_before=ramps.rms_before,
        rmse_after=ramps.rms_after,
        log_odds_reversal_transient=ramps.log_odds,
        moves=ramps.moves,
    )
