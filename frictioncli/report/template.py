"""Pages from templates: self-contained, with their scripts allowed by digest and nothing else."""

from base64 import b64encode
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from importlib.resources import files
from typing import Any

import jinja2
from markupsafe import Markup

from frictioncli.plain_text import without_control_characters
from frictioncli.report.formula import unit_markup


def render(template: str, *, scripts: Sequence[str] = (), **values: Any) -> str:
    """Return a page that holds its styles and scripts and asks for nothing else.

    Parameters
    ----------
    template : str
        Name of the template, which extends ``base.html.jinja``.
    scripts : sequence of str
        Names of the script files.
    **values
        What the template shows; texts are escaped and freed of control characters.
    """
    return (
        _environment()
        .get_template(template)
        .render(css=Markup(_resource("style.css")), scripts=[_script(n) for n in scripts], **values)
    )


def _script(name: str) -> dict[str, str]:
    """Return a script with the digest by which the page allows it."""
    code = _resource(name)
    return {
        "code": Markup(code),
        "digest": b64encode(sha256(code.encode()).digest()).decode(),
    }


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_resource),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        finalize=_cleaned,
    )
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters["unit"] = unit_markup
    return environment


def _resource(name: str) -> str:
    return (files("frictioncli.report") / name).read_text(encoding="utf-8")


def _cleaned(value: Any) -> Any:
    """Replace control characters in a value that the template shows, before it is escaped."""
    if isinstance(value, Markup):
        return Markup(without_control_characters(value))
    return without_control_characters(value) if isinstance(value, str) else value
