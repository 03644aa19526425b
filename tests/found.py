"""Spans, ramps and pairs of samples, as whole tables: for logs that fit into memory."""

import tempfile
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pyarrow as pa

from frictioncli.pairs.manifest_facts import given
from frictioncli.pairs.pair_tables import pair_rows, ramp_rows
from frictioncli.pairs.pairing import pair_segments
from frictioncli.pairs.partitioned_store import PartitionedStore
from frictioncli.pairs.segments import find_segments
from frictioncli.pairs.settings import PairingSettings
from tests.moves import batches

SAID_NOTHING = given(Path("no such table"))


@contextmanager
def spans(frame, rows=100_000, settings=None):
    """Yield what is found in samples that come so many rows at a time."""
    settings = settings or PairingSettings()
    with tempfile.TemporaryDirectory() as folder, PartitionedStore(Path(folder)) as pages:
        yield find_segments(batches(frame, rows), settings.steady, settings.bin_width, pages)


def ramps(frame, rows=100_000):
    """Return the ramps without payloads."""
    with spans(frame, rows) as found:
        tables = list(ramp_rows(found, SAID_NOTHING["payload"]))
    return pa.concat_tables(tables).to_pandas() if tables else pd.DataFrame()


def pairs(frame, rows=100_000, *, payload=None, phase=None, **settings):
    """Return pairs, and what was counted."""
    chosen = PairingSettings(**settings)
    with (
        spans(frame, rows, chosen) as found,
        tempfile.TemporaryDirectory() as folder,
        PartitionedStore(Path(folder)) as pages,
    ):
        pairing = pair_segments(found, chosen, pages, payload)
        said = SAID_NOTHING["phase"] if phase is None else phase
        tables = list(pair_rows(found, pairing, said))
    return SimpleNamespace(
        pairs=pa.concat_tables(tables).to_pandas(),
        samples=found.samples,
        dropped=pairing.dropped,
        bin_width=found.bin_width,
    )
