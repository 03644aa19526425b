"""From samples to pairs: ``pair``."""

from dataclasses import asdict
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.pairs.pair_tables import (
    PairCounts,
    pair_rows,
    pairing_text,
    ramp_rows,
    read_phase_and_payload,
)
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import Joint, find_segments
from frictioncli.pairs.settings import PairingSettings
from frictioncli.provenance import Provenance, input_hashes
from frictioncli.stages.stage import Done, present, stage
from frictioncli.workfiles import PAIRS, RAMPS, RECORDINGS, SAMPLES


@stage
def pair(work: Path, settings: PairingSettings | None = None) -> Done:
    """Match counter-directed constant velocity: ``pairs.parquet``; the rest: ``ramps.parquet``."""
    settings = settings or PairingSettings()
    source = work / SAMPLES
    facts = tables.facts(source)
    provenance = Provenance(
        "pair", asdict(settings), input_hashes(present(source, work / RECORDINGS))
    )
    manifest = read_phase_and_payload(work / RECORDINGS)
    counts = PairCounts()
    with (
        PartitionedStore[Joint](work) as segment_store,
        PartitionedStore[Joint](work) as pair_store,
        tables.TableWriter(work / RAMPS, schemas.RAMPS, provenance) as ramps,
        tables.TableWriter(work / PAIRS, schemas.PAIRS, provenance) as pairs,
    ):
        samples = tables.prefetch(tables.batches(source, schemas.SAMPLES))
        segments = find_segments(samples, settings.steady, settings.bin_width, segment_store)
        pairing = pair_segments(segments, settings, pair_store, manifest["payload"])
        facts |= {
            "samples": segments.samples,
            "dropped": pairing.dropped,
            "bin_width": segments.bin_width,
        }
        ramps.facts = pairs.facts = facts
        for rows in ramp_rows(segments, manifest["payload"]):
            ramps.write(rows)
        for rows in counts.count(pair_rows(segments, pairing, manifest["phase"])):
            pairs.write(rows)
    return Done(work / PAIRS, pairing_text(counts, facts, settings.bin_width))
