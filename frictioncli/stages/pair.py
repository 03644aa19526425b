"""Segmentation into constant speed, and pairs of opposite direction: ``pair``."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from frictioncli import schemas, tables
from frictioncli.pairs.added_torque import AddedByOthers
from frictioncli.pairs.pair_tables import (
    PairCounts,
    pair_rows,
    pairing_text,
    ramp_rows,
    read_phase_and_payload,
    start_rows,
)
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import Joint, find_segments, without_angle
from frictioncli.pairs.settings import PairingSettings
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.prefetch import prefetch
from frictioncli.stages.stage import StageResult, existing, stage
from frictioncli.workfiles import PAIRS, RAMPS, RECORDINGS, SAMPLES, STARTS


@stage
def pair(work: Path, settings: PairingSettings | None = None) -> StageResult:
    """Match segments of constant speed and opposite direction.

    Writes ``pairs.parquet``, and the other motion: ``ramps.parquet``, and ``starts.parquet`` with
    the samples around some starts of moves.

    Parameters
    ----------
    work : Path
        Work folder with ``samples.parquet``.
    settings : PairingSettings, optional
        What is a segment, and what is a pair.

    Raises
    ------
    NotEnoughData
        If there is no motion at constant speed, or no pair.
    TableError
        If a table is missing or damaged.
    """
    settings = settings or PairingSettings()
    source = work / SAMPLES
    facts = tables.facts(source)
    provenance = Provenance(
        "pair", asdict(settings), input_hashes(existing(source, work / RECORDINGS))
    )
    manifest = read_phase_and_payload(work / RECORDINGS)
    counts = PairCounts()
    with (
        PartitionedStore[Joint](work) as segment_store,
        PartitionedStore[Joint](work) as pair_store,
        tables.TableWriter(work / RAMPS, schemas.RAMPS, provenance) as ramps,
        tables.TableWriter(work / STARTS, schemas.STARTS, provenance) as starts,
        tables.TableWriter(work / PAIRS, schemas.PAIRS, provenance) as pairs,
    ):
        samples = prefetch(tables.batches(source, schemas.SAMPLES))
        if facts.get("position") == "integrated":
            samples = map(without_angle, samples)
        segments = find_segments(samples, settings.steady, settings.bin_width, segment_store)
        pairing = pair_segments(segments, settings, pair_store, manifest["payload"])
        facts |= {
            "samples": segments.samples,
            "dropped": pairing.dropped,
            "bin_width": segments.bin_width,
            "other_joints": {
                str(joint): share
                for joint, share in segments.other_motion.kept(pairing.joints).items()
            },
            "other_motion": {
                str(joint): segments.other_motion.facts(joint) | _added(pairing.added.get(joint))
                for joint in pairing.joints
                if segments.other_motion.share(joint)
            },
        }
        ramps.facts = starts.facts = pairs.facts = facts
        for rows in ramp_rows(segments, manifest["payload"]):
            ramps.write(rows)
        for rows in start_rows(segments, manifest["payload"]):
            starts.write(rows)
        for rows in counts.count(pair_rows(segments, pairing, manifest["phase"])):
            pairs.write(rows)
        facts["in_pairs"] = {
            str(joint): counts.share(joint, segments.moving[joint]) for joint in counts.speeds
        }
    text = pairing_text(counts, facts, segments.other_motion, settings.bin_width)
    return StageResult(work / PAIRS, text)


def _added(found: AddedByOthers | None) -> dict[str, Any]:
    """Return the torque that other joints add, as the tables of pairs state it."""
    size = None if found is None else found.size()
    if size is None:
        return {}
    return {"torque": size.value, "ci95": [size.low, size.high], "p_value": size.p_value}
