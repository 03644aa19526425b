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
    *("test_docs", "test_cluster", "test_empirical", "test_diagnose", "test_challenge"),
    *("test_processes", "test_fleet", "test_robustness_disk", "test_synthetic_causes", "test_mdf"),
    *("test_robustness_patterns", "test_plan", "test_gravity", "test_joint", "test_commands"),
    *("test_robustness_kill", "test_robustness_forms", "test_thermal_estimate", "test_page"),
    *("test_suggest_map", "test_page_in_chromium", "test_other_joint"),
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
