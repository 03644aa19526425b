"""Rivals of an effect that is planted: effects of the catalogue that explain it as well."""

from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.fit.bounded import bounded_coefficients, pseudo_inverse
from frictioncli.diagnosis.fit.hypotheses import EffectFit
from frictioncli.diagnosis.fit.mixed_model import Variances
from frictioncli.diagnosis.fit.planted_columns import WithinProducts, weighted_products
from frictioncli.diagnosis.fit.transformed_columns import Part, TransformedColumns
from frictioncli.diagnosis.noise.significance import log_bayes_factor
from frictioncli.diagnosis.search.catalogue import Catalogue
from frictioncli.diagnosis.search.planted_fits import PlantedFit
from frictioncli.diagnosis.search.screening import LeftProducts, left_products
from frictioncli.diagnosis.search.step import Step
from frictioncli.effects import BY_NAME


@dataclass(frozen=True, slots=True)
class PlantedRivals:
    """All hypotheses beside a step, for misfits into which a torque is planted.

    Attributes
    ----------
    step : Step
        Base and other causes.
    catalogue : Catalogue
        The hypotheses.
    excluded : collection of str
        Names of those that are no rivals: what is physically impossible.
    """

    step: Step
    catalogue: Catalogue
    excluded: Collection[str] = ()
    _left: dict[int, tuple[Variances, list[LeftProducts], list[Array]]] = field(
        default_factory=dict, init=False
    )

    def of_torques(self, torques: Part, variances: Variances) -> "RivalsOfTorques":
        """Return the hypotheses for misfits with some torques, under variance components.

        Parameters
        ----------
        torques : Part
            The torques, a column each.
        variances : Variances
            The variance components.
        """
        left, inverse = self._known(variances)
        columns = self.step.columns
        within = WithinProducts.of(columns, torques)
        across, _ = weighted_products(columns, torques, variances, within)
        alone = TransformedColumns((torques,))
        rights = []
        for number, one in enumerate(left):
            right = self.catalogue.across(number, alone, variances) - across[:-1].T @ one.taken
            rights.append(np.where(one.left, right.reshape(-1, *one.right.shape), 0.0))
        return RivalsOfTorques(self, left, inverse, rights)

    def _known(self, variances: Variances) -> tuple[list[LeftProducts], list[Array]]:
        """Return what base and other causes leave of each hypothesis, and its inverse."""
        if id(variances) not in self._left:
            step = self.step
            null = step.null_under(variances)
            found = [
                left_products(self.catalogue, number, step.columns, null)
                for number in range(len(self.catalogue.hypotheses))
            ]
            inverse = [pseudo_inverse(one.inner) for one in found]
            # the variance components live as long as their number
            self._left[id(variances)] = variances, found, inverse
        return self._left[id(variances)][1:]


@dataclass(frozen=True, slots=True)
class RivalsOfTorques:
    """The hypotheses for misfits with torques of one effect.

    Attributes
    ----------
    rivals : PlantedRivals
        The hypotheses.
    left : list of LeftProducts
        What base and other causes leave of each.
    inverse : list of ndarray, shape (shapes, width, width)
        Inverse of the products of each shape's columns.
    rights : list of ndarray, shape (torques, shapes, width)
        Products of each with the torques.
    """

    rivals: PlantedRivals
    left: list[LeftProducts]
    inverse: list[Array]
    rights: list[Array]

    def own_log_bayes_factor(self, planted: PlantedFit) -> float:
        """Return the log Bayes factor of the effect that is planted, fitted at its own shape."""
        names = [one.name for one in self.rivals.catalogue.hypotheses]
        factor, fit = self._fitted(names.index(planted.fit.effect.name), planted)
        return factor + max(planted.fit.statistic - fit.statistic, 0.0) / 2

    def better(self, planted: PlantedFit, least: float) -> list[tuple[float, EffectFit]]:
        """Return the rivals with a greater log Bayes factor, each with that, greatest first.

        Parameters
        ----------
        planted : PlantedFit
            What is planted, fitted.
        least : float
            The log Bayes factor.
        """
        found = []
        for number, hypothesis in enumerate(self.rivals.catalogue.hypotheses):
            name = hypothesis.name
            if name == planted.fit.effect.name or name in self.rivals.excluded:
                continue
            right = self._right(number, planted)
            unbounded = np.einsum("si,sij,sj->s", right, self.inverse[number], right)
            if log_bayes_factor(unbounded + planted.offset, 1) <= least:
                continue
            factor, fit = self._fitted(number, planted)
            if factor > least:
                found.append((factor, fit))
        return sorted(found, key=lambda one: -one[0])

    def _right(self, number: int, planted: PlantedFit) -> Array:
        right = self.left[number].right + planted.size * self.rights[number][planted.number]
        return np.asarray(right)

    def _fitted(self, number: int, planted: PlantedFit) -> tuple[float, EffectFit]:
        """Return a hypothesis at its best shape, and its log Bayes factor."""
        hypothesis, left = self.rivals.catalogue.hypotheses[number], self.left[number]
        coefficients, gain, free = bounded_coefficients(
            left.inner, self._right(number, planted), hypothesis.lower, hypothesis.upper
        )
        grid = np.maximum(gain + planted.offset, 0.0)
        best = int(np.argmax(grid))
        both = free[best][:, np.newaxis] & free[best]
        fit = EffectFit(
            BY_NAME[hypothesis.name],
            hypothesis.shapes[best],
            coefficients[best],
            pseudo_inverse(np.where(both, left.inner[best], 0.0)[np.newaxis])[0],
            float(grid[best]),
            planted.fit.variances,
        )
        return log_bayes_factor(grid, int(free[best].sum())), fit
