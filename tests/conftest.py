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
    *("test_synthetic_causes", "test_cluster", "test_diagnose", "test_changes", "test_fleet"),
    *("test_processes", "test_mdf", "test_challenge", "test_empirical", "test_gravity"),
    *("test_clean_joints", "test_plan", "test_docs", "test_robustness_disk", "test_step"),
    *("test_robustness_forms", "test_page_in_chromium", "test_commands", "test_robustness_bombs"),
    *("test_robustness_kill",),
)
"""Modules that take longest, the longest first."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Put the modules that take longest first, other slow ones next.

    At the end all processes then have something short to do.
    """
    slow = {item.path for item in items if _is_slow(item)}

    def rank(item):
        name = item.path.stem
        place = LONGEST.index(name) if name in LONGEST else len(LONGEST)
        return (place, item.path not in slow)

    items.sort(key=rank)


def _is_slow(item):
    return any(item.get_closest_marker(name) for name in ("slow", "long"))


@pytest.fixture(scope="session")
def sample_run(tmp_path_factory, worker_id):
    """Return what copies the work folder of the sample logs to a new place."""
    shared = shared_folder(tmp_path_factory.getbasetemp(), worker_id)
    folder = made_once(shared, "sample-run", make_sample_run)
    return lambda place: shutil.copytree(folder, place)
