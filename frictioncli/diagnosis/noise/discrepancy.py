r"""Smooth discrepancy: what every model of a joint gets wrong a little, as random functions.

No equation is exactly true. Beside the noise of the measurement, the torque has a discrepancy: the
sum of random functions of angle, speed and temperature and of their products, in friction and in
load, and of errors in the form of the friction model [1]_. Each function is a series of cosines

.. math:: f(u) = \omega \sum_k s_k \gamma_k \cos \pi k u, \quad \gamma_k \sim N(0, 1)

over the range of its quantity, with :math:`s_k` falling with *k*, so that it is smooth. The
coefficients of the base model are free, so that only the part of a function that is orthogonal to
the base counts [2]_; it is this part that has the amplitude. The amplitude :math:`\omega` of
each function is at least its share of 0.75 % of the mean friction; above that it has a lognormal
prior, and is estimated with each rival in place. In either channel a further function has what is
finer along the angle than the smooth one, with an amplitude of its own. One more function in either
stands for the inertia of a speed that ripples with the angle: it is a load, and shows in friction
where the torque is late.

Errors of the base's parameters are what a function adds along the base's columns, where no data
show it. There its amplitude is known as well as beforehand only: its mean square under the
lognormal distribution is :math:`\omega^2 e^{2 \varsigma^2}`, and it is that of the whole function.

References
----------
.. [1] M. C. Kennedy and A. O'Hagan, "Bayesian calibration of computer models," J. R. Stat. Soc. B
   63(3), 2001, doi:10.1111/1467-9868.00294.
.. [2] M. Plumlee, "Bayesian calibration of inexact computer models," J. Am. Stat. Assoc. 112(519),
   2017, doi:10.1080/01621459.2016.1211016.
"""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array
from frictioncli.diagnosis.data.problem import Problem
from frictioncli.diagnosis.fit.columns import ModelColumns, joined, reduced
from frictioncli.diagnosis.noise.cosine_series import HALF
from frictioncli.diagnosis.noise.discrepancy_functions import FINE, FORM, SPEED_RIPPLE, functions_of
from frictioncli.effects.base import CHANNELS, Channel

SHARE = 0.0075
"""RMS of the whole discrepancy that is expected beforehand, relative to the mean friction.

The nuisances of the simulator, all at once, leave 0.4 to 0.8 %."""

SPREAD = 0.7
"""Standard deviation of the natural logarithm of each function's amplitude beforehand."""

_FORM_ERRORS = 2.0
"""Size of errors in the form of the friction model relative to that of the other functions, where
they look like its parameters: exponents are fitted to one joint, and differ from joint to joint."""

_MINOR_WEIGHT = 0.6
"""The same of functions of two quantities and of those in the load channel: main effects are larger
than interactions, and gravity is better known than friction."""

_FINE_WEIGHT = 0.2
"""The same of a fine function of the angle: a smooth one would have 0.08 in its orders."""

_LATE_WEIGHT = _MINOR_WEIGHT / 2
"""The same of a ripple of the speed in friction, where a part of what stands in the load shows."""

_UNSEEN = float(np.exp(SPREAD**2))
"""Root mean square of an amplitude that no data show, relative to its median."""

_RANK = 1e-3
"""Singular values of unit columns below this share of the greatest count as zero."""

_LEAST_LEFT = 1e-4
"""Least share of the mean square of a function that the base leaves."""

_ROUNDED = 1e-6
"""Share of the norm of an error of form up to which what the base leaves of it is rounding."""


@dataclass(frozen=True, slots=True)
class Component:
    """A random function of the discrepancy.

    Attributes
    ----------
    axes : tuple of str
        The quantities that it depends on: ``position``, ``speed``, ``temperature``; or
        :data:`FORM`, :data:`FINE` or :data:`SPEED_RIPPLE`.
    channel : {"friction", "load"}
        The channel in which it shows.
    columns : slice
        Its columns.
    """

    axes: tuple[str, ...]
    channel: Channel
    columns: slice


