"""The text of a suggested mapping file: each line with why and how sure, alternatives beside it."""

from frictioncli.inspection.map_suggestion.guess import Guess
from frictioncli.inspection.map_suggestion.probe import Probe
from frictioncli.inspection.map_suggestion.suggestion import Suggestion
from frictioncli.logs.channels import aliases as names
from frictioncli.plain_text import escaped, printable

_LONGEST = 90


def map_text(suggested: Suggestion, found: Probe, source: str) -> str:
    """Return the mapping file.

    Parameters
    ----------
    suggested : Suggestion
        The guesses.
    found : Probe
        The log they were made from.
    source : str
        The log's name.
    """
    columns = len(found.values) + len(found.constants)
    lines = [
        f"# Suggested from {_comment(source)}: {found.rows} rows, {columns} columns of numbers.",
        "# Check every line, then:",
        "# frictioncli inspect LOGS --map THIS_FILE",
        "",
        "[channels]",
    ]
    for quantity, guess in suggested.guesses.items():
        lines += _channel(quantity, guess, found)
    if names.TORQUE not in suggested.guesses:
        lines.append('# torque = "?"  # no column changes with the direction of motion: name it')
    lines += ["", "[units]"]
    for quantity, guess in suggested.guesses.items():
        doubt = ""
        if quantity == names.TORQUE:
            doubt = "  # by name only, numbers do not tell: N·m, or A if it is a current"
        lines.append(f'{quantity} = "{guess.unit}"{doubt}')
    return "\n".join([*lines, "", "[joint]", f"number = {suggested.joint}", ""])


def _channel(quantity: str, guess: Guess, found: Probe) -> list[str]:
    lines = [
        f"# {guess.sure}: {_comment(guess.why)}",
        f"{quantity} = {_quoted(found.names[guess.column])}",
    ]
    return [
        *lines,
        *(
            f"# {quantity} = {_comment(_quoted(found.names[column]))}  # {_comment(why)}"
            for column, why in guess.others
        ),
    ]


def _quoted(name: str) -> str:
    """Return a column name as a TOML string."""
    plain = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{"".join(escaped(character) for character in plain)}"'


def _comment(text: str) -> str:
    return printable(text, 2 * _LONGEST)
