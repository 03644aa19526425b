"""Effects that the simulator hides are found by name; nothing is found where nothing is hidden.

The simulator's formulas are its own: other functional details than the catalogue's, parameters
drawn at random. Each case is one seed, two days by the paper's programme or the enriched one; the
last day is kept out. Sizes are RMS torque over both days, of which the base model takes its
share; slow changes need more to stand out of a drifting noise. docs/blind.md has the same at size.
"""

import functools

import pytest

from frictioncli.diagnosis.diagnose import Diagnosis, diagnose_joint
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME, EFFECTS
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.torque_table import simulate_torques

SIZES = {
    "linear_viscous": 2.0,
    "coulomb_temperature": 2.0,
    "drift": 6.0,
    "run_in": 3.0,
    "step_change": 4.0,
    "payload_change": 2.0,
}
"""RMS of what is hidden where it is not 1 N·m. [N·m]"""

DAYS = {"drift": 3, "run_in": 3}
"""Days simulated where it is not two: one run alone cannot tell a slow change from slow noise."""

SEEDS = {"payload_change": 72}
"""71, or the next one with which the change falls on the first day, which alone is seen."""


BESIDE_A_LAG = ("coulomb_temperature", "payload_change", "position_ripple")
"""One effect of each channel, and one of the stroke; docs/blind.md has them all."""


QUICK = (
    "thermal_lag",
    "stribeck",
    "coulomb_temperature",
    "load_linear",
    "payload_change",
)
"""One effect of each kind: lag, speed, temperature, load, and change in time."""


@functools.cache
def diagnosed(
    effects: tuple[str, ...],
    seed: int,
    protocol: str = "paper",
    noise: str = "default",
    days: int = 2,
) -> Diagnosis:
    """Simulate days, hide effects in them, and diagnose them blind."""
    settings = SynthesisSettings(
        seed=seed,
        joint_kind="plain",
        protocol=protocol,
        noise_kind=noise,
        effects=effects,
        runs=days,
    )
    return diagnose_joint(simulate_torques(settings), "motor", "N·m", DiagnosisSettings())


def hidden(name: str) -> tuple[str, int]:
    return f"{name}:{SIZES.get(name, 1.0):g}", SEEDS.get(name, 71)


def sets(diagnosis: Diagnosis) -> list[tuple[str, ...]]:
    return [cause.effects for cause in diagnosis.causes]


@pytest.mark.parametrize(
    "name",
    [
        effect.name if effect.name in QUICK else pytest.param(effect.name, marks=pytest.mark.slow)
        for effect in EFFECTS
    ],
)
def test_a_hidden_effect_is_in_a_set_of_few(name):
    effect, seed = hidden(name)
    diagnosis = diagnosed((effect,), seed, days=DAYS.get(name, 2))
    holding = [one for one in sets(diagnosis) if name in one]
    assert holding, sets(diagnosis)
    assert len(holding[0]) <= 3


@pytest.mark.slow
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
        pytest.param("white", "paper", marks=pytest.mark.slow),
        pytest.param("drift97", "paper", marks=pytest.mark.slow),
        ("outliers", "paper"),
        ("default", "enriched"),
        pytest.param("heteroscedastic", "enriched", marks=pytest.mark.slow),
    ],
)
def test_nothing_is_found_in_a_clean_joint(noise, protocol):
    diagnosis = diagnosed((), 71, protocol, noise)
    assert diagnosis.verdict == "no_evidence"
    assert sets(diagnosis) == []


@pytest.mark.parametrize("name", ["position_temperature"])
def test_what_the_catalogue_does_not_list_gets_no_name(name):
    diagnosis = diagnosed((f"{name}:1",), 71)
    assert diagnosis.verdict == "unnamed"
    assert diagnosis.structure is not None


@pytest.mark.slow
def test_the_experiment_of_the_catalogue_resolves_what_four_speeds_cannot():
    """Four speeds leave a viscous term and a drag undecided; ten in random order decide."""
    before = diagnosed(("linear_viscous:2",), 73)
    assert before.verdict == "ambiguous"
    assert set(sets(before)[0]) >= {"linear_viscous", "quadratic_drag"}
    assert "ten or more speeds" in BY_NAME["linear_viscous"].experiment
    after = diagnosed(("linear_viscous:2",), 73, "enriched")
    assert sets(after) == [("linear_viscous",)]
