"""One fleet, and what one worker makes of it, for all tests."""

import pytest
from threadpoolctl import threadpool_limits

from tests.fleet.fleets import WITHOUT, fleet, write_fleet
from tests.sample_run import made_once, shared_folder


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    """Keep linear algebra to one thread, as the workers of a fleet do."""
    with threadpool_limits(1):
        yield


@pytest.fixture(scope="session")
def shared(tmp_path_factory, worker_id):
    """The folder that all processes of the tests share; tests must not change what is in it."""
    return shared_folder(tmp_path_factory.getbasetemp(), worker_id)


@pytest.fixture(scope="session")
def logs(shared):
    """The logs of the small fleet."""
    return made_once(shared, "fleet-logs", write_fleet)


@pytest.fixture(scope="session")
def alone(logs, shared):
    """The small fleet by one worker: its folder, and what the command has said."""

    def make(out):
        result = fleet(logs, "-w", out, "--workers", 1, "--no-report")
        assert result.returncode == 0, result.stderr
        said.write_text(result.stdout, encoding="utf-8")

    said = shared / "fleet-alone.txt"
    return made_once(shared, "fleet-alone", make), said.read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def undiagnosed(logs, shared):
    """The small fleet without diagnoses: its folder, for what does not depend on them."""

    def make(out):
        result = fleet(logs, "-w", out, "--workers", 1, *WITHOUT)
        assert result.returncode == 0, result.stderr

    return made_once(shared, "fleet-undiagnosed", make)
