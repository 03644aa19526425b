"""What goes into pages comes out by key, in order, and nothing stays behind."""

import numpy as np
import pytest

from frictioncli.errors import FrictionError
from frictioncli.pairs import partitioned_store as paged
from frictioncli.pairs.partitioned_store import PartitionedStore


@pytest.mark.parametrize("held", [1, 2000, 1 << 24])
def test_pages_come_back_by_key_in_order(tmp_path, monkeypatch, held):
    monkeypatch.setattr(paged, "_HELD", held)
    generator = np.random.default_rng(0)
    told = {"a": [], "b": []}
    with PartitionedStore(tmp_path) as pages:
        for i in range(30):
            rows = int(generator.integers(0, 5))
            part = {"number": np.arange(rows) + 10 * i, "flag": np.arange(rows) % 2 == 0}
            key = "ab"[i % 2]
            pages.add(key, {"first": part, "second": {"value": np.full(rows, i / 2)}})
            told[key].append((part, np.full(rows, i / 2)))
        assert pages.keys == ["a", "b"]
        for key in "ba":
            found_pages = list(pages.of(key, "first", "second"))
            for name in ("number", "flag"):
                found = np.concatenate([first[name] for first, _ in found_pages])
                np.testing.assert_array_equal(
                    found, np.concatenate([p[name] for p, _ in told[key]])
                )
                assert found.dtype == told[key][0][0][name].dtype
            found = np.concatenate([second["value"] for _, second in found_pages])
            np.testing.assert_array_equal(found, np.concatenate([v for _, v in told[key]]))
        assert any(tmp_path.iterdir())
    assert not any(tmp_path.iterdir())


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "taken").write_text("a file", encoding="utf-8")
    with (
        pytest.raises(FrictionError, match="cannot be written"),
        PartitionedStore(tmp_path / "taken"),
    ):
        pass
