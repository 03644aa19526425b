"""What the log does to the torque of a joint with nothing hidden gives no cause of friction."""

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from tests.diagnosis.clean_joints import clean_days

WORLDS = {
    "nothing": {},
    "a constant that the gear carries": {"constant": 4.0},
    "one sample late": {"delay": 0.012},
    "filtered": {"filtering": 0.04},
    "all three": {"constant": -3.0, "delay": 0.012, "filtering": 0.04},
    "an offset of the sensor": {"offset": 5.0},
    "offset and constant, late": {"offset": -4.0, "constant": 3.0, "delay": 0.012},
}

QUICK = ("one sample late", "all three")


def diagnosed(seed, **world):
    return diagnose_joint(clean_days(seed, **world), "motor", "N·m", DiagnosisSettings())


def measured(diagnosis):
    """Return coefficients of the measurement effects named, with their standard errors."""
    return {
        cause.fit.effect.name: (
            float(cause.fit.coefficients[0]),
            float(np.sqrt(cause.fit.covariance[0, 0])),
        )
        for cause in diagnosis.causes
        if cause.fit.effect.measurement
    }


@pytest.mark.parametrize(
    "name",
    [
        *QUICK,
        *(pytest.param(one, marks=pytest.mark.long) for one in WORLDS if one not in QUICK),
    ],
)
def test_no_cause_of_friction_or_load_is_named(name):
    diagnosis = diagnosed(5, **WORLDS[name])
    named = [cause.effects for cause in diagnosis.causes if not cause.fit.effect.measurement]
    assert named == []
    assert diagnosis.structure is None
    assert diagnosis.verdict in ("no_evidence", "named")


@pytest.mark.long
@pytest.mark.parametrize(("seed", "name"), list(enumerate(WORLDS)))
def test_nor_with_other_noise(name, seed):
    """Sizes of the disturbances drawn anew each time; single runs and two in turns."""
    generator = np.random.default_rng(seed)
    world = {key: value * generator.uniform(0.3, 1.5) for key, value in WORLDS[name].items()}
    days = 1 + seed % 2
    diagnosis = diagnosed(10 + seed, days=days, gravity=(60.0, -40.0), **world)
    assert all(cause.fit.effect.measurement for cause in diagnosis.causes)
    assert diagnosis.structure is None


def test_a_delay_is_measured():
    """60 ms, of which gravity shows v dL/dq: the estimate is the delay."""
    found = measured(diagnosed(6, delay=0.06))
    value, error = found["torque_delay"]
    assert value == pytest.approx(0.06, abs=max(3 * error, 0.002))


@pytest.mark.long
def test_an_offset_of_the_sensor_is_told_from_a_constant_that_the_gear_carries():
    """Friction feels one of them: 5 N·m that load nothing, beside 3 N·m that do."""
    found = measured(diagnosed(7, offset=5.0, constant=3.0))
    value, error = found["load_offset"]
    assert value == pytest.approx(5.0, abs=4 * error)
    assert error < 1.0
    assert "load_offset" not in measured(diagnosed(7, constant=3.0))


def test_what_stands_in_the_log_needs_no_smaller_error_on_a_new_day():
    """The extended model of a late log predicts the second day to 1.25 of its noise.

    Noise in both channels: of a bin, of a pair, and drift, 0.3 of the latter two in the load.
    """
    noise = np.sqrt(2 * 0.3**2 + (0.2**2 + 0.2**2) * (1 + 0.3**2))
    gain = diagnosed(8, delay=0.05, filtering=0.03).gain
    assert gain.basis == "new_run"
    assert gain.after < 1.25 * noise
    assert gain.after < 0.9 * gain.before
