"""Text from logs made safe to show: control characters replaced or escaped.

Names of files, runs and columns come from files that anyone may have written. An escape sequence
in one of them could rewrite the screen, and a direction mark could reverse a line.
"""

import re

# control characters except tab and line feed, direction marks, and surrogates, which stand for
# undecodable bytes of a file name and which no encoding can write
_CONTROL = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)

_LONGEST = 80


def without_control_characters(text: str) -> str:
    """Return a text with control characters and direction marks replaced by U+FFFD.

    Tabs and line feeds stay.

    Parameters
    ----------
    text : str
        Any text.

    Examples
    --------
    >>> without_control_characters("joint 2")
    'joint 2'
    >>> without_control_characters("a" + chr(27) + "[2Jb") == "a" + chr(0xFFFD) + "[2Jb"
    True
    """
    return _CONTROL.sub("\N{REPLACEMENT CHARACTER}", text)


def printable(text: str, longest: int = _LONGEST) -> str:
    r"""Return a text as one line, with escapes for what cannot be printed, shortened in its middle.

    Line feeds are escaped as well, since they could imitate a line of their own.

    Parameters
    ----------
    text : str
        Any text.
    longest : int
        Greatest number of characters of the result.

    Examples
    --------
    >>> print(printable("two" + chr(10) + "lines"))
    two\u000alines
    >>> printable("begin, then much more, end", 13)
    'begin..., end'
    """
    if len(text) > 2 * longest:
        text = text[:longest] + text[-longest:]
    line = "".join(escaped(character) for character in text)
    if len(line) <= longest:
        return line
    half = (longest - 3) // 2
    return f"{line[: longest - 3 - half]}...{line[-half:]}"


def whole_number(text: str) -> int | None:
    """Return the whole number that a text of at most 18 ASCII digits stands for, else None.

    Parameters
    ----------
    text : str
        Any text; ``int`` takes other digits too, and fails where there are thousands.

    Examples
    --------
    >>> whole_number("12"), whole_number("1.5"), whole_number("9" * 5000)
    (12, None, None)
    """
    return int(text) if text.isascii() and text.isdecimal() and len(text) <= 18 else None


def escaped(character: str) -> str:
    r"""Return a character as it is, or as ``\uXXXX`` if it cannot be printed.

    Parameters
    ----------
    character : str
        A single character.
    """
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
