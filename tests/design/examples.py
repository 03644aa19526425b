"""A small problem, rivals and runs that several tests use."""

from dataclasses import replace

import numpy as np

from frictioncli.design.discrimination import Discrimination
from frictioncli.design.expected_evidence import CandidateNoises
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.effects import BY_NAME
from frictioncli.model.noise import Noise
from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.motion_programme import (
    MeasuredMoves,
    Standstill,
    UnrecordedMoves,
    simulate_programmes,
)

FASTEST = 101.2
SPEEDS = (19.1, 39.4, 67.5, FASTEST)


NOISE = (
    Noise(point=0.3, pair=0.2, drift=0.4, drift_time=900.0),
    Noise(point=0.25, pair=0.1, drift=0.2, drift_time=700.0),
)


def few_pairs():
    """Few pairs, so that dense covariance matrices stay small."""
    series = MeasuredMoves(speeds=(30.0, 90.0), low=0.0, high=90.0)
    heat = UnrecordedMoves(speed=90.0, low=0.0, high=90.0, seconds=300.0)
    (table,) = simulate_programmes(
        SynthesisSettings(seed=3, joint_kind="plain"), [[series, heat] * 6], 1
    )
    return replace(build_problems(table, "motor")[0], temperature_error=0.0)


def heating_runs():
    """A thin experiment with heating and cooling, and another programme on the same joint."""
    series = MeasuredMoves(speeds=SPEEDS, low=0.0, high=180.0)
    heat = UnrecordedMoves(speed=FASTEST, low=0.0, high=180.0, seconds=300.0)
    first = [*[series, heat] * 8, *[Standstill(900.0), series] * 4]
    other = [series, *[heat] * 4, series, Standstill(1500.0), series]
    settings = SynthesisSettings(seed=11, joint_kind="plain", noise_scale=0.0)
    return simulate_programmes(settings, [first, other], 1)


def fit(name, shape, *coefficients):
    """An effect so clear that noise adds nothing to its size."""
    return EffectFit(BY_NAME[name], shape, np.array(coefficients), np.zeros((0, 0)), 1e12)


def discrimination_in_rows(left, pairs=10**9):
    """Noncentralities in rows whose noise is known but for its scale."""
    alone = CandidateNoises(
        noises=NOISE[:1],
        expected_squares=np.array([float(pairs)]),
        log_determinants=np.zeros(1),
        degrees_of_freedom=pairs,
    )
    return Discrimination(left[np.newaxis], alone)
