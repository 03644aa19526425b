"""The empirical term as tables for linear interpolation, each over two quantities at most.

The term is the product of the validities of its inputs times a sum of parts: forms, functions, and
what it changes of base and gravity. A table of all four inputs at once would be too long; those of
the parts are short, and what is looked up in them is multiplied and added.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from frictioncli.arrays import Array
from frictioncli.deployment.extension import DeployedExtension, instants
from frictioncli.diagnosis.empirical.form_columns import LATE_BUMPS
from frictioncli.diagnosis.empirical.term import (
    FADING,
    INPUTS,
    EmpiricalTerm,
    FormFunction,
    SmoothFunction,
    in_coordinates,
)
from frictioncli.effects.base import EffectTable
from frictioncli.errors import OptionError

VALIDITY = "validity"
"""Name of the tables whose values are multiplied."""

_MOST_ROWS = 50_000
"""Greatest number of rows of all tables."""

_FIRST = 5
"""Knots that are tried first."""

_INNER = 8
"""Knots where the term was measured for each where it fades."""

_PARTS = 4
"""Number of parts of each cell in which the interpolation error is evaluated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartTable:
    """Values over no quantity, one or two, for linear interpolation.

    Attributes
    ----------
    part : str
        What it is a table of; :data:`VALIDITY` where its value is a factor.
    channel : {"friction", "load", "both"}
        The torque that it belongs to.
    axes : tuple of str
        Quantities: ``position`` [deg], ``speed`` [deg/s], ``temperature`` [°C], ``load`` [N·m]; of
        a validity the amount of the load.
    knots : tuple of ndarray
        Increasing values of each.
    values : ndarray
        Value at each combination of knots. [torque unit], [1]
    """

    part: str
    channel: str
    axes: tuple[str, ...]
    knots: tuple[Array, ...]
    values: Array

    def rows(self) -> Iterator[tuple[Array, float]]:
        """Yield the knots of each row with the value there."""
        for place in product(*(range(len(one)) for one in self.knots)):
            knots = np.array([one[i] for one, i in zip(self.knots, place, strict=True)])
            yield knots, float(self.values[place])


_Values = Callable[[EffectTable], Array]
_Part = tuple[str, str, tuple[str, ...], _Values]


def empirical_tables(extension: DeployedExtension, tolerance: float) -> list[PartTable]:
    """Return the tables of an empirical term.

    Parameters
    ----------
    extension : DeployedExtension
        An extension that has a term.
    tolerance : float
        Greatest error of what the tables give together. [torque unit]

    Raises
    ------
    OptionError
        If the tables would be too long.
    """
    term = extension.empirical
    assert term is not None
    parts = list(_parts(extension, term))
    tables = [_table(term, extension, one, tolerance / (2 * len(parts))) for one in parts]
    tables = [one for one in tables if one.values.any()]
    most = sum(float(np.max(np.abs(one.values))) for one in tables)
    shares = tolerance / (2 * len(INPUTS) * max(most, 1e-300))
    tables = [*(_validity(term, axis, shares) for axis in INPUTS), *tables]
    if sum(one.values.size for one in tables) > _MOST_ROWS:
        raise OptionError(
            f"--tolerance {tolerance:.3g}: the tables of the empirical term would have more than"
            f" {_MOST_ROWS} rows; allow more"
        )
    return tables


def _parts(extension: DeployedExtension, term: EmpiricalTerm) -> Iterator[_Part]:
    """Yield the parts: name, channel, quantities and values at instants."""
    for number, form in enumerate(term.forms, start=1):
        channels = ("friction", "load") if form.kind in LATE_BUMPS else (form.channel,)
        for channel in channels:
            yield f"form {number}", channel, _axes_of(form), _form_values(form, channel)
    for number, one in enumerate(term.functions, start=1):
        yield f"function {number}", one.channel, one.axes, _function_values(one, term)
    p, change = extension.about, term.base_changes
    get = {name: change.get(name, 0.0) for name in ("tau_c", "alpha", "beta", "gamma", "delta")}

    def viscous(table: EffectTable) -> Array:
        falling = get["gamma"] - p.gamma * table.temperature * get["delta"]
        warm = np.exp(-p.delta * table.temperature) * falling
        return np.asarray((get["beta"] + warm) * np.sqrt(table.speed) + get["tau_c"])

    def moved(table: EffectTable) -> Array:
        angle, gravity = np.radians(table.position), term.gravity_changes
        own = gravity.cosine * np.cos(angle) + gravity.sine * np.sin(angle) + gravity.offset
        return np.asarray(own)

    yield "base", "friction", ("speed", "temperature"), viscous
    yield "base", "friction", ("load",), lambda table: get["alpha"] * np.square(table.load)
    carried = ("load", "position")
    yield "gravity", "friction", carried, lambda table: 2 * p.alpha * table.load * moved(table)
    yield "gravity", "load", ("position",), moved


def _axes_of(form: FormFunction) -> tuple[str, ...]:
    """Return the quantities of a form: one in a late torque depends on the speed as well."""
    return ("position", "speed") if form.shape.get("lag") else form.axes


def _form_values(form: FormFunction, channel: str) -> _Values:
    return lambda table: getattr(form.at(table), channel)


def _function_values(one: SmoothFunction, term: EmpiricalTerm) -> _Values:
    within = in_coordinates(term.ranges)
    return lambda table: one.values(table, within)


