"""Remarks on irregularities of a file, each with its kind, by which remarks are grouped."""

from collections.abc import Iterator
from dataclasses import dataclass

from frictioncli.inspection.findings import ChannelInspection, FileInspection, JointInspection
from frictioncli.inspection.monitors.sampling import Sampling
from frictioncli.inspection.other_clocks import OtherClock
from frictioncli.quantities import TORQUE

_LEAST_JITTER = 0.1
"""Least jitter that is mentioned, as a share of the period. [-]"""

_LEAST_SHORTFALL = 0.05
"""Least shortfall of the actual rate that is mentioned. [-]"""

_UPTIME = (60.0, 1e9)
"""A clock that begins in this range counts from the start of the controller. [s]"""

_VELOCITY_TOLERANCE = 0.05
"""Tolerated disagreement of velocity and position. [-]"""

_RATE_TOLERANCE = 1e-4
_DIFFERENCE_TOLERANCE = 0.01
"""Tolerated differences of two clocks in rate [-] and time [s]."""

_STATIONARY = 0.5
"""Range of position below which a joint is stationary. [deg]"""

_FINE = 5000.0
"""Number of steps in the range of a channel above which they are not mentioned."""

_UNITS = {
    "position": "deg",
    "velocity": "deg/s",
    "torque": TORQUE,
    "motor_temperature": "°C",
    "housing_temperature": "°C",
    "load": "N·m",
    "payload": "kg",
}


@dataclass(frozen=True, slots=True)
class Remark:
    """A remark: its kind in one word or two, and the sentence."""

    kind: str
    text: str


def remarks(found: FileInspection) -> tuple[Remark, ...]:
    """Return the remarks on a file."""
    return (
        *(
            Remark(reason.replace("_", " "), f"{count} of {found.rows} rows rejected: {reason}")
            for reason, count in sorted(found.rejected.items())
        ),
        *(() if found.sampling is None else _sampling_remarks(found.sampling)),
        *(Remark("clocks", _clock_text(clock)) for clock in found.clocks if _departs(clock)),
        *(
            Remark(remark.kind, f"joint {joint.joint}: {remark.text}")
            for joint in found.joints
            for remark in _joint_remarks(joint)
        ),
        *(Remark("note", text) for text in found.notes),
    )


def is_stationary(found: JointInspection) -> bool:
    """Return whether a joint is stationary in a file."""
    position = next(c for c in found.channels if c.quantity == "position")
    return position.highest - position.lowest < _STATIONARY


def unit_of(quantity: str, torque_unit: str) -> str:
    """Return the unit in which a quantity is shown.

    Parameters
    ----------
    quantity : str
        Canonical name of the quantity.
    torque_unit : str
        Unit of the torque: ``N·m`` or ``A``.

    Examples
    --------
    >>> unit_of("velocity", "A"), unit_of("torque", "A")
    ('deg/s', 'A')
    """
    unit = _UNITS[quantity]
    return torque_unit if unit == TORQUE else unit


def _departs(clock: OtherClock) -> bool:
    return abs(clock.rate - 1) > _RATE_TOLERANCE or clock.departs_s > _DIFFERENCE_TOLERANCE


def _clock_text(clock: OtherClock) -> str:
    return (
        f"{clock.column} is another clock, not used: {clock.rate:.6g} times as fast, departs by up"
        f" to {clock.departs_s:.3g} s"
    )


def _sampling_remarks(found: Sampling) -> Iterator[Remark]:
    period = found.nominal_period_s
    if found.jitter_s > _LEAST_JITTER * period:
        yield Remark("jitter", f"uneven times: jitter {found.jitter_s:.3g} s at {period:.4g} s")
    without_gaps = max(found.duration_s - found.gaps_s, period)
    if (
        period > 0
        and found.rate_hz * found.duration_s * period < (1 - _LEAST_SHORTFALL) * without_gaps
    ):
        between = found.rate_hz * found.duration_s / without_gaps
        yield Remark(
            "rate",
            f"{between:.4g} Hz in fact, where the usual step of {period:.4g} s means"
            f" {1 / period:.4g} Hz",
        )
    if found.gaps:
        longest = found.longest_gaps[0]
        plural = "s" if found.gaps > 1 else ""
        yield Remark(
            "gaps",
            f"{found.gaps} gap{plural} of more than five periods, longest {longest.seconds:.3g} s"
            f" after {longest.at_s:.4g} s (line {longest.line})",
        )
    if found.missing_samples:
        yield Remark("missing", f"{found.missing_samples} samples missing between others")
    if found.duplicated_times:
        yield Remark("duplicated", f"{found.duplicated_times} rows repeat the time before")
    if found.backward_times > len(found.resets):
        back = found.backward_times - len(found.resets)
        yield Remark("disorder", f"{back} rows go back in time")
    for reset in found.resets[:3]:
        yield Remark(
            "reset",
            f"clock set back at line {reset.line}: from {reset.before_s:.4g} to"
            f" {reset.after_s:.4g} s",
        )
    if _UPTIME[0] < found.begins_s < _UPTIME[1]:
        yield Remark("uptime", f"the clock starts at {found.begins_s:.3f} s, not at 0")


def _joint_remarks(found: JointInspection) -> Iterator[Remark]:
    if is_stationary(found):
        return
    for channel in found.channels:
        if channel.constant and "temperature" not in channel.quantity:
            yield Remark("constant", f"{channel.column} is constant")
    if (
        found.velocity_agreement is not None
        and abs(found.velocity_agreement - 1) > _VELOCITY_TOLERANCE
    ):
        yield Remark(
            "velocity",
            f"position changes {found.velocity_agreement:.3g} times as much as the velocity says",
        )
    if found.held_samples:
        yield Remark(
            "held",
            f"{found.held_samples} held samples: all channels repeat while it moves, first in line"
            f" {found.held_line}",
        )
    for limit in found.limits:
        yield Remark(
            "limit",
            f"torque stays at {limit.torque:.4g} {found.torque_unit} for up to {limit.longest}"
            f" samples, {100 * limit.share:.2g} % of the motion: saturated?",
        )
    for spikes in found.spikes:
        unit = unit_of(spikes.quantity, found.torque_unit)
        plural = "s" if spikes.count > 1 else ""
        yield Remark(
            "spikes",
            f"{spikes.count} spike{plural} in {spikes.quantity}, up to {spikes.farthest:.3g}"
            f" {unit}, first in line {spikes.line}",
        )
    if found.frozen_spans:
        yield Remark(
            "frozen",
            f"torque exactly constant at standstill for {found.frozen_s:.3g} s in"
            f" {found.frozen_spans} stretch{'es' * (found.frozen_spans > 1)}: brake closed?",
        )
    if found.brake_closed_s:
        yield Remark("brake", f"brake closed for {found.brake_closed_s:.3g} s")


def is_coarse(channel: ChannelInspection) -> bool:
    """Return whether the resolution of a channel is coarse enough to be mentioned."""
    if channel.grid is None:
        return False
    return channel.highest - channel.lowest < _FINE * channel.grid.step
