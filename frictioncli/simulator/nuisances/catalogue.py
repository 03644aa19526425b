"""All nuisances by name, requests for them, and their sizes drawn from a seed."""

import math
from zlib import crc32

import numpy as np

from frictioncli.errors import OptionError
from frictioncli.simulator.nuisances.definition import Nuisance, Nuisances, PresentNuisance
from frictioncli.simulator.nuisances.disturbances import DISTURBANCES
from frictioncli.simulator.planted.effect import Range, log_uniform, uniform

ALL = "all"
"""Request for every nuisance, each with an ordinary size drawn from the seed."""

SHARE = (0.2, 0.6)
"""Ordinary range of a weak disturbance's root mean square [% of the mean friction]."""

_STREAM = 2_000_000
"""Keeps the random numbers of nuisances apart from those of runs and effects."""

_TURN = 2.0 * math.pi


def _sensor_step(generator: np.random.Generator) -> float:
    # either has a change at the half degrees, where recordings of the thermal cycle begin
    return float(generator.choice((0.2, 1.0)))


_OF_LOG_AND_JOINT = (
    Nuisance(
        name="torque_delay",
        unit="s",
        lowest=0.0,
        highest=0.1,
        draw=uniform(0.0, 0.018),
        description="torque is logged this much later than position",
    ),
    Nuisance(
        name="torque_filter",
        unit="s",
        lowest=0.0,
        highest=0.2,
        draw=uniform(0.0, 0.04),
        description="time constant of the drive's first-order torque filter",
    ),
    Nuisance(
        name="gravity_constant",
        unit="N·m",
        lowest=-50.0,
        highest=50.0,
        draw=uniform(-4.0, 4.0),
        description="constant part of the gravity torque, which the gear carries",
    ),
    Nuisance(
        name="torque_offset",
        unit="N·m",
        lowest=-50.0,
        highest=50.0,
        draw=uniform(-4.0, 4.0),
        description="offset of the torque sensor, which loads nothing",
    ),
    Nuisance(
        name="move_noise",
        unit="N·m",
        lowest=0.0,
        highest=10.0,
        draw=uniform(0.2, 0.6),
        description="standard deviation of autoregressive torque noise along a move",
        parameters=(Range("correlation_time", uniform(0.1, 0.5), "s", "correlation time"),),
    ),
    Nuisance(
        name="speed_ripple",
        unit="%",
        lowest=0.0,
        highest=5.0,
        draw=uniform(0.02, 0.1),
        description="amplitude of velocity that is not constant along a move",
        parameters=(
            Range("order", uniform(4.0, 12.0), "1/turn", "periods per turn of the joint"),
            Range("phase", uniform(0.0, _TURN), "rad", "phase"),
        ),
    ),
    Nuisance(
        name="backlash",
        unit="deg",
        lowest=0.0,
        highest=1.0,
        draw=uniform(0.0, 0.05),
        description="position logged forward less position logged in reverse, at the same angle",
    ),
    Nuisance(
        name="velocity_scale",
        unit="%",
        lowest=-5.0,
        highest=5.0,
        draw=uniform(-0.2, 0.2),
        description="excess of the logged velocity, as of a clock that runs slow",
    ),
    Nuisance(
        name="sensor_lag",
        unit="s",
        lowest=0.0,
        highest=600.0,
        draw=uniform(0.0, 120.0),
        description="time constant of the motor's temperature sensor",
    ),
    Nuisance(
        name="sensor_step",
        unit="°C",
        lowest=0.0,
        highest=2.0,
        draw=_sensor_step,
        description="resolution of the registered motor temperature",
    ),
    Nuisance(
        name="ambient_swing",
        unit="K",
        lowest=0.0,
        highest=10.0,
        draw=uniform(0.5, 2.5),
        description="amplitude of the ambient temperature over the day",
        parameters=(
            Range("warmest", uniform(5.0, 9.0), "h", "warmest hour since the run's start"),
            Range("cycle", uniform(0.05, 0.2), "-", "amplitude of the air conditioning, as share"),
            Range("cycle_period", log_uniform(0.5, 2.0), "h", "its period"),
        ),
    ),
    Nuisance(
        name="friction_zones",
        unit="-",
        lowest=0.0,
        highest=0.2,
        draw=uniform(0.04, 0.08),
        description="spread of the speed exponents of three friction zones about 1/2; the rates"
        " at which they thin differ, too",
    ),
    Nuisance(
        name="other_joint",
        unit="N·m",
        lowest=0.0,
        highest=20.0,
        draw=uniform(0.5, 2.0),
        description="torque of another joint that still moves when some recordings begin",
        parameters=(
            Range("duration", uniform(3.0, 10.0), "s", "until it stands"),
            Range("share", uniform(0.05, 0.2), "-", "share of the recordings"),
        ),
    ),
)

NUISANCES: dict[str, Nuisance] = {
    one.name: one
    for one in (
        *_OF_LOG_AND_JOINT,
        *(
            Nuisance(
                name=effect.name,
                unit="% of mean friction",
                lowest=0.0,
                highest=10.0,
                draw=uniform(*SHARE),
                description=effect.equation,
                parameters=effect.parameters,
            )
            for effect in DISTURBANCES
        ),
    )
}
"""Nuisances by name: of the log, of the joint, and weak disturbances that no catalogue knows."""


def requested_nuisances(texts: tuple[str, ...], seed: int) -> Nuisances:
    """Return the nuisances that are requested as ``NAME``, ``NAME:SIZE`` or ``all``.

    Parameters
    ----------
    texts : tuple of str
        Requests; one by name goes before ``all``, and a size of 0 takes a nuisance away.
    seed : int
        Source of parameters, and of sizes not given.

    Returns
    -------
    Nuisances
        Those whose size is not 0.

    Raises
    ------
    OptionError
        If a name is unknown or comes twice, or a size is out of its range.

    Examples
    --------
    >>> requested_nuisances(("torque_delay:0.012",), seed=1).size("torque_delay")
    0.012
    """
    asked = [text.strip().partition(":") for text in texts]
    names = [name for name, _, _ in asked]
    for name in names:
        if names.count(name) > 1:
            raise OptionError(
                f"nuisance {name} is asked for {names.count(name)} times, expected one"
            )
    sizes: dict[str, float | None] = dict.fromkeys(NUISANCES) if ALL in names else {}
    sizes |= {name: _size(name, colon, size) for name, colon, size in asked if name != ALL}
    present = (_present(NUISANCES[name], size, seed) for name, size in sizes.items())
    return Nuisances(present=tuple(one for one in present if one.size != 0.0), seed=seed)


def _size(name: str, colon: str, text: str) -> float | None:
    """Return the size that is asked for; none if it is to be drawn."""
    if name not in NUISANCES:
        raise OptionError(
            f"nuisance {name!r} is unknown, expected {ALL} or one of {', '.join(NUISANCES)}"
        )
    if not colon:
        return None
    kind = NUISANCES[name]
    try:
        size = float(text)
    except ValueError:
        size = math.nan
    if not kind.lowest <= size <= kind.highest:
        raise OptionError(
            f"nuisance {name}:{text}: expected a number from {kind.lowest:g} to"
            f" {kind.highest:g} {kind.unit}"
        )
    return size


def _present(kind: Nuisance, size: float | None, seed: int) -> PresentNuisance:
    key = (_STREAM, crc32(kind.name.encode()))
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
    drawn = kind.draw(generator)
    return PresentNuisance(
        definition=kind,
        size=drawn if size is None else size,
        parameters={one.name: one.draw(generator) for one in kind.parameters},
    )
