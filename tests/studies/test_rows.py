"""The kept rows of a study: what counts as done, and what does not."""

import pytest

from tests.studies import bench, blind_worlds, fuzz, planning_worlds, wear
from tests.studies.bench_rounds import state
from tests.studies.rows import Rows, sources_digest


@pytest.fixture
def rows(tmp_path):
    return Rows(tmp_path / "build" / "study.csv", ("world", "seed", "sources", "said"), ("world",))


def add(rows, *found):
    with rows.adding() as keep:
        for world, sources, said in found:
            keep({"world": world, "seed": 0, "sources": sources, "said": said})


def test_nothing_is_done_at_first(rows):
    assert rows.read("new", keep=True).empty
    assert rows.done("new", keep=True) == set()


def break_off(rows):
    with rows.adding() as keep:
        keep({"world": "a", "seed": 0, "sources": "new", "said": "yes"})
        raise KeyboardInterrupt


def test_rows_are_there_though_the_study_breaks_off(rows):
    with pytest.raises(KeyboardInterrupt):
        break_off(rows)
    add(rows, ("b", "new", "no"))
    assert rows.done("new", keep=False) == {("a",), ("b",)}


def test_rows_of_other_sources_count_only_if_kept_and_where_there_are_no_newer(rows):
    add(rows, ("a", "new", "1"), ("a", "new", "2"), ("a", "old", "3"), ("b", "old", "4"))
    assert list(rows.read("new", keep=False)["said"]) == ["2"]
    kept = rows.read("new", keep=True).set_index("world")["said"]
    assert dict(kept) == {"a": "2", "b": "4"}


def test_rows_of_an_earlier_study_keep_what_they_have(rows, tmp_path):
    add(rows, ("a", "new", "1,5; 2"))
    wider = Rows(rows.path, ("world", "said", "more", "sources"), ("world",))
    with wider.adding() as keep:
        keep({"world": "b", "said": "3", "more": "m", "sources": "new"})
    found = wider.read("new", keep=False)
    assert list(found["said"]) == ["1,5; 2", "3"]
    assert list(found["more"]) == ["", "m"]


def test_the_sources_of_every_study_exist():
    """Digests of folders and files that were renamed raise, instead of missing changes."""
    assert blind_worlds.sources() != planning_worlds.sources()
    assert len(wear.sources()) == 12
    assert fuzz.sources("logs") != fuzz.sources("options")
    for work in bench.works(small=False):
        assert state(*work.sources)


def test_a_missing_source_would_be_seen():
    with pytest.raises(FileNotFoundError):
        sources_digest("frictioncli/no_such_folder")
