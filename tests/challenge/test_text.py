"""The table on the terminal, from rows made by hand."""

from frictioncli.challenge.text import challenge_text
from tests.report.test_challenge_words import FOUND, row


def test_structure_without_a_name_is_told_beside_names():
    """Otherwise a verdict ``unnamed`` stands beside a name, and nobody knows why."""
    logged = row(purpose="as_logged", verdict="no_evidence", effect="")
    found = row(**FOUND, verdict="unnamed", structure="position, friction")
    lines = challenge_text([logged, found]).splitlines()
    assert "drift; structure along position, friction" in lines[2]
