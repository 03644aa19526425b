"""What the ramps of the moves show, as ``diagnosis.json`` states it."""

import msgspec

from frictioncli.diagnosis.documents.extended_model import ParameterRecord
from frictioncli.diagnosis.ramps.evidence import RampEvidence
from frictioncli.diagnosis.ramps.settling import Settling


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


class SettlingRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Bins that were left out because the logged torque had not settled.

    Attributes
    ----------
    seconds : float
        Settling time after the first bin of a segment. [s]
    bins, pairs : int
        Bins that were left out, and pairs that have lost all theirs.
    """

    seconds: float
    bins: int
    pairs: int


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


def settling_record(settling: Settling) -> SettlingRecord:
    """Return what was left out as a record.

    Parameters
    ----------
    settling : Settling
        What was left out.
    """
    return SettlingRecord(seconds=settling.seconds, bins=settling.bins, pairs=settling.pairs)
