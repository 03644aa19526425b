"""Text of a suggested mapping file, with reasons, confidence and alternatives in comments."""

import json
from dataclasses import asdict

from frictioncli.inspection.map_suggestion.columns import COUNT, ColumnGuess
from frictioncli.inspection.map_suggestion.log_head import LogHead
from frictioncli.inspection.map_suggestion.suggestion import Suggestion
from frictioncli.inspection.map_suggestion.telling_names import is_counted
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from frictioncli.logs.channels.column_name import split_unit
from frictioncli.logs.log_source import CsvHints
from frictioncli.plain_text import escaped, printable

_PER_COUNT = {
    names.TIME: "seconds per count",
    names.POSITION: "degrees per count, as 360 / counts of a turn",
    names.VELOCITY: "deg/s per count",
    names.TORQUE: "N·m per count, or A with that unit above",
    names.LOAD: "N·m per count",
    names.MOTOR_TEMPERATURE: "°C per count",
    names.HOUSING_TEMPERATURE: "°C per count",
    names.PAYLOAD: "kg per count",
}

_MAX_COMMENT = 180
"""Longest text in a comment. [characters]"""


def map_text(
    suggestion: Suggestion,
    head: LogHead,
    source: str,
    check: str = "",
    hints: CsvHints | None = None,
) -> str:
    """Return the text of the mapping file (TOML).

    Parameters
    ----------
    suggestion : Suggestion
        The suggested columns.
    head : LogHead
        The beginning of the log.
    source : str
        The name of the log.
    check : str, optional
        What came of pairing moves with it.
    hints : CsvHints, optional
        What the user's mapping file says of the form of the text; the suggested one repeats it.
    """
    columns = len(head.values) + len(head.constants)
    lines = [
        f"# Suggested from {_comment(source)}: {head.rows} rows, {columns} columns of numbers.",
        *(f"# {_comment(line)}" for line in check.splitlines()),
        "# Check every line, then:",
        "# frictioncli inspect LOGS --map THIS_FILE",
        "",
        "[channels]",
    ]
    for quantity, guess in suggestion.guesses.items():
        lines += _channel_lines(quantity, guess, head)
    if names.TORQUE not in suggestion.guesses:
        lines.append('# torque = "?"  # no column changes with the direction of motion: name it')
    lines += ["", "[units]"]
    for quantity, guess in suggestion.guesses.items():
        doubt = ""
        if quantity == names.TORQUE and not split_unit(head.names[guess.column])[1]:
            doubt = "  # by name only, the values do not show it: N·m, or A if it is a current"
        unit = guess.unit
        if _counts(guess, head):
            unit = next(iter(units.FACTORS[quantity]))
        lines.append(f'{quantity} = "{unit}"{doubt}')
    counted = [quantity for quantity, guess in suggestion.guesses.items() if _counts(guess, head)]
    if counted:
        lines += ["", "[scale]"]
        lines += [f"{quantity} = 0  # fill in: {_PER_COUNT[quantity]}" for quantity in counted]
    if suggestion.torque_side != names.JOINT_SIDE:
        lines += ["", "[side]", f'torque = "{suggestion.torque_side}"']
    given = {key: value for key, value in asdict(hints or CsvHints()).items() if value is not None}
    if given:
        lines += ["", "[csv]", *(f"{key} = {json.dumps(value)}" for key, value in given.items())]
    lines += ["", "[joint]", f"number = {suggestion.joint}"]
    if suggestion.gear_ratio is not None:
        lines.append(f"gear_ratio = {suggestion.gear_ratio:.6g}")
    return "\n".join([*lines, ""])


def _channel_lines(quantity: str, guess: ColumnGuess, head: LogHead) -> list[str]:
    lines = [
        f"# {guess.confidence}: {_comment(guess.reason)}",
        f"{quantity} = {_quoted(head.names[guess.column])}",
    ]
    return [
        *lines,
        *(
            f"# {quantity} = {_comment(_quoted(head.names[column]))}  # {_comment(reason)}"
            for column, reason in guess.alternatives
        ),
    ]


def _counts(guess: ColumnGuess, head: LogHead) -> bool:
    return guess.unit == COUNT or is_counted(head.names[guess.column])


def _quoted(name: str) -> str:
    """Return a column name as a TOML string."""
    plain = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{"".join(escaped(character) for character in plain)}"'


def _comment(text: str) -> str:
    return printable(text, _MAX_COMMENT)
