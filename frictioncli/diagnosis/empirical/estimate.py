r"""The empirical term: how it is estimated, whether it is used, and which form describes it.

The discrepancy that any model has (:mod:`frictioncli.diagnosis.noise.discrepancy`) is a sum of
random functions with known amplitudes. Their best estimate from what base and causes leave
(:mod:`frictioncli.diagnosis.empirical.normal_equations`) is used only where it predicts pairs that
it has not seen: the pairs are cut into blocks of neighbours, a fifth of the blocks at a time is
kept out of the estimate, and what the estimate then reduces the misfit by on those,

.. math:: \sqrt{\overline{y^2} - \overline{(y - \hat y)^2}} ,

must be above the smallest size worth a name, and beyond chance. Where a run was kept out of the
diagnosis, so must what it reduces the misfit by there.

Up to two forms (:mod:`frictioncli.diagnosis.empirical.forms`) describe it, one after the other,
each judged on what the former leaves, beside the discrepancy that any model has. Each must explain
more than that size of the blocks kept out, and show in every part of the pairs alone; together they
must explain most of what the free functions do, and predict the blocks as well. Otherwise, or where
another form may be there instead that is nearly as likely, or the data cannot show it
(:mod:`frictioncli.diagnosis.empirical.resolved`), the term has no form. A form that explains too
little of the blocks makes way for the next.

A form is evidence beyond that discrepancy, also where the data do not tell which of several of one
quantity it is. Free functions are not: any joint has some, which recur on every run. They are part
of the prediction all the same; without a form a term is structure only where it surely explains
more than the root sum of squares of the smallest size worth a name and of the discrepancy that is
expected of any joint.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.empirical.estimated import (
    EstimatedFunctions,
    explained,
    is_worth_using,
    recurs,
    reduced_by,
    surely_explained,
    without_term,
)
from frictioncli.diagnosis.empirical.fitted_columns import FittedColumns
from frictioncli.diagnosis.empirical.form import Form
from frictioncli.diagnosis.empirical.form_search import LEAST_SCORE, FormSearch, Noises
from frictioncli.diagnosis.empirical.forms import forms_of
from frictioncli.diagnosis.empirical.located import Located, located
from frictioncli.diagnosis.empirical.normal_equations import Misfits, NormalEquations
from frictioncli.diagnosis.empirical.random_functions import (
    Function,
    function_of_form,
    functions_of,
)
from frictioncli.diagnosis.empirical.resolved import is_resolved
from frictioncli.diagnosis.empirical.term import EmpiricalTerm, ranges_seen
from frictioncli.diagnosis.fit.extension import Extension, misfits
from frictioncli.diagnosis.fit.gain import Gain
from frictioncli.diagnosis.noise.discrepancy import SHARE
from frictioncli.diagnosis.search.axis_columns import varying_axes
from frictioncli.diagnosis.search.step import Step
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.distributions import chi2_tail

_MOST_FORMS = 2
"""Greatest number of forms."""

_MOST_TRIED = 8
"""Greatest number of forms that are tried: one that explains too little makes way for the next, as
what is left of a form that has not quite the shape of the law."""

_MOST_OF_IT = 2 / 3
"""Share of what the free functions explain that forms must explain alone, as RMS: the rest may be
the discrepancy of any joint."""

_AS_GOOD = 1.02
"""Misfit with forms as a multiple of that with free functions, up to which they are as good."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Empirical:
    """An empirical term that is worth using, with what it gains.

    Attributes
    ----------
    term : EmpiricalTerm
        The term.
    parts : tuple of Located
        Its forms, or else its random functions, with their sizes; the largest first.
    size : float
        Its RMS over the rows that it was estimated from. [N·m]
    kept_out : float
        RMS of what it explains on blocks of pairs that were kept out of its estimate. [N·m]
    gain : Gain
        Reduction of the misfit that base and causes leave, on the held-out run of the diagnosis, or
        on the blocks kept out of the estimate.
    beside : Extension
        Base and causes refitted beside its forms: what their parameters are if the forms are true.
    without : Extension
        Base and causes that the term is added to: the base as fitted without it, to which all
        returns where the term fades; causes as in the former.
    statistic : float
        Twice the log likelihood ratio of the first of its forms; 0 without any.
    p_value : float or None
        Probability that noise gives as much, corrected for the number of forms that were tried.
    is_structure : bool
        Whether it is more than the discrepancy that is expected of any joint.
    """

    term: EmpiricalTerm
    parts: tuple[Located, ...]
    size: float
    kept_out: float
    gain: Gain
    beside: Extension
    without: Extension
    statistic: float = 0.0
    p_value: float | None = None
    is_structure: bool = True


def as_structure(found: Empirical | None) -> Empirical | None:
    """Return a term if it is structure; None if it is what any joint has, or there is none.

    Parameters
    ----------
    found : Empirical or None
        The term.
    """
    return found if found is not None and found.is_structure else None


NewRun = tuple[Problem, Callable[[Extension], Extension]]
"""Rows of a run that was kept out, and what of base and causes holds there."""


