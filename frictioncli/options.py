"""Command-line options of settings.

Settings are frozen dataclasses. The metadata of a field describe its option, so that name, type,
default, unit and help text are stated in one place::

    bin_width: float = field(default=5.0, metadata=option("Width of the angle bins [deg]."))

:mod:`frictioncli.cli.signature` makes the parameters of a command from the fields.
"""

from collections.abc import Callable, Mapping
from dataclasses import Field, dataclass
from typing import Any

from frictioncli.errors import OptionError

_KEY = "option"


@dataclass(frozen=True, slots=True, kw_only=True)
class Option:
    """How a field is written on the command line.

    Attributes
    ----------
    help : str
        Help text, with the unit in brackets.
    flags : tuple of str
        Spellings of the option; ``--field-name`` if empty.
    metavar : str or None
        Placeholder of the value in the help text; that of the type if none.
    typed : type or None
        Type on the command line; that of the field if none.
    default : object
        Default on the command line; that of the field if none.
    factor : float
        Unit on the command line over unit of the field: 60 for minutes and seconds.
    convert : callable or None
        Makes the field's value from what is typed.
    """

    help: str
    flags: tuple[str, ...] = ()
    metavar: str | None = None
    typed: type | None = None
    default: Any = None
    factor: float = 1.0
    convert: Callable[[Any], Any] | None = None


def option(help_text: str, *flags: str, **details: Any) -> Mapping[str, Option]:
    """Return metadata that give a field an option.

    Parameters
    ----------
    help_text : str
        Help text, with the unit in brackets.
    *flags : str
        Spellings of the option; ``--field-name`` if there are none.
    **details
        Other attributes of :class:`Option`.
    """
    return {_KEY: Option(help=help_text, flags=flags, **details)}


NO_OPTION: Mapping[str, None] = {_KEY: None}
"""Metadata of a field that is set from Python only."""


def numbers_option(help_text: str, flag: str, *, factor: float = 1.0) -> Mapping[str, Option]:
    """Return metadata of an option that takes several numbers, repeated or as ``1,2,5``.

    Parameters
    ----------
    help_text : str
        Help text, with the unit in brackets.
    flag : str
        Spelling of the option.
    factor : float
        Unit on the command line over unit of the field.
    """

    def numbers(texts: list[str]) -> tuple[float, ...]:
        parts = [part for text in texts for part in text.replace(",", " ").split()]
        try:
            return tuple(factor * float(part) for part in parts)
        except ValueError:
            raise OptionError(
                f"{flag} {' '.join(texts)}: expected numbers, such as 2,5,10"
            ) from None

    return option(help_text, flag, typed=list[str], convert=numbers)


def option_of(field: Field[Any]) -> Option | None:
    """Return the option of a field; none if it is set from Python only.

    Raises
    ------
    TypeError
        If the field says neither.
    """
    if _KEY not in field.metadata:
        raise TypeError(f"field {field.name} has neither an option nor NO_OPTION")
    found: Option | None = field.metadata[_KEY]
    return found
