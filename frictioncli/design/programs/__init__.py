"""Robot programs of a programme, one form per file."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from frictioncli.design.programs import krl, table, urscript
from frictioncli.design.programs.programme import Programme

FORMS: Mapping[str, Callable[[Programme], dict[str, str]]] = MappingProxyType(
    {"csv": table.written, "krl": krl.written, "urscript": urscript.written}
)
"""Form -> function that gives the text of each file by its name."""
