"""Plans that are found sooner, for tests of what every plan has to keep."""

from contextlib import contextmanager
from unittest.mock import patch

from frictioncli.design import plan, selection


@contextmanager
def few_programmes():
    """Compare fewer programmes than for users while the block runs.

    What a plan has to keep does not depend on how many there were to choose from;
    test_selection.py has the choice.
    """
    with (
        patch.object(selection, "_STARTS", 8),
        patch.object(selection, "_EXCHANGES", 16),
        patch.object(plan, "_CHECK_EXCHANGES", 6),
    ):
        yield
