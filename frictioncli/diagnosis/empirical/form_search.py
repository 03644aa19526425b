r"""Search for the form that explains most of a misfit, beside base, causes and discrepancy.

What is slow, as all that goes with temperature, looks like drift: noise that was estimated without
a form takes a part of it. Forms are therefore looked for under that noise, those of temperature
under noise without drift as well, and those that explain most are compared by the restricted
likelihood with all variances estimated anew beside each,

.. math:: -2 \ln \frac{L_0}{L} - k \ln n ,

with the number *k* of a form's parameters and the number *n* of pairs (Schwarz's criterion [1]_).

References
----------
.. [1] G. Schwarz, "Estimating the dimension of a model," Ann. Stat. 6(2), 1978,
   doi:10.1214/aos/1176344136.
.. [2] R. E. Kass and A. E. Raftery, "Bayes factors," J. Am. Stat. Assoc. 90(430), 1995,
   doi:10.1080/01621459.1995.10476572.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from frictioncli.diagnosis.empirical.fitted_columns import FittedColumns
from frictioncli.diagnosis.empirical.form import Form, is_special_case
from frictioncli.diagnosis.empirical.form_columns import Shape
from frictioncli.diagnosis.empirical.random_functions import Function
from frictioncli.diagnosis.empirical.weighted_misfit import Explained, WeightedMisfit
from frictioncli.diagnosis.fit.columns import basis_columns
from frictioncli.diagnosis.fit.mixed_model import Components, MixedFit
from frictioncli.diagnosis.fit.transformed_columns import Part
from frictioncli.diagnosis.fit.variance_components import fit_variances
from frictioncli.diagnosis.search.lack_of_fit import expected_components
from frictioncli.diagnosis.search.step import Step
from frictioncli.model.noise import Noise

LEAST_SCORE = 10.0
"""Least score of a form: very strong evidence on the scale of Kass and Raftery [2]_."""

_LEAST_LEAD = 5.0
"""Least difference of the score to that of another form: an odds ratio of twelve."""

_LEAST_LEAD_ALIKE = 3.0
"""The same of forms of one quantity with as many parameters: what is at stake is the words alone,
and no price of parameters decides. An odds ratio of more than four."""

_WIDEST = 0.999
"""Share of its greatest width at which a form has it."""

_REFINED = 4
"""Forms whose shapes are refined, under each noise."""

Noises = tuple[Noise, Noise]
FormAt = tuple[Form, Shape]


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundForm:
    """A form with the shape that explains most.

    Attributes
    ----------
    form : Form
        The form.
    shape : mapping of str to float
        Its shape parameters.
    statistic : float
        Twice the log likelihood ratio.
    score : float
        The same, less the price of its parameters.
    fit : MixedFit
        Base, causes, discrepancy and noise beside it.
    leads : bool
        Whether its score is far enough above that of any form that may be there instead.
    is_located : bool
        Whether all forms that may be there instead are of the same quantities, in the same channel.
    """

    form: Form
    shape: Shape
    statistic: float
    score: float
    fit: MixedFit
    leads: bool = True
    is_located: bool = True

    @property
    def is_widest(self) -> bool:
        """Whether it is as wide as it can be: the torque is smoother, and not of this form."""
        return any(
            axis.name == "width" and self.shape["width"] >= _WIDEST * axis.values[-1]
            for axis in self.form.shape
        )

    @property
    def places(self) -> frozenset[str]:
        """What it depends on; with one payload the angle tells the load."""
        return frozenset("position" if axis == "load" else axis for axis in self.form.axes)


@dataclass(frozen=True, slots=True, kw_only=True)
class FormSearch:
    """Base and causes with the forms found so far, and the noise that suits all of them best.

    Attributes
    ----------
    step : Step
        Base and causes.
    fitted : FittedColumns
        Their columns.
    functions : tuple of Function
        Random functions of the discrepancy that is expected, and forms.
    misfit : (ndarray, ndarray), shape (rows,)
        What base and causes leave of both channels. [N·m]
    forms : tuple of (Form, mapping of str to float)
        Forms found so far, with their shapes.
    components : Components
        Variance components of base and causes, with the discrepancy that is expected.
    fit : MixedFit
        Base, causes and forms, with the variances that suit them best.
    """

    step: Step
    fitted: FittedColumns
    functions: tuple[Function, ...]
    misfit: tuple[np.ndarray, np.ndarray]
    forms: tuple[FormAt, ...]
    components: Components
    fit: MixedFit
    _grids: dict[tuple[int, int], tuple[Form, Explained]] = field(
        default_factory=dict, init=False, repr=False
    )
    _refined: dict[tuple[int, int], FoundForm] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(
        cls,
        step: Step,
        fitted: FittedColumns,
        functions: Sequence[Function],
        misfit: tuple[np.ndarray, np.ndarray],
    ) -> "FormSearch":
        """Return the search before a form is found; arguments as the attributes."""
        components = expected_components(step)
        known = step.precomputed.start
        starts = replace(step.fit.variances, amplitude=known.amplitude), known
        return cls(
            step=step,
            fitted=fitted,
            functions=tuple(functions),
            misfit=misfit,
            forms=(),
            components=components,
            fit=fit_variances(components, step.products, step.known, *starts),
        )

    @property
    def noise(self) -> Noises:
        """Noise of friction and load."""
        return self.step.precomputed.noise(self.fit.variances)

    def beside(self, found: FoundForm, function: Function) -> "FormSearch":
        """Return the search with one more form.

        Parameters
        ----------
        found : FoundForm
            The form.
        function : Function
            Its columns.
        """
        forms = [one for one in self.functions if one.is_form]
        others = self.functions[len(forms) :]
        return replace(
            self,
            functions=(*forms, function, *others),
            forms=(*self.forms, (found.form, found.shape)),
            fit=found.fit,
        )

    def best(self, forms: Sequence[Form]) -> FoundForm:
        """Return the form that explains most for its number of parameters.

        Parameters
        ----------
        forms : sequence of Form
            The forms.
        """
        without_drift = self.step.precomputed.noise(self.step.precomputed.start)
        slow = [one for one in forms if "temperature" in one.axes]
        found: dict[int, FoundForm] = {}
        for number, (noise, among) in enumerate(((self.noise, forms), (without_drift, slow))):
            misfit = self._weighted(noise)
            # the same forms but one are asked for again where that one was no use
            for form in among:
                if (number, id(form)) not in self._grids:
                    self._grids[number, id(form)] = form, misfit.best_of(form)
            tried = [self._grids[number, id(form)] for form in among]
            tried.sort(key=lambda one: self._price(one[0]) - one[1][1])
            for form, shape in tried[:_REFINED]:
                if (number, id(form)) not in self._refined:
                    place, _ = misfit.refined(form, misfit.in_place(form, shape))
                    self._refined[number, id(form)] = self._judged(form, place)
                one = self._refined[number, id(form)]
                known = found.get(id(form), one)
                found[id(form)] = max(one, known, key=lambda one: one.score)
        first, *others = sorted(found.values(), key=lambda one: -one.score)
        misfit = self._weighted(self.step.precomputed.noise(first.fit.variances))
        again = self._judged(first.form, misfit.refined(first.form, (first.shape, 0.0))[0])
        first = self._since(max(first, again, key=lambda one: one.score), misfit)
        rivals = [one for one in others if self._is_rival(one, first, misfit)]
        near = [one for one in rivals if not _is_behind(one, first)]
        alike = all(_place_of(one) == _place_of(first) for one in near)
        return replace(first, leads=not near, is_located=alike)

    def _since(self, found: FoundForm, misfit: WeightedMisfit) -> FoundForm:
        """Return a form as it is there from a later run on, if that is much likelier."""
        later = [found]
        for run in np.unique(self.fitted.problem.layout.run)[1:].tolist():
            form = replace(found.form, since=run)
            later.append(self._judged(form, misfit.refined(form, (found.shape, 0.0))[0]))
        best = max(later, key=lambda one: one.score)
        return best if best.score > found.score + LEAST_SCORE else found

    def _weighted(self, noise: Noises) -> WeightedMisfit:
        return WeightedMisfit.of(self.fitted, noise, self.functions, self.misfit)

    def _price(self, form: Form) -> float:
        return form.parameters * float(np.log(len(self.fitted.problem.layout.time)))

    def _judged(self, form: Form, shape: Shape) -> FoundForm:
        """Return a form at a shape, with the variances that suit it best."""
        precomputed, table = self.step.precomputed, self.fitted.problem.table
        parts = [
            Part(basis_columns(precomputed.problem, one.columns(table, at)), precomputed.noises)
            for one, at in (*self.forms, (form, shape))
        ]
        products = self.step.products.beside(parts)
        starts = self.fit.variances, precomputed.start
        fit = fit_variances(self.components, products, self.step.known, *starts)
        statistic = self.fit.objective - fit.objective
        score = statistic - self._price(form)
        return FoundForm(form=form, shape=shape, statistic=statistic, score=score, fit=fit)

    def _is_rival(self, other: FoundForm, first: FoundForm, misfit: WeightedMisfit) -> bool:
        """Return whether a form may be there instead of another one, rather than beside it.

        It is none where it depends on something else and leaves the other one to be explained, nor
        where it holds the other one as a special case: that its further parameters are not needed
        is what the price says.
        """
        if is_special_case(first.form, other.form):
            return False
        if other.places & first.places:
            return True
        both = misfit.together([(one.form, one.shape) for one in (first, other)])
        beside = both - misfit.together([(other.form, other.shape)])
        return beside - self._price(first.form) < LEAST_SCORE


def _place_of(found: FoundForm) -> tuple[frozenset[str], str]:
    return found.places, found.form.channel


def _is_behind(rival: FoundForm, first: FoundForm) -> bool:
    """Return whether a form explains so much less that another one is there, not it."""
    alike = all(
        getattr(rival.form, name) == getattr(first.form, name)
        for name in ("axes", "channel", "parameters")
    )
    least = _LEAST_LEAD_ALIKE if alike else _LEAST_LEAD
    return first.score - rival.score >= least
