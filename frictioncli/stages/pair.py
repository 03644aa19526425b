"""From samples to pairs: ``pair``."""

from dataclasses import asdict
from pathlib import Path

from frictioncli import schemas, tables
from frictioncli.pairs.manifest_facts import given
from frictioncli.pairs.pair_tables import pair_rows, ramp_rows
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import Joint, find_segments
from frictioncli.pairs.settings import PairingSettings
from frictioncli.pairs.summary import PairTally, pairing_text
from frictioncli.provenance import Provenance, hashes
from frictioncli.stages.stage import Done, present, stage
from frictioncli.workfiles import PAIRS, RAMPS, RECORDINGS, SAMPLES


@stage
def pair(work: Path, settings: PairingSettings | None = None) -> Done:
    """Match counter-directed constant velocity: ``pairs.parquet``; the rest: ``ramps.parquet``."""
    settings = settings or PairingSettings()
    source = work / SAMPLES
    facts = tables.facts(source)
    provenance = Provenance("pair", asdict(settings), hashes(present(source, work / RECORDINGS)))
    said = given(work / RECORDINGS)
    tally = PairTally()
    with (
        PartitionedStore[Joint](work) as moving,
        PartitionedStore[Joint](work) as paired,
        tables.TableWriter(work / RAMPS, schemas.RAMPS, provenance) as ramps,
        tables.TableWriter(work / PAIRS, schemas.PAIRS, provenance) as pairs,
    ):
        samples = tables.ahead(tables.batches(source, schemas.SAMPLES))
        found = find_segments(samples, settings.steady, settings.bin_width, moving)
        pairing = pair_segments(found, settings, paired, said["payload"])
        facts |= {
            "samples": found.samples,
            "dropped": pairing.dropped,
            "bin_width": found.bin_width,
        }
        ramps.facts = pairs.facts = facts
        for rows in ramp_rows(found, said["payload"]):
            ramps.write(rows)
        for rows in tally.counted(pair_rows(found, pairing, said["phase"])):
            pairs.write(rows)
    return Done(work / PAIRS, pairing_text(tally, facts, settings.bin_width))
