"""Properties of the joint that are there beyond doubt and have no name."""

from collections.abc import Collection, Sequence

from frictioncli.diagnosis.search.cause import Cause
from frictioncli.diagnosis.search.cause_selection import BEYOND_DOUBT
from frictioncli.diagnosis.search.structure import Structure
from frictioncli.effects.thermal_lag import EFFECT as THERMAL_LAG


def beyond_doubt_without_a_name(
    causes: Sequence[Cause], named: Collection[str], margin: float
) -> tuple[Cause, ...]:
    """Return the properties of the joint without a name that are there beyond doubt.

    They are physically impossible as effects of the catalogue, or not determined, or a new run
    contradicts them, but they are not nothing.

    Parameters
    ----------
    causes : sequence of Cause
        Everything that the search found, with its standing.
    named : collection of str
        Effects that have a name.
    margin : float
        Smallest size worth a name. [N·m]
    """
    return tuple(
        one
        for one in causes
        if one.standing in ("undetermined", "visible")
        and one.fit.effect.name not in named
        and not one.fit.effect.measurement
        and one.test.p_value < BEYOND_DOUBT
        and one.visible_interval[0] > margin
    )


def change_over_time(causes: Sequence[Cause]) -> Structure | None:
    """Return a change of the torque in one direction as structure along time; None without one.

    One that comes and goes from pair to pair is not smooth enough to be found as structure. What a
    lag of the gear describes on the runs seen alone varies with time, too.

    Parameters
    ----------
    causes : sequence of Cause
        What is there beyond doubt and has no name.
    """
    changes = [
        one
        for one in causes
        if one.shown.one_direction
        or (one.fit.effect.name == THERMAL_LAG.name and one.standing == "visible")
    ]
    if not changes:
        return None
    one = max(changes, key=lambda cause: cause.test.statistic)
    return Structure(
        axes=("time",),
        channel=one.fit.effect.channel,
        p_value=one.test.p_value,
        statistic=one.test.statistic,
        size=one.visible,
        interval=one.visible_interval,
    )
