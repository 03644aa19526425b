"""Blocks about the place where structure without a name shows: a speed, an angle, a temperature."""

import random
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from frictioncli.design.blocks import Block, short_series
from frictioncli.design.limits import Limits
from frictioncli.design.predicted_rows import SETTLING
from frictioncli.design.steps import ACCELERATION, HeatStep, RestStep, SeriesStep
from frictioncli.diagnosis.empirical.form_columns import MIDDLE_TEMPERATURE
from frictioncli.diagnosis.empirical.term import FormFunction

_SPEEDS = 8
"""Speeds about that of a peak."""

_FLANK = 2.5
"""Distance from a peak, in standard deviations, up to which its flank is measured."""

_MOVE_TIME = 20.0
"""Longest time for one move. [s]"""

_LEAST_HALF = 15.0
"""Least half stroke about an angle. [deg]"""

_HEATING = 600.0
"""Longest time of heating to one temperature, and of cooling past it. [s]"""


def blocks_about(forms: Sequence[FormFunction], limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return blocks that measure closely where forms show, and what changes them there.

    Parameters
    ----------
    forms : sequence of FormFunction
        Forms that describe structure without a name.
    limits : Limits
        Limits of the joint.
    seed : int
        Seed of the random orders of speeds.

    Returns
    -------
    tuple of Block
        None for forms that have no place, and for places beyond the limits.
    """
    found: list[Block] = []
    for form in forms:
        if "centre" in form.shape and form.axes[0] in _ABOUT:
            found += _ABOUT[form.axes[0]](form, limits, seed)
    return tuple(found)


def _about_speed(form: FormFunction, limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return speeds on both flanks of a peak in random order, cold, and warm where it may move."""
    centre, reach = form.shape["centre"], _FLANK * form.shape["width"]
    # where it goes with temperature, from where it is at 25 °C to where it is in a hot joint
    moved = [0.0]
    if "shift" in form.shape:
        ends = (25.0, limits.hottest)
        moved = [form.shape["shift"] * (one - MIDDLE_TEMPERATURE) for one in ends]
    ends = (centre * np.exp(min(moved) - reach), centre * np.exp(max(moved) + reach))
    highest = min(limits.fastest, limits.highest_useful)
    low, high = np.clip(ends, max(limits.slowest, limits.stroke / (2 * _MOVE_TIME)), highest)
    speeds = sorted({limits.speed(float(one)) for one in np.geomspace(low, high, _SPEEDS)})
    if len(speeds) < 3:
        return ()
    random.Random(seed).shuffle(speeds)
    series = SeriesStep(speeds=tuple(speeds), low=limits.low, high=limits.high)
    heat = HeatStep(
        speed=limits.speed(highest),
        low=limits.low,
        high=limits.high,
        seconds=_HEATING,
        until=limits.hottest,
    )
    return (
        Block(
            name=f"speeds about {centre:.3g} deg/s",
            reason="speeds close together on both sides of the peak: its position, width and"
            " dependence",
            steps=(series,),
        ),
        Block(
            name=f"heat, speeds about {centre:.3g} deg/s",
            reason="the same in a warmer joint: a resonance stays at its speed, a change of"
            " lubrication shifts",
            steps=(heat, series),
        ),
    )


def _about_angle(form: FormFunction, limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return short moves over an angle at many speeds in random order."""
    centre, width = form.shape["centre"], form.shape["width"]
    half = max(2 * _FLANK * width, _LEAST_HALF)
    low, high = max(limits.low, centre - half), min(limits.high, centre + half)
    # constant speed over the nearer flanks
    room = min(centre - low, high - centre) - 2 * width
    if room <= 0:
        return ()
    lost = SETTLING * ACCELERATION
    fastest = min(float(np.sqrt(lost**2 + 2 * ACCELERATION * room)) - lost, limits.fastest)
    slowest = max(limits.slowest, (high - low) / _MOVE_TIME)
    if slowest > fastest:
        return ()
    speeds = sorted({limits.speed(float(one)) for one in np.geomspace(slowest, fastest, 6)})
    random.Random(seed).shuffle(speeds)
    return (
        Block(
            name=f"angles about {centre:.3g} deg",
            reason="angles close together at many speeds: damage stays at its angle, the effect"
            " of a late torque shifts",
            steps=(SeriesStep(speeds=tuple(speeds), low=low, high=high),),
        ),
    )


def _about_temperature(form: FormFunction, limits: Limits, seed: int) -> tuple[Block, ...]:
    """Return series on both flanks of a temperature, warming and then cooling."""
    centre, reach = form.shape["centre"], _FLANK * form.shape["width"]
    speed = limits.speed(min(limits.fastest, limits.highest_useful))
    until = [one for one in np.linspace(centre - reach, centre + reach, 5) if one <= limits.hottest]
    if len(until) < 3:
        return ()
    steps = [
        part
        for one in until
        for part in (
            HeatStep(
                speed=speed,
                low=limits.low,
                high=limits.high,
                seconds=_HEATING,
                until=float(one),
            ),
            short_series(limits),
        )
    ]
    return (
        Block(
            name=f"heat through {centre:.3g} °C",
            reason="series on both sides of the temperature, warming and cooling: an effect of"
            " temperature appears at the same temperature in both",
            steps=(*steps, RestStep(_HEATING), short_series(limits)),
        ),
        Block(
            name=f"heat to {centre:.3g} °C",
            reason="series at that temperature, at several speeds",
            steps=(steps[2 * (len(until) // 2)], short_series(limits)),
        ),
    )


_ABOUT: Mapping[str, Callable[[FormFunction, Limits, int], tuple[Block, ...]]] = {
    "speed": _about_speed,
    "position": _about_angle,
    "temperature": _about_temperature,
}
"""Blocks about a place on each axis."""
