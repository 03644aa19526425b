"""Robot programs, one module per language."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from frictioncli.design.programs import krl, table, urscript
from frictioncli.design.programs.robot_program import RobotProgram

FORMS: Mapping[str, Callable[[RobotProgram], dict[str, str]]] = MappingProxyType(
    {"csv": table.program_files, "krl": krl.program_files, "urscript": urscript.program_files}
)
"""Functions that return the text of each file by name, by language."""
