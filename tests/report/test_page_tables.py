"""Tables of the page."""

from frictioncli.report.page_tables import epsilon_tables


def test_errors_stand_beside_the_number_of_corrections(two_runs):
    first, second, bounded, _ = epsilon_tables(two_runs)
    assert first.title.startswith("day-1: error ε of equation (21) [N·m]")
    assert first.groups == (("", 2), ("heating", 3), ("cooling", 3))
    assert first.rows[0] == ("no correction", "", "4.00 (0)", "", "", "5.00 (0)", "", "")
    marked = first.rows[first.marked[0]]
    assert marked[:5] == ("k = 5", "60", "0.667 (6)", "0.733 (7)", "0.867 (6)")
    assert "(14, 1 failed)" in first.rows[2][2]
    assert second.rows == first.rows
    assert bounded.header == ("bound [N·m]", "uncertainty", "uncertainty")
    assert bounded.rows[2] == ("2", "0.600 (6)", "0.750 (6)")
    assert not bounded.marked
