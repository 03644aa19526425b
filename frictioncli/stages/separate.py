"""Separation of friction and load: ``separate``."""

from dataclasses import asdict
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.pairs.separation import TorqueRanges, separation_text, sign_conventions
from frictioncli.pairs.separation import separate as separate_pairs
from frictioncli.pairs.settings import SeparationSettings
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import StageResult, stage
from frictioncli.workfiles import PAIRS, TORQUES


@stage
def separate(work: Path, settings: SeparationSettings | None = None) -> StageResult:
    """Separate friction torque from load torque by equation (8): ``torques.parquet``.

    Parameters
    ----------
    work : Path
        Work folder with ``pairs.parquet``.
    settings : SeparationSettings, optional
        Sign of friction.

    Raises
    ------
    NotEnoughData
        If runs of a joint contradict each other in the sign of friction.
    TableError
        If a table is missing or damaged.
    """
    settings = settings or SeparationSettings()
    source = work / PAIRS
    facts = tables.facts(source)
    signs = sign_conventions(tables.batches(source, schemas.PAIRS), settings.sign)
    facts["sign"] = {str(joint): value for joint, value in signs.items()}
    provenance = Provenance("separate", asdict(settings), input_hashes([source]))
    ranges = TorqueRanges()
    with tables.TableWriter(work / TORQUES, schemas.TORQUES, provenance) as torques:
        pairs = tables.prefetch(tables.batches(source, schemas.PAIRS))
        for rows in ranges.update(separate_pairs(batch, signs) for batch in pairs):
            torques.write(rows)
        facts |= {"load_unit": "N·m"} if ranges.load_is_measured else {}
        torques.facts = facts
    return StageResult(
        work / TORQUES, separation_text(ranges, signs, facts, given=settings.sign is not None)
    )
