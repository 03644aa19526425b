"""Text from logs is shown without control characters."""

from frictioncli.plain_text import printable, without_control_characters


def test_printable_is_one_line_and_short():
    assert printable("Achse °C · ü") == "Achse °C · ü"
    assert printable("a\nb\tc\x1b") == r"a\u000ab\u0009c\u001b"
    long = printable("begin" + "x" * 500 + "end", 30)
    assert len(long) == 30
    assert long.startswith("begin")
    assert long.endswith("end")


def test_what_is_harmless_stays():
    text = "joint 2: τ = 5 N·m at 40 °C\n\tβ²; 日本"
    assert without_control_characters(text) == text
