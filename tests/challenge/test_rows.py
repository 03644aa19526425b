"""Rows of earlier calls: which are taken up again."""

import pytest

from frictioncli.challenge.rows import ChallengeTable
from frictioncli.provenance import Provenance
from tests.report.test_challenge_words import row


def table_of(path, *, said="a", claimed="b", torques="c"):
    inputs = {"torques.parquet": torques, "diagnosis.json": claimed}
    return ChallengeTable(
        path=path / "challenge.parquet",
        provenance=Provenance("challenge", {"as_logged": said}, inputs),
        facts={"torque_unit": "A"},
    )


@pytest.mark.parametrize(
    ("changes", "taken_up"),
    [({}, 1), ({"claimed": "other"}, 1), ({"said": "other"}, 0), ({"torques": "other"}, 0)],
)
def test_trials_stay_where_only_the_claims_are_others(tmp_path, changes, taken_up):
    table_of(tmp_path).add(row(message="", size_found_low=0.3))
    again = table_of(tmp_path, **changes)
    assert again.take_up() == taken_up


def test_rows_get_the_claims_of_today_and_what_was_searched_is_known(tmp_path):
    table = table_of(tmp_path)
    table.add(row(message="", size_found_low=0.3))
    table.add(row(message="", effect="inertia"))
    table.set_claimed(1, {"drift": 0.7, "inertia": None})
    assert [one["claimed"] for one in table.rows] == [0.7, None]
    assert table.is_searched(1, "drift", 0)
    assert not table.is_searched(1, "drift", 1)
    assert not table.is_searched(1, "inertia", 0)
