"""A hundred and some damaged logs; ``make fuzz`` tries a hundred thousand."""

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from frictioncli.logs.ingest import IngestSettings, ingest
from tests.studies.fuzz_damage import Case, case
from tests.studies.fuzz_layouts import layouts
from tests.studies.fuzz_process import GOOD, examine_here
from tests.studies.fuzz_truth import contradiction

LAYOUTS = layouts()


@pytest.mark.parametrize("layout", range(len(LAYOUTS)), ids=[layout.name for layout in LAYOUTS])
def test_damaged_logs_are_read_truly_or_refused(layout):
    numbers = range(layout, 4 * len(LAYOUTS), len(LAYOUTS))
    found = [examine_here(number) for number in numbers]
    assert {one.layout for one in found} == {LAYOUTS[layout].name}
    assert [one for one in found if one.outcome not in GOOD] == []


@pytest.mark.parametrize("layout", LAYOUTS, ids=[layout.name for layout in LAYOUTS])
def test_what_is_whole_is_read_and_the_study_sees_when_it_is_not(layout, tmp_path):
    """The judge itself is tried: on whole logs, and on tables that were tampered with."""
    (tmp_path / "run").mkdir()
    for name, content in {**layout.others, layout.log: layout.content()}.items():
        (tmp_path / "run" / name).write_bytes(content)
    chart = tmp_path / "run" / layout.map_file if layout.map_file else None
    ingest(
        [tmp_path / "run"],
        tmp_path / "work",
        IngestSettings(map_file=chart, gear_ratio=layout.gear_ratio),
    )
    rows = len(layout.torque)
    whole = Case(layout, "", {}, touched=0, whole=tuple(range(rows)), lines=rows)
    assert contradiction(whole, tmp_path / "work") == ""
    path = tmp_path / "work" / "samples.parquet"
    samples = pq.read_table(path)
    torque = samples.column("torque").to_numpy().copy()
    torque[7] += 1.0
    at = samples.schema.get_field_index("torque")
    pq.write_table(samples.set_column(at, "torque", pa.array(torque)), path)
    assert "none of the" in contradiction(whole, tmp_path / "work")
    pq.write_table(samples.slice(1), path)
    assert "samples" in contradiction(whole, tmp_path / "work")


def test_a_number_always_makes_the_same_damage():
    one, two = case(4711, LAYOUTS), case(4711, layouts())
    assert (one.damage, one.files) == (two.damage, two.files)
