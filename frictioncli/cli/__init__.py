"""The command line: parse, call one library function, print.

Heavy libraries are imported inside the commands, so that ``--help`` answers at once.
"""

import sys

from frictioncli.errors import FrictionError


def main() -> None:
    """Run the command line; a fault of the input ends it with one message and status 2."""
    from frictioncli.cli.commands import app

    try:
        app()
    except FrictionError as fault:
        print(f"frictioncli: {fault}", file=sys.stderr)
        raise SystemExit(2) from None
