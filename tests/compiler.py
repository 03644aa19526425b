"""Whether this machine can build what the package compiles."""

import shutil
import sysconfig
from pathlib import Path


def has_compiler() -> bool:
    """Tell whether there are a C compiler and Python's headers."""
    header = Path(sysconfig.get_path("include")) / "Python.h"
    return shutil.which("cc") is not None and header.exists()
