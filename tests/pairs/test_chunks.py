"""How samples come, in which batches and files, changes nothing in what is found."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frictioncli import schemas, tables
from frictioncli.errors import TableError
from frictioncli.pairs import chunks, matching_groups, moves
from frictioncli.pairs.settings import SteadySettings
from frictioncli.provenance import Provenance
from frictioncli.stages.pair import pair
from frictioncli.stages.prefetch import prefetch
from frictioncli.stages.separate import separate
from frictioncli.workfiles import RAMPS, SAMPLES, TORQUES
from tests import found
from tests.moves import move_sequence, samples


def noisy(seed, period, count=6):
    """Moves between random angles, some back to back, some that hold no speed, with noise."""
    generator = np.random.default_rng(seed)
    turns = np.concatenate([[0.0], generator.uniform(-120, 120, count)])
    speeds = generator.choice([20.0, 60.0, 400.0], count)
    rest = float(generator.choice([0.0, 0.02, 0.3]))
    motion = move_sequence(turns, speeds, period=period, rest=rest)
    motion["velocity"] += generator.normal(0, 0.3, len(motion))
    motion["time"] += 100.0
    return motion


def whole(frame, rows):
    """All that stage pair finds: segments, bins, ramps and counts."""
    with found.segments(frame, rows) as all_tables:
        held = {
            (joint, name): pd.concat(
                [pd.DataFrame(batch) for (batch,) in all_tables.store.read(joint, name)],
                ignore_index=True,
            )
            for joint in sorted(all_tables.counts)
            for name in ("segments", "bins", "ramps")
        }
        return held, (
            all_tables.samples,
            all_tables.dropped,
            all_tables.recordings,
            all_tables.bin_width,
        )


def same(one, other):
    assert one[1] == other[1]
    assert one[0].keys() == other[0].keys()
    for key, table in one[0].items():
        pd.testing.assert_frame_equal(table, other[0][key], check_exact=True)


@pytest.fixture
def small_chunks(monkeypatch):
    """Samples are looked at as soon as they come, so that batches decide where borders are."""
    monkeypatch.setattr(chunks, "_CHUNK_SAMPLES", 1)
    monkeypatch.setattr(chunks, "_PERIOD_SAMPLES", 8)


# the fixture is set once for all examples, as it should be
shared = settings(
    max_examples=20,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@shared
@given(
    rows=st.one_of(st.integers(64, 400), st.integers(400, 4000)),
    seed=st.integers(0, 10**6),
    period=st.sampled_from([0.002, 0.004, 0.012, 0.05]),
)
def test_batches_of_any_size_give_the_same(small_chunks, rows, seed, period):
    frame = samples(noisy(seed, period), friction=8.0)
    same(whole(frame, rows), whole(frame, 10**7))


@pytest.mark.parametrize("rows", [1, 2, 7])
def test_tiny_batches_give_the_same(small_chunks, rows):
    frame = samples(noisy(3, 0.05, count=3), friction=8.0)
    same(whole(frame, rows), whole(frame, 10**7))


@pytest.mark.parametrize("rows", [50, 333])
def test_joints_that_take_turns_give_the_same_as_one_after_the_other(small_chunks, rows):
    motion = noisy(5, 0.012, count=4)
    parts = [samples(motion, friction=5.0 * joint, joint=joint) for joint in (1, 2, 3)]
    turns = pd.concat(parts).sort_values(["time", "joint"], ignore_index=True)
    same(whole(turns, rows), whole(pd.concat(parts, ignore_index=True), 10**7))


def test_a_move_without_end_is_cut_at_the_same_places(small_chunks, monkeypatch):
    monkeypatch.setattr(moves, "LONGEST_MOVE", 700)
    monkeypatch.setattr(chunks, "LONGEST_MOVE", 700)
    frame = samples(move_sequence([0, 900], [20.0]), friction=8.0)
    assert len(frame) > 3500
    held, counts = whole(frame, 210)
    same((held, counts), whole(frame, 10**7))
    assert len(held[("day1", 2), "segments"]) == 6


def test_a_recording_is_the_same_among_others():
    parts = [samples(noisy(seed, 0.012), friction=8.0) for seed in range(4)]
    many = [part.assign(recording=f"log{i}") for i, part in enumerate(parts)]
    together, _ = whole(pd.concat(many, ignore_index=True), 1000)
    segments = together[("day1", 2), "segments"]
    for i, part in enumerate(parts):
        own = whole(part, 10**7)[0][("day1", 2), "segments"]
        here = segments[segments["recording"] == i].assign(recording=0).reset_index(drop=True)
        pd.testing.assert_frame_equal(here, own, check_exact=True)


def test_a_folder_of_files_is_read_as_one_table(tmp_path):
    frame = samples(noisy(1, 0.012), friction=8.0)
    turns = [frame[frame["time"] < 105.0], frame[frame["time"] >= 105.0]]
    for name in ("file", "folder"):
        (tmp_path / name).mkdir()
    (tmp_path / "folder" / SAMPLES).mkdir()
    provenance = Provenance("ingest")
    tables.write(tmp_path / "file" / SAMPLES, frame, schemas.SAMPLES, provenance)
    for i, part in enumerate(turns):
        path = tmp_path / "folder" / SAMPLES / f"part-{i}.parquet"
        tables.write(path, part, schemas.SAMPLES, provenance)
    pairs, ramps = [], []
    for name in ("file", "folder"):
        pair(tmp_path / name)
        separate(tmp_path / name)
        pairs.append(tables.read(tmp_path / name / TORQUES, schemas.TORQUES))
        ramps.append(tables.read(tmp_path / name / RAMPS, schemas.RAMPS))
    pd.testing.assert_frame_equal(*pairs, check_exact=True)
    pd.testing.assert_frame_equal(*ramps, check_exact=True)


def test_groups_between_long_pauses_pair_as_all_segments_do(monkeypatch):
    """Ten bouts of six moves, more than the longest pause apart, in groups of one or two."""
    bouts = [noisy(seed, 0.012) for seed in range(10)]
    for i, bout in enumerate(bouts):
        bout["time"] += 2000.0 * i
    frame = samples(pd.concat(bouts, ignore_index=True), friction=8.0)
    expected = found.pairs(frame)
    monkeypatch.setattr(matching_groups, "MOST_SEGMENTS", 7)
    grouped = found.pairs(frame)
    pd.testing.assert_frame_equal(grouped.pairs, expected.pairs, check_exact=True)
    assert grouped.dropped == expected.dropped


def test_groups_without_a_pause_lose_little(monkeypatch):
    frame = samples(move_sequence([0, 60] * 50, [60.0] * 99), friction=8.0)
    expected = found.pairs(frame)
    monkeypatch.setattr(matching_groups, "MOST_SEGMENTS", 9)
    grouped = found.pairs(frame)
    assert expected.pairs["pair"].nunique() == 49
    assert grouped.pairs["pair"].nunique() >= 36
    kept = int(grouped.pairs["n_forward"].sum() + grouped.pairs["n_reverse"].sum())
    assert kept + sum(grouped.dropped.values()) == grouped.samples == len(frame)


def test_foreign_types_are_converted_and_empty_cells_refused(tmp_path):
    frame = samples(noisy(2, 0.012, count=3), friction=8.0)
    plain = frame.assign(joint=frame["joint"].astype(np.int64))
    plain.to_parquet(tmp_path / "plain.parquet")
    read = list(tables.batches(tmp_path / "plain.parquet", schemas.SAMPLES, 500))
    assert sum(batch.num_rows for batch in read) == len(frame)
    types = {column.name: column.type for column in schemas.SAMPLES.columns}
    assert all(field.type == types[field.name] for field in read[0].schema)
    plain.loc[7, "velocity"] = np.nan
    plain.to_parquet(tmp_path / "plain.parquet")
    with pytest.raises(TableError, match="velocity has 1 empty values"):
        list(tables.batches(tmp_path / "plain.parquet", schemas.SAMPLES, 500))


def test_a_value_that_is_no_number_is_refused():
    frame = samples(noisy(2, 0.012, count=3), friction=8.0)
    for name, value in (("velocity", np.nan), ("torque", np.inf)):
        wrong = frame.assign(**{name: np.where(frame.index == 7, value, frame[name])})
        parts = [
            pa.RecordBatch.from_pydict(
                {key: pa.array(wrong[key].to_numpy(), from_pandas=False) for key in wrong}
            )
        ]
        with pytest.raises(TableError, match=f"{name} has values that are not numbers"):
            list(chunks.chunks(parts, ("position", "torque"), SteadySettings()))


def test_fetching_ahead_keeps_order_and_errors():
    def numbers():
        yield from range(50)
        raise TableError("the fifty-first")

    seen = []
    with pytest.raises(TableError, match="fifty-first"):
        seen.extend(prefetch(numbers()))
    got = prefetch(iter(range(50)))
    assert list(got) == list(range(50))
    assert next(prefetch(iter(range(3)))) == 0
