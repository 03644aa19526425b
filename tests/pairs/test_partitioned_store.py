"""Rows that are stored are read by key, in order, and no file stays behind."""

import numpy as np
import pytest

from frictioncli.errors import FrictionError
from frictioncli.pairs import partitioned_store
from frictioncli.pairs.partitioned_store import PartitionedStore


@pytest.mark.parametrize("buffer", [1, 2000, 1 << 24])
def test_rows_come_back_by_key_in_order(tmp_path, monkeypatch, buffer):
    monkeypatch.setattr(partitioned_store, "_BUFFER_BYTES", buffer)
    generator = np.random.default_rng(0)
    stored = {"a": [], "b": []}
    with PartitionedStore(tmp_path) as store:
        for i in range(30):
            rows = int(generator.integers(0, 5))
            added = {"number": np.arange(rows) + 10 * i, "flag": np.arange(rows) % 2 == 0}
            key = "ab"[i % 2]
            store.add(key, {"first": added, "second": {"value": np.full(rows, i / 2)}})
            stored[key].append((added, np.full(rows, i / 2)))
        assert store.keys == ["a", "b"]
        for key in "ba":
            batches = list(store.read(key, "first", "second"))
            for name in ("number", "flag"):
                found = np.concatenate([first[name] for first, _ in batches])
                np.testing.assert_array_equal(
                    found, np.concatenate([p[name] for p, _ in stored[key]])
                )
                assert found.dtype == stored[key][0][0][name].dtype
            found = np.concatenate([second["value"] for _, second in batches])
            np.testing.assert_array_equal(found, np.concatenate([v for _, v in stored[key]]))
        assert any(tmp_path.iterdir())
    assert not any(tmp_path.iterdir())


def test_a_folder_that_cannot_be_made_is_reported(tmp_path):
    (tmp_path / "taken").write_text("a file", encoding="utf-8")
    with (
        pytest.raises(FrictionError, match="cannot be written"),
        PartitionedStore(tmp_path / "taken"),
    ):
        pass
