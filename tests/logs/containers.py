"""The same joint's motion as a CSV log and in containers, for the tests of their readers."""

import numpy as np

from frictioncli import schemas, tables
from frictioncli.logs.ingest import ingest

from .logs import back_and_forth, write

TIME, POSITION, VELOCITY, TORQUE = back_and_forth()
TEMPERATURE = 30 + TIME / 8
COLUMNS = {
    "time [s]": TIME,
    "position_2 [deg]": POSITION,
    "velocity_2 [deg/s]": VELOCITY,
    "torque_2 [Nm]": TORQUE,
    "motor_temperature_2 [°C]": TEMPERATURE,
}
"""Column names in CSV; every container has these five under other names."""

_NUMBERS = ["time", "position", "velocity", "torque", "motor_temperature"]


def samples(log, work):
    """Return the samples of joint 2 that ``ingest`` makes of a log."""
    ingest([log], work)
    table = tables.read(work / "samples.parquet", schemas.SAMPLES)
    assert set(table["joint"]) == {2}
    return table


def assert_same_as_csv(log, folder, columns=COLUMNS):
    """Assert that a log gives the same samples as a CSV of the same values."""
    found = samples(log, folder / "work")
    expected = samples(
        write(folder / "csv" / "log.csv", columns, digits=13), folder / "csv" / "work"
    )
    assert len(found) == len(expected) == len(TIME)
    for name in _NUMBERS:
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-9, err_msg=name)
    # and the CSV the motion that was meant
    np.testing.assert_allclose(found["time"], TIME, atol=1e-9)
    np.testing.assert_allclose(found["position"], POSITION, atol=1e-9)
    np.testing.assert_allclose(found["torque"], TORQUE, atol=1e-9)


def without(columns, *names):
    """Return columns without those whose names begin with one of some texts."""
    return {key: values for key, values in columns.items() if not key.startswith(names)}