@dataclass(frozen=True, slots=True, kw_only=True)
class Discrepancy:
    """Columns of the discrepancy, a random function after the other.

    Attributes
    ----------
    components : tuple of Component
        The functions, those of friction first.
    span : ndarray, shape (2 * rows, rank)
        Orthonormal basis of the base's columns, friction above load.
    shown : (ndarray, ndarray), shape (rows, columns)
        Columns of the functions of friction in friction, and of those of load in load: of what the
        base leaves of a main effect the squares sum to 1 on average.
    whole : tuple of ndarray, shape (rows, columns)
        Columns of each function in its channel as a whole: the squares sum to 1 on average, and
        its lowest orders weigh more.
    columns : ModelColumns
        All columns of ``shown``, reduced. They are not orthogonal to the base: where its
        coefficients are free, the likelihood is the same.
    amplitude : float
        RMS of a main effect that is expected beforehand; in a load channel of the log it is as
        large a share of the load. [N·m]
    """

    components: tuple[Component, ...]
    span: Array
    shown: tuple[Array, Array]
    whole: tuple[Array, ...]
    columns: ModelColumns
    amplitude: float

    @property
    def widths(self) -> Array:
        """Number of columns of each function, shape (components,)."""
        return np.array([one.columns.stop - one.columns.start for one in self.components], float)

    @property
    def places(self) -> tuple[slice, slice]:
        """Columns of the functions of friction, and of those of load."""
        first = self.shown[0].shape[1]
        return slice(0, first), slice(first, self.columns.count)

    def torques(self, amplitude: Array) -> Array:
        """Return all columns with coefficients of variance 1, shape (2 * rows, columns) [N·m].

        Parameters
        ----------
        amplitude : ndarray, shape (components,)
            Logarithm of the amplitude of each function.
        """
        count = sum(one.shape[1] for one in self.whole)
        found = np.zeros((len(self.span), count))
        first = 0
        for size, of, one in zip(np.exp(amplitude), self.components, self.whole, strict=True):
            last = first + one.shape[1]
            _half(found, of.channel)[:, first:last] = size * one
            first = last
        return found

    def unseen(self, amplitude: Array) -> Array:
        """Return the same where no data show the amplitudes, of which these are the medians.

        What they add along the base's columns is an error of its parameters.
        """
        return _UNSEEN * self.torques(amplitude)

    def crossed(self, torques: Array) -> Array:
        """Return products of torques with what the base leaves of the columns.

        Parameters
        ----------
        torques : ndarray, shape (2 * rows, torques)
            Torques, friction above load. [N·m]

        Returns
        -------
        ndarray, shape (torques, columns)
        """
        along = torques - self.span @ (self.span.T @ torques)
        parts = zip(np.split(along, 2), self.shown, strict=True)
        return np.hstack([one.T @ columns for one, columns in parts])

    def along_products(self, products: Array, mean_square: float, amplitude: Array) -> float:
        """Return the standard deviation of the discrepancy along a torque, as its RMS [N·m].

        Parameters
        ----------
        products : ndarray, shape (columns,)
            Mean products of the torque with the columns, as of :meth:`crossed`.
        mean_square : float
            Mean square of the torque. [(N·m)²]
        amplitude : ndarray, shape (components,)
            Logarithm of the amplitude of each function.
        """
        if mean_square <= 0:
            return 0.0
        scale = np.repeat(np.exp(amplitude), self.widths.astype(int))
        return float(np.linalg.norm(scale * products) / np.sqrt(mean_square))


