"""What all tests share: examples of properties, and one run of the chain on the sample logs."""

import shutil
import sys

import pytest
from hypothesis import settings

from tests.sample_run import made_once, make_sample_run, shared_folder

# otherwise the program would leave out the warnings of libraries, which are errors in the tests
sys.warnoptions.append("default::RuntimeWarning")

settings.register_profile("fixed", deadline=None, derandomize=True)
settings.load_profile("fixed")


LONGEST = (
    *("test_docs", "test_cluster", "test_synthetic_causes", "test_changes", "test_processes"),
    *("test_challenge", "test_robustness_kill"),
    *("test_plan", "test_named_causes", "test_fleet", "test_page_in_chromium", "test_commands"),
)
"""Modules that take longest, the longest first."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Put the modules that take longest first, other slow ones next.

    At the end all processes then have something short to do.
    """
    slow = {item.path for item in items if _is_slow(item)}

    def rank(item):
        places = [place for place, name in enumerate(LONGEST) if name in item.nodeid]
        return (item.path not in slow, min(places, default=len(LONGEST)))

    items.sort(key=rank)


def _is_slow(item):
    return any(item.get_closest_marker(name) for name in ("slow", "long"))


@pytest.fixture(scope="session")
def sample_run(tmp_path_factory, worker_id):
    """Return what copies the work folder of the sample logs to a new place."""
    shared = shared_folder(tmp_path_factory.getbasetemp(), worker_id)
    folder = made_once(shared, "sample-run", make_sample_run)
    return lambda place: shutil.copytree(folder, place)
