"""The search for a form of what has no name: noise beside it, and what may be there instead."""

from dataclasses import replace

import numpy as np
import pytest

from frictioncli.diagnosis.empirical.fitted_columns import FittedColumns
from frictioncli.diagnosis.empirical.form import is_special_case
from frictioncli.diagnosis.empirical.form_search import LEAST_SCORE, FormSearch
from frictioncli.diagnosis.empirical.forms import forms_of
from frictioncli.diagnosis.empirical.random_functions import (
    function_of_form,
    functions_of,
    term_of,
)
from frictioncli.diagnosis.empirical.term import ranges_seen
from frictioncli.diagnosis.empirical.weighted_misfit import WeightedMisfit
from frictioncli.diagnosis.fit.extension import extend, misfits
from frictioncli.diagnosis.search.precomputed import Precomputed
from frictioncli.diagnosis.search.step import Step
from tests.diagnosis.dense_noise import problem


def warm_peak(rows):
    """Friction that is higher about 45 °C: the joint goes through it twice, as a drift might."""
    return 5.0 * np.exp(-np.square((rows.motor_temperature - 45.0) / 3.0) / 2)


def search(data):
    step = Step.of(Precomputed.of(data), [])
    beside = extend(data, step.predicting_fit(), [])
    fitted = FittedColumns.of(data, step.predicting_fit(), [])
    small = functions_of(
        data, step.precomputed.discrepancy.components, step.precomputed.start.amplitude
    )
    return FormSearch.of(step, fitted, small, misfits(data, beside)), fitted


def slow(noise):
    """Return the standard deviation of noise of pair means."""
    return float(np.hypot(noise[0].pair, noise[0].drift))


def test_noise_beside_a_form_is_that_of_the_joint_without_it():
    """The same joint without the peak is the other route; without the form, the peak is drift."""
    first, fitted = search(problem(3, friction=warm_peak))
    plain, _ = search(problem(3))
    warm = [one for one in forms_of(ranges_seen(fitted.problem.table)) if one.kind == "peak"]
    warm = [one for one in warm if (one.axes, one.channel) == (("temperature",), "friction")]
    found = first.best(warm)
    beside = first.beside(found, function_of_form(fitted, found.form, found.shape))
    assert found.score > LEAST_SCORE
    assert slow(first.noise) > 1.5 * slow(plain.noise)
    assert slow(beside.noise) == pytest.approx(slow(plain.noise), rel=0.15)
    assert beside.forms == ((found.form, found.shape),)
    # nothing of the kind is left for a second one
    assert beside.best(warm).score < LEAST_SCORE


def test_a_peak_that_might_move_is_no_rival_of_one_that_does_not():
    """A peak at one speed: that a moving one explains it too is no doubt about where it is."""
    data = problem(3)
    away = np.log(data.table.speed / 40.0) / 0.2
    first, _ = search(replace(data, friction=data.friction + 3.0 * np.exp(-np.square(away) / 2)))
    ranges = {
        axis: ends
        for axis, ends in ranges_seen(data.table).items()
        if axis in ("speed", "temperature")
    }
    forms = [one for one in forms_of(ranges) if one.kind in ("peak", "moving_peak")]
    still = next(one for one in forms if one.axes == ("speed",) and one.channel == "friction")
    moving = next(one for one in forms if one.kind == "moving_peak")
    assert is_special_case(still, moving)
    assert not is_special_case(moving, still)
    found = first.best([still, moving])
    assert (found.form, found.leads) == (still, True)


@pytest.mark.parametrize("since", [0, 1])
def test_a_bump_that_a_later_run_has_alone_is_found_with_that_run(since):
    """Mixed with a run that lacks it, a bump would be half as high."""
    data = problem(
        3,
        every=16,
        friction=lambda rows: (
            3.0
            * np.exp(-np.square((rows.position - 60.0) / 8.0) / 2)
            * (rows.run >= f"day{since + 1}")
        ),
    )
    first, fitted = search(data)
    bumps = [one for one in forms_of(ranges_seen(data.table)) if one.kind == "bump"]
    found = first.best(bumps)
    assert found.form == replace(bumps[0], since=since)
    assert found.shape["centre"] == pytest.approx(60.0, abs=1.0)
    function = function_of_form(fitted, found.form, found.shape)
    term = term_of(data, [function], np.array([3.0]))
    assert term.forms[0].since == ("day2" if since else "")
    # the joint as it is now has it
    first_run = data.part(data.table.run == 0)
    assert np.ptp(term.functions_at(first_run.table).friction) == pytest.approx(3.0, rel=0.05)
    widest = {axis.name: axis.values[-1] for axis in found.form.shape}
    assert not found.is_widest
    assert replace(found, shape={**found.shape, "width": widest["width"]}).is_widest


def test_distinct_inputs_explain_what_all_rows_do():
    """The same statistic from columns over all rows, which know nothing of distinct inputs."""
    first, fitted = search(problem(3, friction=warm_peak))
    misfit = WeightedMisfit.of(fitted, first.noise, first.functions, first.misfit)
    for form in forms_of(ranges_seen(fitted.problem.table)):
        shapes = form.shapes()[::17]
        slowly = [misfit.together([(form, shape)]) for shape in shapes]
        assert misfit.statistics(form, shapes) == pytest.approx(slowly, rel=1e-6, abs=1e-9)
