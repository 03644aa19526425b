"""Text from logs in one line, without what a terminal would act upon."""

_LONGEST = 80


def printable(text: str, longest: int = _LONGEST) -> str:
    """Return a text in one line, escapes instead of control characters, shortened in its middle.

    Column names come from files that anyone may have written: an escape sequence could rewrite the
    screen, a mark of direction turn a line round, a line feed fake a line of its own.

    Parameters
    ----------
    text : str
        Anything.
    longest : int
        Characters that may remain.
    """
    if len(text) > 2 * longest:
        text = text[:longest] + text[-longest:]
    plain = "".join(escaped(character) for character in text)
    if len(plain) <= longest:
        return plain
    half = (longest - 3) // 2
    return f"{plain[: longest - 3 - half]}...{plain[-half:]}"


def escaped(character: str) -> str:
    r"""Return a character as it is, or as ``\uXXXX`` where it is no printable one."""
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
