"""How the files of a KUKA trace are called.

A trace writes a file per module: ``<name>_KRCIpo``, the interpolator, holds all axes,
``<name>_NextGenDrive#3`` the drive of axis 3; beside them lies ``<name>_PROG.TXT``.
"""

import re

PROGRAM = "_PROG"
_MODULE = re.compile(r"^(?P<trace>.+)_(?:KRCIpo|NextGenDrive#(?P<drive>\d{1,2}))$", re.I)
_PROGRAM = re.compile(rf"^(?P<trace>.+){PROGRAM}$", re.I)


def trace_of(stem: str) -> str:
    """Return the name of the trace that a file belongs to; its own where it is of no trace."""
    found = _MODULE.match(stem) or _PROGRAM.match(stem)
    return found["trace"] if found else stem


def is_module(stem: str) -> bool:
    """Return whether a file's name is that of a trace's samples."""
    return _MODULE.match(stem) is not None


def is_program(stem: str) -> bool:
    """Return whether a file's name is that of a trace's motion information."""
    return _PROGRAM.match(stem) is not None


def drive_of(stem: str) -> int | None:
    """Return the axis of a drive's file; None for the interpolator's."""
    found = _MODULE.match(stem)
    return int(found["drive"]) if found and found["drive"] else None
