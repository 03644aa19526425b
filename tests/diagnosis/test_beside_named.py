"""What gets no name does not stand beside the measurement."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.effect_size import sizes_of
from frictioncli.diagnosis.search.judging import Judging
from frictioncli.diagnosis.search.measurement import measurement_causes
from frictioncli.diagnosis.search.named_causes import named_causes
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.preparation import Preparation
from frictioncli.diagnosis.search.search_result import SearchResult
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME
from tests.diagnosis.dense_noise import problem
from tests.diagnosis.wave_effects import B, effect, wave

OFFSET = BY_NAME["load_offset"]
MARGIN = 0.2


def looks_like_it(rows):
    """A torque that differs from that of the constant by a short wave."""
    return -rows.load_slope + 0.002 * wave(19.0)(rows)


NAMELESS = effect("nameless", [(1.0, looks_like_it)])
RIPPLE = effect("ripple", [(1.0, B)])


def judged(data, *accepted):
    """Return what is named of a search that has accepted some effects."""
    precomputed, fits = Precomputed.of(data, [OFFSET]), []
    for one in accepted:
        fits.append(Step.of(precomputed, fits).fitted(one, {}))
    step = Step.of(precomputed, fits)
    test = measurement_causes(step, [OFFSET])[0]
    found = SearchResult(
        causes=tuple(
            Cause(
                fit=fit,
                test=replace(test.test, statistic=fit.statistic, p_value=1e-9, log_bayes_factor=50),
                effects=(fit.effect.name,),
                probabilities={fit.effect.name: 1.0},
                **sizes_of(precomputed, fit),
            )
            for fit in fits
        ),
        measurement=measurement_causes(step, [OFFSET]),
        refused=(),
        rejected={},
        dropped={},
        step=step,
        catalogue=Catalogue.of(precomputed, []),
    )
    judging = Judging(
        problem=data,
        new=None,
        measured=(data, None),
        preparation=Preparation(),
        starts=None,
        margin=MARGIN,
        alpha=0.05,
    )
    return found, named_causes(judging, judging.judged(found))


def joint():
    """A constant of 6 N·m that does not load the gear, and a ripple."""
    data = problem(3, friction=lambda rows: 1.0 * B(rows))
    return replace(data, friction=data.friction - 6.0 * data.table.load_slope)


def test_a_constant_is_found_though_what_is_not_named_looks_like_it():
    data = joint()
    found, named = judged(data, RIPPLE, NAMELESS)
    (hidden,) = found.measurement
    assert hidden.test.p_value > 0.05
    assert [one.fit.effect.name for one in named.causes] == ["load_offset", "ripple"]
    assert named.causes[0].fit.coefficients[0] == pytest.approx(6.0, abs=1.0)
    assert [one.effect.name for one in named.step.accepted] == ["ripple"]
    # it is listed with its reason
    (other,) = named.others
    assert other.fit.effect.name == "nameless"
    assert other.reason
    # as if it had never been accepted
    _, plain = judged(data, RIPPLE)
    for one, two in zip(named.measurement, plain.measurement, strict=True):
        assert np.allclose(one.fit.coefficients, two.fit.coefficients)


def test_where_all_has_a_name_nothing_is_judged_anew():
    found, named = judged(joint(), RIPPLE)
    assert named.step is found.step
    assert named.measurement is found.measurement
    assert not named.others


def hump(rows):
    """Friction that is higher about 70 deg."""
    return np.exp(-np.square((rows.position - 70.0) / 22.0) / 2)


@pytest.mark.parametrize(("height", "named_alone"), [(0.0, True), (5.0, False)])
def test_what_may_be_a_part_of_a_cause_that_has_lost_its_name_loses_its_own(height, named_alone):
    """A hump of 5 N·m where at most 0.5 N·m are physically possible."""
    data = problem(3, friction=lambda rows: 0.6 * B(rows) + height * hump(rows))
    impossible = effect("hump", [(1.0, hump)], upper=0.5)
    _, plain = judged(data, RIPPLE)
    assert (plain.structure is None) is named_alone
    found, named = judged(data, RIPPLE, *([] if named_alone else [impossible]))
    assert "ripple" in [one.fit.effect.name for one in found.causes]
    own = [one.fit.effect.name for one in named.causes if not one.fit.effect.measurement]
    assert own == (["ripple"] if named_alone else [])
    if not named_alone:
        assert named.structure.axes == ("position",)
        reasons = {one.fit.effect.name: one.reason for one in named.others}
        assert "physically possible" in reasons["hump"]
        assert "structure along angle" in reasons["ripple"]