def empirical_term(
    step: Step,
    seen: tuple[Problem, Extension],
    new: NewRun | None,
    *,
    margin: float,
    floor: float,
    seed: int,
    structure: Structure | None = None,
    base_is_of_others: bool = False,
) -> Empirical | None:
    """Return an empirical term for what base and causes leave; None where it is not worth using.

    Parameters
    ----------
    step : Step
        The last step of the search: noise, and amplitudes of the discrepancy.
    seen : (Problem, Extension)
        Rows to learn from, and base with causes fitted to them.
    new : (Problem, callable) or None
        Rows of a run that was kept out, and what of base with causes holds there.
    margin : float
        Smallest size worth a name. [N·m]
    floor : float
        RMS of the noise that is new with each pair. [N·m]
    seed : int
        Seed of the block bootstrap.
    structure : Structure, optional
        Structure that was located.
    base_is_of_others : bool, optional
        Whether base and causes were fitted to other rows, so that they hold nothing of the term.
    """
    problem, before_term = seen[0], misfits(*seen)
    components = step.precomputed.discrepancy.components
    fitted = FittedColumns.of(problem, step.predicting_fit(), seen[1].effects)
    # base and causes of others have taken nothing of what is looked for; here they take their part
    misfit = fitted.left(before_term) if base_is_of_others else before_term

    def reduced(equations: NormalEquations, misfit: Misfits = misfit) -> Gain:
        left = without_term(misfit, equations.predicted_blocks())
        return reduced_by(problem, misfit, left, basis="within_run", floor=floor, seed=seed)

    def estimated(functions: Sequence[Function], noise: Noises) -> EstimatedFunctions:
        equations = NormalEquations.of(problem, functions, noise, misfit)
        return EstimatedFunctions(
            functions=list(functions), equations=equations, gain=reduced(equations)
        )

    smooth = functions_of(problem, components, step.fit.variances.amplitude)
    if not smooth:
        return None
    free, described = estimated(smooth, step.noise()), None
    least = float(np.hypot(margin, SHARE * np.mean(np.abs(problem.friction))))
    if not is_worth_using(free.gain, margin):
        return None
    small = functions_of(problem, components, step.precomputed.start.amplitude)
    search = FormSearch.of(step, fitted, small, misfit)
    best, before = free, free.gain.before
    without, evident = np.inf, False
    candidates = forms_of(_varying(problem), problem.counted)
    if structure is not None:
        candidates = [one for one in candidates if _is_along(one, structure)]
    number, accepted = len(candidates), []
    for _ in range(_MOST_TRIED):
        found = search.best(candidates)
        if found.score < LEAST_SCORE or not found.is_located:
            break
        tried = search.beside(found, function_of_form(fitted, found.form, found.shape))
        more = estimated(tried.functions, tried.noise)
        alone = reduced(more.equations.of_forms())
        added = float(np.sqrt(max(before**2 - alone.after**2, 0.0)))
        is_worse = added < margin or more.gain.after >= without
        is_worse = is_worse or found.is_widest or not recurs(more)
        is_most = explained(alone) >= _MOST_OF_IT * explained(free.gain)
        evident = evident or (is_most and not is_worse)
        is_told = found.leads and all(is_resolved(one, problem) for one in more.term().forms)
        if not is_told:
            break
        if is_worse:
            candidates.remove(replace(found.form, since=0))
            continue
        accepted.append(found)
        search, before, without = tried, alone.after, more.gain.after
        freely = estimated([*_forms(search), *smooth], search.noise)
        best = min(best, more, freely, key=lambda one: one.gain.after)
        if is_most:
            described = more
        if len(search.forms) == _MOST_FORMS:
            break
    chosen = free
    if described is not None and described.gain.after <= _AS_GOOD * best.gain.after:
        chosen = described
    whole = chosen
    if base_is_of_others:
        whole = chosen.beyond_base()
        whole = replace(whole, gain=reduced(whole.equations, before_term))
        if not is_worth_using(whole.gain, margin):
            return None
    used = _used(whole, seen, new, margin=margin, floor=floor, seed=seed)
    if used is not None and chosen is described:
        first = accepted[0]
        chance = number * chi2_tail(first.statistic, first.form.parameters)
        return replace(used, statistic=first.statistic, p_value=min(1.0, chance))
    if used is None or evident:
        return used
    surely = min(surely_explained(free.gain), surely_explained(used.gain))
    return replace(used, is_structure=surely >= least)


def _used(
    found: EstimatedFunctions,
    seen: tuple[Problem, Extension],
    new: NewRun | None,
    *,
    margin: float,
    floor: float,
    seed: int,
) -> Empirical | None:
    """Return an estimate as a term, if it explains enough of the held-out run, too."""
    term, gain, beside = found.term(), found.gain, found.refitted(seen[1])
    without = replace(beside, changes=seen[1].changes, gravity=seen[1].gravity)
    if new is not None:
        rows, holding = new
        before, left = (misfits(rows, holding(one)) for one in (seen[1], without))
        after = without_term(left, term.at(rows))
        gain = reduced_by(rows, before, after, basis="new_run", floor=floor, seed=seed)
        if not is_worth_using(gain, margin):
            return None
    added = term.at(seen[0])
    return Empirical(
        term=term,
        parts=located(found.functions, found.equations, term.forms),
        size=float(np.sqrt(np.mean(seen[0].squared(added.friction, added.load)))),
        kept_out=explained(found.gain),
        gain=gain,
        beside=beside,
        without=without,
    )


def _forms(search: FormSearch) -> list[Function]:
    return [one for one in search.functions if one.is_form]


def _varying(problem: Problem) -> dict[str, tuple[float, float]]:
    """Return the ranges of the quantities that vary."""
    varying = varying_axes(problem)
    return {axis: ends for axis, ends in ranges_seen(problem.table).items() if axis in varying}


def _is_along(form: Form, structure: Structure) -> bool:
    """Return whether a form may describe structure, or something else beside it.

    It is none of the same quantity that depends on another one as well; and none of the load where
    friction has structure along the angle, of which the test tells the load, nor the other way
    round. Where it does not, as of a load torque with one payload, the simpler form decides.
    """
    if "load" in form.axes and "position" in structure.axes:
        undecided = structure.or_load or structure.channel == "load"
        return undecided and form.channel == structure.channel
    own, located = set(form.axes), set(structure.axes)
    if own == {"position"} and located == {"load"}:
        return form.channel != structure.channel
    return not own > located
