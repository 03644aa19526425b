"""The command line: parse, call one library function, print.

Heavy libraries are imported inside the commands, so that ``--help`` answers at once.
"""

import gc
import os
import sys
import warnings

from frictioncli.errors import FrictionError


def main() -> None:
    """Run the command line; a fault of the input ends it with one message and status 2."""
    # matrices here are small: more threads cost more than they give, and change last digits
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # pandas imports numexpr, which fails where OMP_NUM_THREADS is a list, as OpenMP allows
    os.environ.setdefault("NUMEXPR_NUM_THREADS", "1")
    _open_closed_streams()
    # nearly all objects live as long as the command: fewer searches for those that do not
    gc.set_threshold(50_000, 20, 100)
    from frictioncli.cli.commands import app
    from frictioncli.cli.terminal import say

    if not sys.warnoptions:
        # a library's remark on damaged input means nothing to the user; `python -W` shows it
        warnings.simplefilter("ignore")
    try:
        app()
    except FrictionError as fault:
        say(f"frictioncli: {fault}", fault=True)
        raise SystemExit(2) from None
    except (MemoryError, RuntimeError) as fault:
        if isinstance(fault, RuntimeError) and "can't start new thread" not in str(fault):
            raise
        say(
            "frictioncli: the memory or the threads that the system allows do not suffice; raise"
            " the limit, or give fewer logs or columns at once",
            fault=True,
        )
        raise SystemExit(2) from None
    except OSError as fault:
        # the system refuses something outside the work folder: a log's name, the temporary folder
        where = f"{fault.filename}: " if fault.filename else ""
        say(f"frictioncli: {where}cannot be used ({fault.strerror or fault})", fault=True)
        raise SystemExit(2) from None


def _open_closed_streams() -> None:
    """Let output that the caller has closed go nowhere, and never into the next opened file."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
