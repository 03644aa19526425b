"""Segments, ramps and pairs of samples, as whole tables: for logs that fit into memory."""

import tempfile
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pyarrow as pa

from frictioncli.pairs.pair_tables import pair_rows, ramp_rows, read_phase_and_payload
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import find_segments
from frictioncli.pairs.settings import PairingSettings
from tests.moves import batches

NO_MANIFEST = read_phase_and_payload(Path("no such table"))


@contextmanager
def segments(frame, rows=100_000, settings=None):
    """Yield what is found in samples that come so many rows at a time."""
    settings = settings or PairingSettings()
    with tempfile.TemporaryDirectory() as folder, PartitionedStore(Path(folder)) as store:
        yield find_segments(batches(frame, rows), settings.steady, settings.bin_width, store)


def ramps(frame, rows=100_000):
    """Return the ramps without payloads."""
    with segments(frame, rows) as found:
        tables = list(ramp_rows(found, NO_MANIFEST["payload"]))
    return pa.concat_tables(tables).to_pandas() if tables else pd.DataFrame()


def pairs(frame, rows=100_000, *, payload=None, phase=None, **settings):
    """Return pairs, and what was counted."""
    chosen = PairingSettings(**settings)
    with (
        segments(frame, rows, chosen) as found,
        tempfile.TemporaryDirectory() as folder,
        PartitionedStore(Path(folder)) as store,
    ):
        pairing = pair_segments(found, chosen, store, payload)
        given = NO_MANIFEST["phase"] if phase is None else phase
        tables = list(pair_rows(found, pairing, given))
    return SimpleNamespace(
        pairs=pa.concat_tables(tables).to_pandas(),
        samples=found.samples,
        dropped=pairing.dropped,
        bin_width=found.bin_width,
    )