def discrepancy_of(problem: Problem, span: Array, share: float = SHARE) -> Discrepancy:
    """Return the discrepancy over the rows of a problem.

    Parameters
    ----------
    problem : Problem
        One joint's rows.
    span : ndarray, shape (2 * rows, rank)
        Orthonormal basis of the base's columns, friction above load; the discrepancy is orthogonal
        to it.
    share : float, optional
        RMS of the whole discrepancy relative to the mean friction; 0 for none.
    """
    rows = len(problem.friction)
    parts = functions_of(problem.table) if share > 0 else []
    mean = float(np.mean(np.abs(problem.friction)))
    # a load that is measured apart may have another unit: its share is one of the load
    apart = problem.has_load_channel and mean > 0
    loads = float(np.mean(np.abs(problem.load))) / mean if apart else 1.0
    components: list[Component] = []
    shown: list[Array] = []
    whole: list[Array] = []
    squares = 0.0
    for channel, axes, values in parts:
        base = _half(span, channel)
        along = base.T @ values
        square = float(np.sum(np.square(values)))
        if square - float(np.sum(np.square(along))) <= _LEAST_LEFT * square:
            continue
        weight = weight_of(axes, channel)
        of_errors = _of_errors(axes, values)
        if axes == FORM:
            orthogonal = -span @ along
            _half(orthogonal, channel)[:] += values
            combination = _orthonormal_combination(orthogonal, values)
            values, along = values @ combination, along @ combination
        left = float(np.sum(np.square(values)) - np.sum(np.square(along)))
        unit = loads if channel == "load" else 1.0
        shown.append(unit * weight * np.sqrt(rows / left) * values)
        whole.append(unit * (_FORM_ERRORS if axes == FORM else weight) * of_errors)
        first = components[-1].columns.stop if components else 0
        components.append(Component(axes, channel, slice(first, first + values.shape[1])))
        if axes != SPEED_RIPPLE and not (apart and channel == "load"):
            squares += weight**2
    none, both = np.zeros((rows, 0)), list(zip(components, shown, strict=True))
    channels = [
        np.hstack([none, *(one for of, one in both if of.channel == channel)])
        for channel in CHANNELS
    ]
    return Discrepancy(
        components=tuple(components),
        span=span,
        shown=(channels[0], channels[1]),
        whole=tuple(whole),
        columns=joined(
            [
                reduced(problem.layout, channels[0], np.zeros_like(channels[0])),
                reduced(problem.layout, np.zeros_like(channels[1]), channels[1]),
            ]
        ),
        amplitude=share * mean / np.sqrt(max(squares, 1.0)),
    )


def _half(rows: Array, channel: Channel) -> Array:
    """Return the rows of a channel, of friction above load."""
    return np.split(rows, 2)[CHANNELS.index(channel)]


def weight_of(axes: tuple[str, ...], channel: Channel) -> float:
    """Return the amplitude that is expected of a function, relative to that of a main effect.

    Parameters
    ----------
    axes : tuple of str
        The quantities that it depends on.
    channel : {"friction", "load"}
        The channel in which it shows.
    """
    if axes == FINE:
        return _FINE_WEIGHT
    if axes == SPEED_RIPPLE and channel == "friction":
        return _LATE_WEIGHT
    return _MINOR_WEIGHT if channel == "load" or len(axes) == 2 else 1.0


def _of_errors(axes: tuple[str, ...], columns: Array) -> Array:
    """Return columns of a function as a whole, whose squares sum to the number of rows.

    Errors of form have equal shares. The cosines of a function of the angle fall with the square of
    their order, as those of any function without a jump: the lowest ones, which look like gravity,
    matter for errors.
    """
    order = np.arange(1, columns.shape[1] + 1)
    if axes == ("position",):
        columns = columns * (1 + np.square(order / HALF)) / np.square(order)
    if axes == FORM:
        size = np.linalg.norm(columns, axis=0)
        columns = columns / np.where(size > 0, size, np.inf)
    squares = float(np.sum(np.square(columns)))
    return np.asarray(columns * np.sqrt(len(columns) / squares))


def _orthonormal_combination(columns: Array, whole: Array) -> Array:
    """Return the combinations of columns that are orthonormal, shape (columns, rank).

    Columns of which the projection left nothing but rounding, relative to the whole ones, have no
    part in it.
    """
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > _ROUNDED * np.linalg.norm(whole, axis=0), size, np.inf)
    _, strength, right = np.linalg.svd(columns / size, full_matrices=False)
    kept = strength > _RANK * strength[0]
    return np.asarray((right[kept] / strength[kept, np.newaxis]).T / size[:, np.newaxis])
