"""One fleet, and what one worker makes of it, for all tests."""

import pytest
from threadpoolctl import threadpool_limits

from tests.fleet.fleets import WITHOUT, fleet, write_fleet


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    """Keep linear algebra to one thread, as the workers of a fleet do."""
    with threadpool_limits(1):
        yield


@pytest.fixture(scope="session")
def logs(tmp_path_factory):
    """The logs of the small fleet."""
    return write_fleet(tmp_path_factory.mktemp("fleet") / "logs")


@pytest.fixture(scope="session")
def alone(logs, tmp_path_factory):
    """The small fleet by one worker: its folder, and what the command has said."""
    out = tmp_path_factory.mktemp("alone") / "out"
    result = fleet(logs, "-w", out, "--workers", 1, "--no-report")
    assert result.returncode == 0, result.stderr
    return out, result.stdout


@pytest.fixture(scope="session")
def undiagnosed(logs, tmp_path_factory):
    """The small fleet without diagnoses: its folder, for what does not depend on them."""
    out = tmp_path_factory.mktemp("undiagnosed") / "out"
    result = fleet(logs, "-w", out, "--workers", 1, *WITHOUT)
    assert result.returncode == 0, result.stderr
    return out