def _instants(
    extension: DeployedExtension, term: EmpiricalTerm, mesh: Mapping[str, Array]
) -> EffectTable:
    """Return instants at all combinations of some quantities, the others in the middle."""
    rows = next(iter(mesh.values())).size
    place = {
        axis: mesh[axis].ravel() if axis in mesh else np.full(rows, np.mean(term.ranges[axis]))
        for axis in INPUTS
    }
    return instants(extension.about, **place)


def _ends(term: EmpiricalTerm, axis: str) -> Array:
    """Return where the term is nothing and where it begins to fade: below, and above, ascending.

    Of the speed its logarithm; of the load both signs.
    """
    low, high = in_coordinates(term.ranges)[axis]
    reach = FADING * (high - low) or FADING * max(abs(high), 1.0)
    if axis == "load":
        low = -high
    return np.array([low - reach, low, high, high + reach])


def _spaced(term: EmpiricalTerm, axis: str, count: int) -> Array:
    """Return so many knots where the term was measured, and some where it fades.

    Series of cosines have a kink at the ends of what was measured. A load of 0 is among the knots.
    """
    below, low, high, above = _ends(term, axis)
    outer = count // _INNER + 2
    inner = np.linspace(low, high, count | 1 if axis == "load" else count)
    knots = np.concatenate(
        [np.linspace(below, low, outer)[:-1], inner, np.linspace(high, above, outer)[1:]]
    )
    return np.unique(np.exp(knots) if axis == "speed" else knots)


def _table(
    term: EmpiricalTerm, extension: DeployedExtension, part: _Part, tolerance: float
) -> PartTable:
    """Return the table of a part, with so many knots that its error is within a tolerance."""
    name, channel, axes, values = part
    counts = [_FIRST] * len(axes)

    def at(knots: Sequence[Array]) -> Array:
        mesh = dict(zip(axes, np.meshgrid(*knots, indexing="ij"), strict=True))
        shape = np.broadcast_shapes(*(one.shape for one in mesh.values()))
        return np.reshape(values(_instants(extension, term, mesh)), shape)

    from scipy.interpolate import RegularGridInterpolator  # slow to import, and rarely needed

    while True:
        knots = [_spaced(term, *one) for one in zip(axes, counts, strict=True)]
        known = at(knots)
        errors = []
        for number in range(len(axes)):
            finer = [_finer(one) if number == place else one for place, one in enumerate(knots)]
            looked_up = RegularGridInterpolator(knots, known)(
                np.stack(np.meshgrid(*finer, indexing="ij"), axis=-1)
            )
            errors.append(float(np.max(np.abs(looked_up - at(finer)))))
        worst = int(np.argmax(errors))
        if sum(errors) <= tolerance or known.size > _MOST_ROWS:
            return PartTable(
                part=name, channel=channel, axes=axes, knots=tuple(knots), values=known
            )
        counts[worst] += max(1, counts[worst] // 4)


def _finer(knots: Array) -> Array:
    places = np.arange((len(knots) - 1) * _PARTS + 1) / _PARTS
    return np.interp(places, np.arange(len(knots)), knots)


def _validity(term: EmpiricalTerm, axis: str, tolerance: float) -> PartTable:
    """Return the table of the share that counts along one input: 1 where it was measured.

    A cubic that falls from 1 to 0 has the second derivative 6 at most.
    """
    steps = int(np.ceil(1 / np.sqrt(8 * tolerance / 6))) + 1
    away = np.linspace(0.0, 1.0, max(steps, 2))
    below, low, high, above = _ends(term, axis)
    if axis == "load":
        low, below = term.ranges[axis][0], term.ranges[axis][0] - (above - high)
    places = np.concatenate([low - (low - below) * away[::-1], high + (above - high) * away])
    falling = 1 - np.square(away) * (3 - 2 * away)
    values = np.concatenate([falling[::-1], falling])
    places, first = np.unique(np.exp(places) if axis == "speed" else places, return_index=True)
    return PartTable(
        part=VALIDITY, channel="both", axes=(axis,), knots=(places,), values=values[first]
    )


def tables_csv(
    tables: Sequence[PartTable], unit: str, load_unit: str, remarks: Sequence[str]
) -> str:
    """Return tables as CSV: remarks as comments, one row per knot.

    Parameters
    ----------
    tables : sequence of PartTable
        The tables.
    unit, load_unit : str
        Units of torque and of load.
    remarks : sequence of str
        Lines of comment.
    """
    units = {"position": "deg", "speed": "deg/s", "temperature": "°C", "load": load_unit}
    head = "part,torque,quantity 1,value 1,quantity 2,value 2,value"
    lines = [*(f"# {line}" for line in remarks), head]
    for table in tables:
        labels = [f"{axis} [{units[axis]}]" for axis in table.axes]
        if table.part == VALIDITY:
            labels = [f"absolute {one}" if one.startswith("load") else one for one in labels]
        own = "1" if table.part == VALIDITY else unit
        for knots, value in table.rows():
            cells = [f"{label},{knot:.9g}" for label, knot in zip(labels, knots, strict=True)]
            cells += [","] * (2 - len(cells))
            lines.append(f"{table.part} [{own}],{table.channel},{','.join(cells)},{value:.9g}")
    return "\n".join(lines) + "\n"
