"""No row disappears: kept and rejected are what stands in the file, in every dialect of text."""

import gzip
import lzma
import random
import tempfile
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.logs.ingest import IngestSettings, ingest
from tests.studies.fuzz_damage import ROW_DAMAGE
from tests.studies.fuzz_layouts import layouts

TEXTS = {
    layout.name: layout
    for layout in layouts()
    # a line of a long table belongs to one joint only; the study counts the lines of each
    if not layout.binary and layout.joints is None
}
UNPACK = {"gzip": gzip.decompress, "xz": lzma.decompress}
ENCODING = {"KUKA A": "cp1252", "KUKA trace, _PROG.TXT": "cp1252", "UTF-16": "utf-16"}
DAMAGE = st.tuples(st.integers(0, 249), st.sampled_from(ROW_DAMAGE), st.integers(0, 1 << 32))


def lines_of(layout, content):
    """Return the lines of a log as an editor would number them."""
    content = UNPACK.get(layout.name, bytes)(content)
    return content.decode(ENCODING.get(layout.name, "utf-8"), "replace").split("\n")


@pytest.mark.parametrize("name", TEXTS)
@settings(max_examples=4)
@given(damages=st.lists(DAMAGE, max_size=10), size=st.sampled_from([600, 1 << 22]))
def test_every_line_is_kept_or_rejected(name, damages, size):
    layout = TEXTS[name]
    rows = list(layout.rows)
    for index, (_, damage), seed in damages:
        # bytes that are no text would be judged by another encoding
        rows[index] = damage(rows[index], random.Random(seed)).decode("ascii", "ignore").encode()
    content = layout.content(rows=rows)
    with tempfile.TemporaryDirectory() as folder:
        run, work = Path(folder, "run"), Path(folder, "work")
        run.mkdir()
        for other, held in {**layout.others, layout.log: content}.items():
            (run / other).write_bytes(held)
        summary = ingest(
            [run],
            work,
            IngestSettings(
                map_file=run / layout.map_file if layout.map_file else None,
                gear_ratio=layout.gear_ratio,
                batch_bytes=size,
            ),
        )
        recordings = tables.read(work / "recordings.parquet", schemas.RECORDINGS)
        samples = tables.read(work / "samples.parquet", schemas.SAMPLES)
        rejected = tables.read(work / "rejected.parquet", schemas.REJECTED)
    lines = lines_of(layout, content)
    filled = sum(bool(line.strip(" \r")) for line in lines[len(layout.head) :])
    assert set(recordings["rows_read"]) == {filled}
    assert set(recordings["rows_kept"] + recordings["rows_rejected"]) == {filled}
    for joint in recordings["joint"]:
        assert (samples["joint"] == joint).sum() == recordings["rows_kept"][0]
    own = rejected[rejected["row"].notna()]
    assert len(own) == recordings["rows_rejected"][0]
    assert own["row"].is_unique
    for row, text in zip(own["row"], own["text"], strict=True):
        assert lines[int(row) - 1].rstrip("\r")[:200] == text
    assert summary.rows_rejected == Counter(own["reason"])
    assert (summary.rows_read, summary.rows_kept) == (filled, filled - len(own))
