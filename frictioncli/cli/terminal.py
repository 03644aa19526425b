"""What is shown on the terminal: the one place where text from logs is made harmless."""

import io
import re
import sys

import typer

# control characters but tab and line feed, marks that turn the direction of writing, halves of
# characters that stand for bytes of a file name that is no text
_ACTIVE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)


def inert(text: str) -> str:
    """Return text in which nothing can move the cursor, change colours or reorder characters."""
    return _ACTIVE.sub("\N{REPLACEMENT CHARACTER}", text)


def say(what: object, *, fault: bool = False) -> None:
    """Print something, on stderr if it is a fault."""
    stream = sys.stderr if fault else sys.stdout
    if isinstance(stream, io.TextIOWrapper):
        # what the terminal's encoding lacks is written as an escape
        stream.reconfigure(errors="backslashreplace")
    typer.echo(inert(str(what)), err=fault)
