"""File names of a KUKA trace.

A trace has one file per module: ``<name>_KRCIpo`` of the interpolator holds all axes,
``<name>_NextGenDrive#3`` is of the drive of axis 3. ``<name>_PROG.TXT`` is the program file.
"""

import re

PROGRAM = "_PROG"
_MODULE = re.compile(r"^(?P<trace>.+)_(?:KRCIpo|NextGenDrive#(?P<drive>\d{1,2}))$", re.I)
_PROGRAM = re.compile(rf"^(?P<trace>.+){PROGRAM}$", re.I)


def trace_of(stem: str) -> str:
    """Return the name of the trace that a file belongs to, else the stem itself."""
    found = _MODULE.match(stem) or _PROGRAM.match(stem)
    return found["trace"] if found else stem


def is_module(stem: str) -> bool:
    """Return whether a stem is that of a module, which holds samples."""
    return _MODULE.match(stem) is not None


def is_program(stem: str) -> bool:
    """Return whether a stem is that of a program file."""
    return _PROGRAM.match(stem) is not None


def drive_of(stem: str) -> int | None:
    """Return the axis of the file of a drive; None for the interpolator."""
    found = _MODULE.match(stem)
    return int(found["drive"]) if found and found["drive"] else None
