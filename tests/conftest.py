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
"""Tests and modules that take longest, the longest first."""

OWN = {"tmp_path_factory", "worker_id", "testrun_uid", "one_thread", "doctest_namespace"}
"""Fixtures of a session that cost nothing to make again."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Say which tests stay in one process, and put the longest first, slow modules next.

    Tests stay together that share a fixture of their module or of the session, since each process
    makes it anew; slow ones that share nothing go where there is room. At the end all processes
    have something short to do.
    """
    slow = {item.path for item in items if _is_slow(item)}

    def rank(item):
        places = [place for place, name in enumerate(LONGEST) if name in item.nodeid]
        return (item.path not in slow, min(places, default=len(LONGEST)))

    items.sort(key=rank)
    for item in items:
        alone = _is_slow(item) and not _shared(item)
        together = item.path.parent if "chromium" in item.fixturenames else item.path
        item.add_marker(pytest.mark.xdist_group(item.nodeid if alone else str(together)))


def _is_slow(item):
    return any(item.get_closest_marker(name) for name in ("slow", "long"))


def _shared(item):
    """Return the fixtures of a test that others have with it."""
    definitions = item._fixtureinfo.name2fixturedefs
    return {
        name
        for name, found in definitions.items()
        if name not in OWN and found[-1].scope in ("module", "session") and found[-1].baseid
    }


@pytest.fixture(scope="session")
def sample_run(tmp_path_factory, worker_id):
    """Return what copies the work folder of the sample logs to a new place."""
    shared = shared_folder(tmp_path_factory.getbasetemp(), worker_id)
    folder = made_once(shared, "sample-run", make_sample_run)
    return lambda place: shutil.copytree(folder, place)
