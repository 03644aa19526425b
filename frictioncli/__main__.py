"""Lets ``python -m frictioncli`` do what ``frictioncli`` does."""

from frictioncli.cli import main

main()
