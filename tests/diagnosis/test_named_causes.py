"""Every cause that is named keeps the rules of a name, whatever joint and log do."""

import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.rules_of_names import keeps_the_rules
from tests.simulation.torque_table import simulate_torques

HIDDEN = {
    "nothing": (),
    "Stribeck friction": ("stribeck:2.1",),
    "a changed torque constant": ("torque_constant:2.4",),
    "drift": ("drift:4",),
}
"""Effects hidden beside all nuisances; test_synthetic_causes.py has joints without nuisances."""

QUICK = ("nothing",)
LONG = ("Stribeck friction", "a changed torque constant", "drift")


def diagnosed_under_nuisances(effects, seed):
    settings = SynthesisSettings(
        seed=seed, joint_kind="plain", effects=effects, nuisances=("all",), highest=45
    )
    return diagnose_joint(simulate_torques(settings), "motor", "N·m", DiagnosisSettings())


@pytest.mark.parametrize(
    "name",
    [
        *QUICK,
        *(
            pytest.param(one, marks=pytest.mark.long if one in LONG else pytest.mark.slow)
            for one in HIDDEN
            if one not in QUICK
        ),
    ],
)
def test_causes_named_keep_the_rules(name):
    keeps_the_rules(diagnosed_under_nuisances(HIDDEN[name], 31))


@pytest.mark.long
@pytest.mark.parametrize("name", ["a changed torque constant"])
def test_causes_named_on_another_joint_keep_the_rules(name):
    keeps_the_rules(diagnosed_under_nuisances(HIDDEN[name], 32))
