"""The verdict: nothing that is beyond doubt and above the margin is no evidence."""

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from tests.diagnosis.thermal_joint import Network, torques


def test_what_no_effect_can_be_physically_is_structure_without_a_name():
    """Both torques fall by 0.3 % per °C, and no magnet loses more than 0.2 %."""
    rows, _ = torques(Network(node="motor"))
    for name in ("friction_torque", "load_torque"):
        rows[name] *= 1 - 0.003 * (rows["motor_temperature"] - 30)
    diagnosis = diagnose_joint(rows, "motor", "N·m", DiagnosisSettings())
    assert not diagnosis.causes
    assert diagnosis.verdict == "unnamed"
    assert "temperature" in diagnosis.structure.axes
    (magnet,) = (one for one in diagnosis.visible if one.fit.effect.name == "torque_constant")
    assert magnet.test.p_value < 1e-6
    assert "bound" in magnet.reason
