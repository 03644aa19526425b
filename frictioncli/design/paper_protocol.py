"""Algorithms 1 and 2 of the paper as a programme, for a joint without any data.

The speeds are the published ones [1]_, scaled down where the highest speed is lower.

References
----------
.. [1] M. N. Nevmerzhitskiy, B. S. Notkin, A. V. Vara, and K. V. Zmeu, "Friction model of industrial
   robot joint with temperature correction by example of KUKA KR10," J. Robotics, 2019,
   doi:10.1155/2019/6931563.
"""

from frictioncli.design.blocks import Block
from frictioncli.design.limits import DEFAULT_HOTTEST, Limits
from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import HeatStep, RestStep, SeriesStep
from frictioncli.errors import OptionError

SWEEP = (2.3, 4.2, 7.6, 12.4, 19.1, 28.0, 39.4, 52.0, 67.5, 84.0, 101.2)
"""Speeds of the sweep, from the published lowest to the published highest. [deg/s]"""

CYCLE = (19.1, 39.4, 67.5, 101.2)
"""Speeds of the thermal cycle. [deg/s]"""

COLDEST = 25
"""Motor temperature at the start and at the end of the cycle. [°C]"""

_LONGEST_HEATING = 900.0
_LONGEST_COOLING = 3600.0
"""Longest time per degree. [s]"""

HEATING_MINUTES = 100.0
COOLING_MINUTES = 300.0
"""Duration of heating and of cooling between 25 and 65 °C in the paper. [min]"""


def new_limits(settings: PlanSettings) -> Limits:
    """Return the limits of a joint without data.

    Parameters
    ----------
    settings : PlanSettings
        Limits that the user sets.

    Returns
    -------
    Limits
        The limits.

    Raises
    ------
    OptionError
        If the user does not set them all: without data it is not known what is safe.
    """
    needed = (
        ("--joint", settings.joint),
        ("--from", settings.low),
        ("--to-angle", settings.high),
        ("--max-speed", settings.max_speed),
    )
    missing = [name for name, value in needed if value is None]
    if missing:
        raise OptionError(
            f"--new needs {', '.join(missing)}: without data the safe limits are not known"
        )
    low, high, fastest = settings.low, settings.high, settings.max_speed
    assert low is not None
    assert high is not None
    assert fastest is not None  # else they are missing
    hottest = settings.max_temperature or DEFAULT_HOTTEST
    if hottest < COLDEST + 1:
        raise OptionError(
            f"--max-temperature {hottest:g} °C: expected {COLDEST + 1} °C or more; the paper heats"
            f" from {COLDEST} °C"
        )
    rated = settings.rated_speed
    if rated is not None and fastest > rated:
        raise OptionError(
            f"--max-speed {fastest:g} deg/s: expected at most --rated-speed {rated:g} deg/s"
        )
    step = None if rated is None else rated / 100
    return Limits(
        low=low,
        high=high,
        slowest=min(max(SWEEP[0] * _scale(fastest), step or 0.0), fastest),
        fastest=fastest,
        hottest=hottest,
        speed_step=step,
    )


def algorithms(limits: Limits) -> tuple[Block, ...]:
    """Return speed sweep, heating and cooling as blocks, with a series per degree."""
    scale = _scale(limits.fastest)

    def series(speeds: tuple[float, ...]) -> SeriesStep:
        scaled = {limits.speed(one * scale) for one in speeds}
        held = tuple(sorted(one for one in scaled if one <= limits.highest_useful))
        return SeriesStep(speeds=held, low=limits.low, high=limits.high)

    heating = min(limits.fastest, limits.highest_useful)
    warmer = [
        step
        for level in range(COLDEST, int(limits.hottest) + 1)
        for step in (
            HeatStep(
                speed=limits.speed(heating),
                low=limits.low,
                high=limits.high,
                seconds=_LONGEST_HEATING if level > COLDEST else 4 * _LONGEST_HEATING,
                until=float(level),
            ),
            series(CYCLE),
        )
    ]
    colder = [
        step
        for level in range(int(limits.hottest) - 1, COLDEST - 1, -1)
        for step in (RestStep(_LONGEST_COOLING, float(level)), series(CYCLE))
    ]
    return (
        Block(
            name="Algorithm 1, speed sweep",
            reason="one pair per speed from slow to fast, cold: load and the law of speed",
            steps=(series(SWEEP),),
        ),
        Block(
            name="Algorithm 2, heating",
            reason="four speeds at every degree while the joint heats by fast moves",
            steps=tuple(warmer),
        ),
        Block(
            name="Algorithm 2, cooling",
            reason="the same at every degree while the joint cools at rest",
            steps=tuple(colder),
        ),
    )


def usual_seconds(limits: Limits) -> float:
    """Return the duration of the programme by the times of the paper [s]."""
    share = (limits.hottest - COLDEST) / (DEFAULT_HOTTEST - COLDEST)
    return 60 * share * (HEATING_MINUTES + COOLING_MINUTES)


def _scale(fastest: float) -> float:
    return min(1.0, fastest / SWEEP[-1])
