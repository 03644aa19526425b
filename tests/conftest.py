"""What all tests share: examples of properties, and one run of the chain on the sample logs."""

import shutil
import sys

import pytest
from hypothesis import settings

from tests.sample_run import made_once

# otherwise the program would leave out the warnings of libraries, which are errors in the tests
sys.warnoptions.append("default::RuntimeWarning")

settings.register_profile("fixed", deadline=None, derandomize=True)
settings.load_profile("fixed")


def pytest_collection_modifyitems(items):
    """Put modules with slow tests first: at the end all processes have something short to do."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


@pytest.fixture(scope="session")
def sample_run(tmp_path_factory, worker_id):
    """Return what copies the work folder of the sample logs to a new place."""
    own = tmp_path_factory.getbasetemp()
    folder = made_once(own if worker_id == "master" else own.parent)
    return lambda place: shutil.copytree(folder, place)
