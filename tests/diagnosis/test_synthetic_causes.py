"""Effects that the simulator hides are found by name; nothing is found where nothing is hidden.

The simulator's formulas are its own: other functional details than the catalogue's, parameters
drawn at random. Each case is one seed, two days by the paper's programme or the enriched one; the
last day is kept out. Sizes are RMS torque over both days, such that the base model leaves about
0.9 N·m, 2 % of the friction. docs/blind.md has the same at size, with everything else that joints
and logs do.
"""

import functools

import pytest

from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, EFFECTS
from frictioncli.simulator.settings import SynthesisSettings
from tests.diagnosis.rules_of_names import keeps_the_rules
from tests.simulation.torque_table import simulate_torques

SIZES = {
    "stribeck": 2.1,
    "velocity_exponent": 7.8,
    "linear_viscous": 9.5,
    "quadratic_drag": 4.1,
    "coulomb_temperature": 3.4,
    "load_linear": 8.2,
    "load_velocity": 4.2,
    "load_temperature": 1.4,
    "thermal_lag": 1.2,
    "drift": 2.8,
    "rest_recovery": 1.2,
    "step_change": 2.4,
    "direction_asymmetry": 1.9,
    "torque_constant": 2.4,
    "payload_change": 2.4,
    "dress_pack": 5.7,
    "inertia": 2.3,
    "reversal_transient": 4.9,
}
"""RMS of what is hidden where it is not 1 N·m. [N·m]"""

SMOOTH = (
    "velocity_exponent",
    "linear_viscous",
    "quadratic_drag",
    "coulomb_temperature",
    "load_linear",
    "run_in",
    "dress_pack",
)
"""Effects that at four speeds, or along one stroke, look like a smooth error of 2 % of the base:
what is said of them must be right, and it may be that nothing is."""

HIGHEST = 45
"""Motor temperature to which the joint is warmed: half the pairs of the paper. [°C]"""

DAYS = {"drift": 3, "run_in": 3}
"""Days simulated where it is not two: one run alone cannot tell a slow change from slow noise."""

SEEDS = {"payload_change": 72}
"""71, or the next one with which the change falls on the first day, which alone is seen."""


BESIDE_A_LAG = ("torque_constant", "payload_change", "position_ripple")
"""One effect of each channel, and one of the stroke; docs/blind.md has them all."""


ELSEWHERE = ("step_change", "payload_change")
"""Effects that test_changes.py finds with size and history; the second stands beside a lag here."""

QUICK = ("stribeck", "position_ripple")
"""One effect that goes with speed, and one of the stroke; a lag stands beside another below."""


@functools.cache
def diagnosed(
    effects: tuple[str, ...],
    seed: int,
    protocol: str = "paper",
    noise: str = "default",
    days: int = 2,
) -> Diagnosis:
    """Simulate days, hide effects in them, and diagnose them blind; names keep their rules."""
    settings = SynthesisSettings(
        seed=seed,
        joint_kind="plain",
        protocol=protocol,
        noise_kind=noise,
        effects=effects,
        runs=days,
        highest=HIGHEST,
    )
    diagnosis = diagnose_joint(simulate_torques(settings), "motor", "N·m", DiagnosisSettings())
    keeps_the_rules(diagnosis)
    return diagnosis


def hidden(name: str) -> tuple[str, int]:
    return f"{name}:{SIZES.get(name, 1.0):g}", SEEDS.get(name, 71)


def sets(diagnosis: Diagnosis) -> list[tuple[str, ...]]:
    """Return the credible sets of the properties of the joint that are named."""
    return [cause.effects for cause in diagnosis.causes if not cause.fit.effect.measurement]


@pytest.mark.parametrize(
    "name",
    [
        effect.name if effect.name in QUICK else pytest.param(effect.name, marks=pytest.mark.long)
        for effect in EFFECTS
        if effect.name not in ELSEWHERE
    ],
)
def test_a_hidden_effect_is_in_a_set_of_few(name):
    effect, seed = hidden(name)
    diagnosis = diagnosed((effect,), seed, days=DAYS.get(name, 2))
    assert all(name in one for one in sets(diagnosis)), sets(diagnosis)
    assert sets(diagnosis) or name in SMOOTH
    assert all(len(one) <= 3 for one in sets(diagnosis))


@pytest.mark.long
@pytest.mark.parametrize("name", BESIDE_A_LAG)
def test_a_lag_and_another_effect_are_both_found(name):
    effect, seed = hidden(name)
    diagnosis = diagnosed(("thermal_lag:1", effect), seed, days=DAYS.get(name, 2))
    assert any("thermal_lag" in one for one in sets(diagnosis)), sets(diagnosis)
    assert any(name in one for one in sets(diagnosis)), sets(diagnosis)


@pytest.mark.parametrize(
    ("noise", "protocol"),
    [
        ("default", "paper"),
        pytest.param("white", "paper", marks=pytest.mark.long),
        pytest.param("drift97", "paper", marks=pytest.mark.long),
        pytest.param("outliers", "paper", marks=pytest.mark.long),
        ("default", "enriched"),
        pytest.param("heteroscedastic", "enriched", marks=pytest.mark.long),
    ],
)
def test_nothing_is_found_in_a_clean_joint(noise, protocol):
    diagnosis = diagnosed((), 71, protocol, noise)
    assert diagnosis.verdict == "no_evidence"
    assert sets(diagnosis) == []


@pytest.mark.long
@pytest.mark.parametrize("seed", [73, 74])
def test_what_the_catalogue_does_not_list_gets_no_name(seed):
    """Unless its angle of greatest friction is that of the greatest load."""
    diagnosis = diagnosed(("position_temperature:1",), seed)
    assert diagnosis.verdict == "unnamed"
    assert diagnosis.structure is not None
    assert set(diagnosis.structure.axes) == {"position", "temperature"}


@pytest.mark.long
def test_the_experiment_of_the_catalogue_resolves_what_four_speeds_cannot():
    """Four speeds leave a viscous term undecided; ten in random order decide."""
    before = diagnosed(("linear_viscous:9.5",), 73)
    assert ("linear_viscous",) not in sets(before)
    assert "ten or more speeds" in BY_NAME["linear_viscous"].experiment
    after = diagnosed(("linear_viscous:9.5",), 73, "enriched")
    assert sets(after) == [("linear_viscous",)]
