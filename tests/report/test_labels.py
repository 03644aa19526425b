"""Names as figures show them."""

from frictioncli.report.labels import figure_text


def test_names_are_drawn_as_they_are():
    assert figure_text("a$b") == r"a\$b"
    assert figure_text("x\x01日") == "x??"
    assert len(figure_text("n" * 500)) == 32
