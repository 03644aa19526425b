"""The parameters of a command, made from the fields of its settings.

A command is a function of settings dataclasses. Typer needs one parameter per option; the fields
of the settings, with their metadata of :mod:`frictioncli.options`, say which.
"""

import functools
import inspect
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, get_args, get_origin

import typer

from frictioncli.options import Option, option_of

Command = Callable[..., None]


def with_options(
    command: Command,
    *,
    without: Collection[str] = (),
    before: Mapping[str, Sequence[str]] | None = None,
) -> Command:
    """Return a command with one parameter per option in place of its settings.

    Parameters
    ----------
    command : callable
        Takes parameters of typer and settings dataclasses, each with an annotation.
    without : collection of str
        Fields that the command has no options for; their defaults hold. A field that holds further
        settings stands for all of theirs.
    before : mapping of str to sequence of str, optional
        Parameter -> those that the help text lists directly before it. The others come in the order
        of the function's parameters and of the fields, required ones first.

    Returns
    -------
    callable
        The command for typer.

    Raises
    ------
    TypeError
        If a field has no option, two parameters have the same name, or ``without`` or ``before``
        names something that is not there.
    """
    declared = inspect.signature(command).parameters.values()
    settings = {one.name: one.annotation for one in declared if is_dataclass(one.annotation)}
    unused = set(without) - {name for kind in settings.values() for name in _names(kind)}
    if unused:
        raise TypeError(f"{command.__name__}: no fields {', '.join(sorted(unused))}")
    flat: list[inspect.Parameter] = []
    for one in declared:
        if one.name in settings:
            flat += _parameters(settings[one.name], without)
        else:
            flat.append(one.replace(kind=inspect.Parameter.KEYWORD_ONLY))
    flat = _moved(flat, before or {})
    flat.sort(key=lambda parameter: parameter.default is not inspect.Parameter.empty)

    @functools.wraps(command)
    def flat_command(**given: Any) -> None:
        made = {name: _settings(kind, given, without) for name, kind in settings.items()}
        command(**{one.name: made.get(one.name, given.get(one.name)) for one in declared})

    flat_command.__signature__ = inspect.Signature(flat)  # type: ignore[attr-defined]
    flat_command.__annotations__ = {}
    return flat_command


def _names(kind: Any) -> Iterator[str]:
    """Yield the names of all fields, those of nested settings too."""
    for field in fields(kind):
        yield field.name
        if is_dataclass(field.type):
            yield from _names(field.type)


def _shown(kind: Any, without: Collection[str]) -> Iterator[tuple[Field[Any], Option | None]]:
    """Yield the fields that a command sets, each with its option; nested settings have none."""
    for field in fields(kind):
        if field.name in without:
            continue
        if is_dataclass(field.type) and not field.metadata:
            yield field, None
        elif (option := option_of(field)) is not None:
            yield field, option


def _parameters(kind: Any, without: Collection[str]) -> Iterator[inspect.Parameter]:
    """Yield one parameter per option of some settings."""
    for field, option in _shown(kind, without):
        if option is None:
            yield from _parameters(field.type, without)
        else:
            yield _parameter(field, option)


def _parameter(field: Field[Any], option: Option) -> inspect.Parameter:
    """Return the parameter of a field, with its type and default on the command line."""
    typed = option.typed or _type_without_none(field.type)
    default = field.default if option.default is None else option.default
    flags = option.flags
    if default is MISSING:
        default = inspect.Parameter.empty
    elif get_origin(typed) is list:  # none given: the field's default
        default = None
    elif typed is bool and default is False:
        flags = flags or (f"--{field.name.replace('_', '-')}",)
    elif option.factor != 1.0:
        default /= option.factor
    if default is None:
        typed = typed | None
    info = typer.Option(*flags, help=option.help, metavar=option.metavar)
    return inspect.Parameter(
        field.name,
        inspect.Parameter.KEYWORD_ONLY,
        default=default,
        annotation=Annotated[typed, info],
    )


def _type_without_none(annotation: Any) -> Any:
    """Return the type that a value of a field is typed as; a list for a tuple."""
    if isinstance(annotation, UnionType):
        (annotation,) = (kind for kind in get_args(annotation) if kind is not NoneType)
    if get_origin(annotation) is tuple:
        return list[get_args(annotation)[0]]  # type: ignore[misc]
    return annotation


def _settings(kind: Any, given: Mapping[str, Any], without: Collection[str]) -> Any:
    """Return settings from the values of the options; where there is none, defaults hold."""
    values: dict[str, Any] = {}
    for field, option in _shown(kind, without):
        if option is None:
            values[field.name] = _settings(field.type, given, without)
        elif (value := given[field.name]) is not None:
            values[field.name] = _converted(value, option)
    return kind(**values)


def _converted(value: Any, option: Option) -> Any:
    """Return the value of a field for what was typed."""
    if option.convert is not None:
        return option.convert(value)
    if option.factor != 1.0:
        return value * option.factor
    return tuple(value) if isinstance(value, list) else value


def _moved(
    parameters: list[inspect.Parameter], before: Mapping[str, Sequence[str]]
) -> list[inspect.Parameter]:
    """Return the parameters with some of them moved to directly before others."""
    named = {parameter.name: parameter for parameter in parameters}
    if len(named) < len(parameters):
        raise TypeError(
            f"two parameters of one name in {', '.join(one.name for one in parameters)}"
        )
    moving = {name for names in before.values() for name in names}
    unknown = (moving | set(before)) - set(named)
    if unknown:
        raise TypeError(f"no parameters {', '.join(sorted(unknown))}")
    ordered: list[inspect.Parameter] = []
    for name, parameter in named.items():
        if name not in moving:
            ordered += [*(named[one] for one in before.get(name, ())), parameter]
    return ordered
