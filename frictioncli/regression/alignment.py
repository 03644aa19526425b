"""Regressions of joints whose torque may be late, with the torque of each row at its own moment.

The equation of motion depends on the delay by Taylor series, which hold while the motion hardly
changes within the delay. A start with 400 deg/s² changes it within 20 ms by more than that: the
delay found is then too small, and so is the inertia. So the samples are read again with the torque
that was logged so much later, and the regression is repeated about the delay that was found,
until next to nothing is left of it: Gauss-Newton steps with the exact model of the delay. What then
proves to be no delay, or what friction may do as well
(:mod:`frictioncli.regression.friction_rivals`), is left out of the equation.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Protocol

import pyarrow as pa

from frictioncli.errors import NotEnoughData
from frictioncli.regression.determination import JointRegression
from frictioncli.regression.estimate import RegressionEstimate
from frictioncli.regression.identification import LONGEST_DELAY, identify, some_equations
from frictioncli.regression.motion_rows import MotionLog, motion_rows
from frictioncli.regression.unknown_delay import allowing_for_delay

_NEAR = 5e-4
"""Distance from the known delay within which the series hold as well as any log needs. [s]"""

_PASSES = 4
"""Most times that the samples are read again."""

_AT_BOUND = 0.999
"""Share of the greatest delay from which a delay is at that bound."""

Regressed = tuple[MotionLog, JointRegression]
"""Rows of a joint, and their regression."""


class RegressJoint(Protocol):
    """Regression of the rows of a joint, whose torque may be late or is not."""

    def __call__(self, joint: int, motion: MotionLog, *, late: bool) -> JointRegression:
        """Return the regression; raise `NotEnoughData` where there is none."""


def aligned_regressions(
    read: Callable[[], Iterable[pa.RecordBatch]],
    motions: Mapping[int, MotionLog],
    regress_joint: RegressJoint,
) -> dict[int, Regressed | NotEnoughData]:
    """Return the regression of each joint about the delay of its torque.

    Parameters
    ----------
    read : callable
        Returns the batches of a table of samples from its start; called only if a torque is late.
    motions : mapping of int to MotionLog
        Rows by joint.
    regress_joint : callable
        Regresses the rows of a joint, with or without a delay.

    Returns
    -------
    dict of int to (MotionLog, JointRegression) or NotEnoughData
        The rows and what was found, or why there is nothing, in the order of the joints given.
    """

    def attempt(joint: int, motion: MotionLog, *, late: bool = True) -> Regressed | NotEnoughData:
        try:
            return motion, regress_joint(joint, motion, late=late)
        except NotEnoughData as fault:
            return fault

    found = {joint: attempt(joint, motion) for joint, motion in motions.items()}
    aligned: set[int] = set()
    for _ in range(_PASSES):
        delays = {
            joint: one[1].estimate.delay
            for joint, one in found.items()
            if not isinstance(one, NotEnoughData) and _is_far(*one)
        }
        if not delays:
            break
        aligned |= delays.keys()
        for width in sorted({motions[joint].step_time for joint in delays}):
            own = {joint: delays[joint] for joint in delays if motions[joint].step_time == width}
            for joint, motion in motion_rows(read(), step_time=width, delays=own).items():
                found[joint] = attempt(joint, motion)
    doubted: dict[int, tuple[RegressionEstimate, RegressionEstimate]] = {}
    for joint in aligned:
        one = found[joint]
        if isinstance(one, NotEnoughData) or _is_at_bound(one[1].estimate):
            found[joint] = attempt(joint, motions[joint], late=False)
            continue
        late, beside = one[1].estimate, _beside_rivals(one[1])
        if not _is_late(late, beside):
            found[joint] = attempt(joint, motions[joint], late=False)
            doubted[joint] = late, beside
    for joint, one in found.items():
        if not isinstance(one, NotEnoughData):
            motion, regression = one
            found[joint] = (
                motion,
                allowing_for_delay(regression, *doubted.get(joint, (regression.late, None))),
            )
    return found


def _is_far(motion: MotionLog, found: JointRegression) -> bool:
    """Return whether there is a delay, and not near the one that the rows are free of."""
    estimate = found.estimate
    return estimate.terms.delay and abs(estimate.delay - motion.known_delay) > _NEAR


def _is_at_bound(late: RegressionEstimate) -> bool:
    """Return whether the delay is one that no log has."""
    return abs(late.delay) >= _AT_BOUND * LONGEST_DELAY


def _beside_rivals(found: JointRegression) -> RegressionEstimate:
    """Return a fit with the delay beside what friction may do as well."""
    return identify(some_equations(found.equations), replace(found.estimate.terms, rivals=True))


def _is_late(late: RegressionEstimate, beside: RegressionEstimate) -> bool:
    """Return whether the delay is told from none, and no friction's doing."""
    (low, high), (least, most) = (one.interval("delay") for one in (late, beside))
    return late.told("delay") and beside.told("delay") and low <= most and least <= high
