"""Names and numbers as text."""

from frictioncli.report.labels import figure_text, list_text


def test_names_are_drawn_as_they_are():
    assert figure_text("a$b") == r"a\$b"
    assert figure_text("x\x01日") == "x??"
    assert len(figure_text("n" * 500)) == 32


def test_long_lists_are_cut():
    assert list_text(["a"]) == "a"
    assert list_text(list("abcdefg")) == "a, b, c, d, e and 2 more"
