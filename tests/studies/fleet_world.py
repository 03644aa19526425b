"""The fleet of the study: joints of which it is known what is the matter with them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.fleet.joints import Joint, write_joint

WEAR = 1.5
"""Friction that the last run of a worn joint has beyond the others. [N·m]"""

KINDS = ("sound", "worn", "lagging", "bad")

DAY_TO_DAY = 0.1
"""Standard deviation of the offset that every run of every joint has. [N·m]"""

_AXES = 6
_BLOCK = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """A joint of the fleet.

    Attributes
    ----------
    robot, joint : str, int
        Which one.
    kind : str
        What is the matter with it, one of :data:`KINDS`.
    """

    robot: str
    joint: int
    kind: str


def kind_of(number: int) -> str:
    """Return the kind of a joint: of twenty, two are worn, one lags, one has logs of no use."""
    return {4: "worn", 9: "lagging", 14: "worn", 19: "bad"}.get(number % _BLOCK, "sound")


def write_world(folder: Path, joints: int) -> list[Member]:
    """Write the logs of so many joints, six to a robot."""
    members = []
    for number in range(joints):
        member = Member(
            robot=f"R{number // _AXES:03d}", joint=1 + number % _AXES, kind=kind_of(number)
        )
        place = folder / f"robot={member.robot}" / f"joint={member.joint}"
        joint = Joint(
            seed=number,
            runs=6,
            cycle=6,
            wear=WEAR if member.kind == "worn" else 0.0,
            lags=member.kind == "lagging",
            day_to_day=DAY_TO_DAY,
        )
        write_joint(place, joint, axis=member.joint)
        if member.kind == "bad":
            _SPOILERS[number // _BLOCK % len(_SPOILERS)](place)
        members.append(member)
    return members


def _each(spoil: Callable[[bytes], bytes]) -> Callable[[Path], None]:
    def spoiler(place: Path) -> None:
        for log in place.rglob("0*.csv"):
            log.write_bytes(spoil(log.read_bytes()))

    return spoiler


def _without_runs(place: Path) -> None:
    for run in list(place.iterdir()):
        run.rename(run.with_name(run.name.removeprefix("run=")))


_SPOILERS: list[Callable[[Path], None]] = [
    _each(lambda _: b""),
    _each(lambda _: b"\x00\x01\x02\x03" * 4096),
    _each(lambda text: text.replace(b"GearTorq", b"Something")),
    _each(lambda text: text.splitlines(keepends=True)[0]),
    _without_runs,
]
