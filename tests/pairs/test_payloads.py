"""Pairs carry the payload of their recordings, and moves with different payloads make none."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from frictioncli import schemas, tables
from frictioncli.errors import NotEnoughData
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate
from frictioncli.workfiles import PAIRS, RAMPS, TORQUES
from tests.found import pairs as found_pairs
from tests.moves import move_sequence, samples

OTHER = "the partner has another payload"


def moves(turns, names, speed=40.0):
    """One move after the other, each in the recording of its name; friction is 5 N·m."""
    parts = [move_sequence(ends, [speed]) for ends in pairwise(turns)]
    motion = pd.concat(parts, ignore_index=True).assign(time=lambda rows: 0.012 * rows.index)
    recording = np.repeat(np.array(names, dtype=object), [len(part) for part in parts])
    return samples(motion, friction=5.0, recording=recording)


def paired(frame, payloads):
    index = pd.MultiIndex.from_tuples([("day1", name) for name in payloads] or [("", "")])
    return found_pairs(frame, payload=pd.Series(list(payloads.values()) or [np.nan], index))


def test_a_move_passes_by_neighbours_that_carry_something_else():
    frame = moves([0, 170, 0, 170, 0], ["a", "b", "c", "d"])
    result = paired(frame, {"a": 2.0, "b": 4.0, "c": 4.0, "d": 2.0})
    heads = result.pairs.drop_duplicates("pair").set_index("payload")
    # 5.4 s a move: the second and third, then the first and fourth
    assert sorted(heads.index) == [2.0, 4.0]
    end = len(frame) * 0.012
    np.testing.assert_allclose(heads["time"], end / 2, rtol=0.01)
    assert result.dropped[OTHER] == 0


def test_what_only_another_payload_would_match_is_counted():
    frame = moves([0, 170, 0, 170, 60], ["a", "a", "b", "c"])
    same = paired(frame, {"a": 2.0, "b": 2.0, "c": 2.0})
    result = paired(frame, {"a": 2.0, "b": 4.0, "c": 2.0})
    assert result.pairs["payload"].unique().tolist() == [2.0]
    lost = same.pairs[same.pairs["pair"] == 1]
    assert result.dropped[OTHER] == lost["n_forward"].sum() + lost["n_reverse"].sum() > 0
    kept = result.pairs["n_forward"].sum() + result.pairs["n_reverse"].sum()
    assert kept + sum(result.dropped.values()) == result.samples == len(frame)


def test_a_known_payload_and_an_unknown_one_are_no_pair():
    frame = moves([0, 170, 0], ["a", "b"])
    with pytest.raises(NotEnoughData, match=OTHER):
        paired(frame, {"a": 2.0})


def test_moves_of_unknown_payload_are_paired():
    pairs = paired(moves([0, 170, 0], ["a", "b"]), {}).pairs
    assert len(pairs) > 0
    assert pairs["payload"].isna().all()


def write_folder(folder, manifest):
    """Three recordings of moves there and back; gravity is 60 N·m and 10 N·m/kg of 0, 2, 4 kg."""
    folder.mkdir()
    for name, mass in (("a", 0.0), ("b", 2.0), ("c", 4.0)):
        motion = move_sequence([0, 170, 0, 170, 0], [30, 30, 60, 60])
        gravity = (60 + 10 * mass) * np.cos(np.radians(motion["position"]))
        torque = gravity + 8 * np.sign(motion["velocity"])
        frame = pd.DataFrame(
            {
                "Zeit[sec]": motion["time"].round(3),
                "AxisPos_Act2[°]": motion["position"].round(4),
                "GearTorq_Act2[Nm]": torque.round(3),
            }
        )
        frame.to_csv(folder / f"{name}.csv", sep=";", index=False, encoding="cp1252")
    if manifest:
        rows = ["file;started_at;payload", "a.csv;2024-05-17T09:00:00;"]
        rows += ["b.csv;2024-05-17T09:10:00;2,0", "c.csv;2024-05-17T09:20:00;4"]
        (folder / "manifest.csv").write_text("\n".join(rows), encoding="utf-8")


def separated(folder, work):
    ingest([folder], work)
    pair(work)
    separate(work)
    for name, table in ((PAIRS, schemas.PAIRS), (TORQUES, schemas.TORQUES)):
        yield tables.read(work / name, table)


def test_the_manifest_gives_pairs_and_torques_their_payload(tmp_path):
    write_folder(tmp_path / "day1", manifest=True)
    for rows in separated(tmp_path / "day1", tmp_path / "work"):
        heads = rows.drop_duplicates("pair").sort_values("time")
        np.testing.assert_array_equal(heads["payload"], [np.nan, np.nan, 2.0, 2.0, 4.0, 4.0])
    gravity = rows["load_torque"] / np.cos(np.radians(rows["position"]))
    held = rows[(rows["position"] - 90).abs() > 20].index
    per_payload = gravity[held].groupby(rows["payload"].fillna(0.0)).median()
    np.testing.assert_allclose(per_payload, [60, 80, 100], atol=0.3)


def test_pairs_and_ramps_name_the_recordings_that_gave_their_payload(tmp_path):
    write_folder(tmp_path / "day1", manifest=True)
    list(separated(tmp_path / "day1", tmp_path / "work"))
    for name in (PAIRS, RAMPS):
        inputs = tables.metadata(tmp_path / "work" / name)["inputs"]
        assert set(inputs) == {"samples.parquet", "recordings.parquet"}


def test_without_a_manifest_the_payload_is_not_known(tmp_path):
    write_folder(tmp_path / "day1", manifest=False)
    for rows in separated(tmp_path / "day1", tmp_path / "work"):
        assert rows["payload"].isna().all()


def test_a_table_without_the_column_is_read(tmp_path):
    write_folder(tmp_path / "day1", manifest=True)
    _, torques = separated(tmp_path / "day1", tmp_path / "work")
    torques.drop(columns="payload").to_parquet(tmp_path / "old.parquet")
    read = tables.read(tmp_path / "old.parquet", schemas.TORQUES)
    assert read["payload"].isna().all()
    assert list(read.columns) == list(schemas.TORQUES.names)


def test_payloads_of_motions_within_one_recording_keep_them_apart():
    frame = moves([0, 170, 0, 170, 0], ["a"] * 4)
    move = np.repeat([0, 1, 2, 3], len(frame) // 4)
    mass = np.array([2.0, 4.0, 4.0, 2.0])[np.resize(move, len(frame))]
    result = paired(frame.assign(payload=mass), {"a": np.nan})
    assert sorted(result.pairs["payload"].unique()) == [2.0, 4.0]
    assert result.dropped[OTHER] == 0
    one = paired(frame.assign(payload=np.where(move < 1, 2.0, 4.0)), {"a": np.nan})
    assert one.pairs["payload"].unique().tolist() == [4.0]
    assert one.dropped[OTHER] > 0
