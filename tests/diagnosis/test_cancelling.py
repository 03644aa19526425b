"""A cause beside which an effect of the measurement is impossible: which of the two is given up."""

from dataclasses import replace

import pytest

from frictioncli.diagnosis.search import effect_tests, rivals
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.settings import DiagnosisSettings
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.wave_effects import A, B, effect

MEASURED = replace(effect("measured", [(1.0, B)], lower=0.0, upper=10.0), measurement=True)
"""An effect of the measurement, which cannot be negative."""


def searched(monkeypatch, *, form, measured):
    """Return what is found of a wave of 1.5 N·m by an effect whose form is not exact.

    Parameters
    ----------
    form : float
        Share of the measured effect in the form of the cause, relative to the wave.
    measured : float
        How much of the effect of the measurement is there [N·m].
    """
    one = effect("x", [(1.0, A), (form, B)])
    for module in (effect_tests, rivals):
        monkeypatch.setattr(module, "BY_NAME", {"x": one})
    data = problem(4, lambda rows: 1.5 * A(rows) + measured * B(rows))
    return find_causes(data, (one,), DiagnosisSettings(), 0.1, measurement=(MEASURED,))


def test_a_measurement_that_nothing_shows_gives_way_to_a_cause(monkeypatch):
    found = searched(monkeypatch, form=0.3, measured=0.0)
    assert [one.fit.effect.name for one in found.causes] == ["x"]
    # by least squares: the wave has 1.5 of the two orthogonal ones, and the form 1 and 0.3
    assert found.causes[0].fit.coefficients[0] == pytest.approx(1.5 / 1.09, rel=0.05)
    assert found.measurement == ()
    (refused,) = found.refused
    assert refused.fit.effect is MEASURED
    assert refused.standing == "undetermined"
    assert refused.fit.coefficients[0] == pytest.approx(-0.45, abs=0.1)
    assert "physically impossible" in refused.reason


def test_a_measurement_that_is_clearly_there_stands_against_a_cause(monkeypatch):
    found = searched(monkeypatch, form=1.0, measured=0.6)
    assert found.causes == ()
    assert "measured" in found.dropped["x"]
    (kept,) = found.measurement
    assert kept.fit.coefficients[0] > 0


def test_both_stand_where_the_form_is_exact(monkeypatch):
    found = searched(monkeypatch, form=0.0, measured=0.6)
    assert [one.fit.effect.name for one in found.causes] == ["x"]
    assert [one.fit.effect.name for one in found.measurement] == ["measured"]
