"""Friction that settles within the first minutes of every day, whatever its law."""

import numpy as np
import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.torque_table import simulate_torques


@pytest.mark.long
def test_friction_that_settles_after_a_night_is_no_effect_of_speed():
    """The slowest speeds are measured in the first minutes only, in the paper's programme."""
    torques = simulate_torques(
        SynthesisSettings(seed=3, joint_kind="plain", highest=50, nuisances=("all",))
    )
    settling = np.exp(-torques["time"] / 1100.0)
    seen = torques["run"] == "day1"
    size = 2.5 / np.sqrt(np.mean(np.square(settling[seen])))
    torques["friction_torque"] += size * settling
    found = diagnose_joint(torques, "motor", "N·m", DiagnosisSettings())
    friction = [one for one in found.causes if not one.fit.effect.measurement]
    # running-in, which explains the first day as well, would not be back on the second
    assert [one.effects for one in friction] == [("rest_recovery",)]
    assert found.gain.after < 0.6 * found.gain.before
