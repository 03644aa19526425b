"""Monitor of a log: statistics of all channels, collected in one pass while it is read."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field

from frictioncli.arrays import Flags
from frictioncli.inspection.findings import ChannelInspection, JointInspection, Spikes
from frictioncli.inspection.monitors.constant_torque import ConstantTorqueMonitor
from frictioncli.inspection.monitors.joint_rows import JointRows, joint_rows
from frictioncli.inspection.monitors.repeated_samples import RepeatedSamplesMonitor, changes
from frictioncli.inspection.monitors.resolution import ResolutionMonitor
from frictioncli.inspection.monitors.sampling import Sampling, SamplingMonitor
from frictioncli.inspection.monitors.spikes import SpikeMonitor
from frictioncli.inspection.monitors.velocity_agreement import VelocityAgreementMonitor
from frictioncli.inspection.monitors.windows import Window, Windows
from frictioncli.inspection.unit_reasons import evidence, gear_ratio
from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.samples.chunks import LogChunk, PlannedLog

_MOTION_CHANNELS = (names.POSITION, names.VELOCITY, names.TORQUE)


@dataclass(slots=True)
class _JointMonitor:
    """Statistics of one joint."""

    channels: dict[str, ResolutionMonitor] = field(default_factory=dict)
    held: RepeatedSamplesMonitor = field(default_factory=RepeatedSamplesMonitor)
    torque: ConstantTorqueMonitor = field(default_factory=ConstantTorqueMonitor)
    agreement: VelocityAgreementMonitor = field(default_factory=VelocityAgreementMonitor)
    spikes: dict[str, SpikeMonitor] = field(default_factory=dict)

    def update(self, rows: JointRows, changed: Flags) -> None:
        for name in names.CHANNELS[1:]:
            values = rows.channel(name)
            if values is None:
                continue
            monitor = self.channels.setdefault(name, ResolutionMonitor())
            monitor.update(values[rows.new])
            if name in _MOTION_CHANNELS:
                spikes = self.spikes.setdefault(name, SpikeMonitor())
                spikes.update(rows, values, _step(monitor))
        self.held.update(rows, changed)
        self.torque.update(rows)
        self.agreement.update(rows)

    def result(self, plan: JointPlan, given: Collection[str]) -> JointInspection:
        position = self.channels.get(names.POSITION)
        held, line = self.held.result(0.0 if position is None else _step(position))
        frozen_spans, frozen_s = self.torque.frozen()
        return JointInspection(
            joint=plan.channels.joint,
            torque_unit=plan.torque_unit,
            torque_side=plan.torque_side,
            gear_ratio=gear_ratio(plan),
            channels=tuple(
                self._channel(plan, name, given) for name in plan.conversions if name != names.TIME
            ),
            velocity_agreement=self.agreement.result(),
            held_samples=held,
            held_line=line,
            limits=self.torque.limits(),
            spikes=tuple(
                Spikes(name, monitor.count, monitor.line, monitor.farthest)
                for name, monitor in self.spikes.items()
                if monitor.line is not None
            ),
            frozen_spans=frozen_spans,
            frozen_s=frozen_s,
        )

    def _channel(self, plan: JointPlan, name: str, given: Collection[str]) -> ChannelInspection:
        channel: LogChannel = getattr(plan.channels, name)
        monitor = self.channels.get(name, ResolutionMonitor())
        return ChannelInspection(
            quantity=name,
            column=channel.name,
            side=channel.meaning.side if name in _MOTION_CHANNELS else "",
            unit_found=channel.unit,
            unit_believed=plan.conversions[name].unit,
            evidence=evidence(plan, name, given, max(abs(monitor.lowest), abs(monitor.highest))),
            lowest=monitor.lowest,
            highest=monitor.highest,
            grid=monitor.grid(),
        )


def _step(monitor: ResolutionMonitor) -> float:
    grid = monitor.grid()
    return 0.0 if grid is None else grid.step


class LogMonitor:
    """Collects statistics of one log while it is read.

    Parameters
    ----------
    planned : PlannedLog
        The log.
    """

    def __init__(self, planned: PlannedLog) -> None:
        self._planned = planned
        self._windows = Windows()
        self._sampling = SamplingMonitor()
        self._joints = {plan.channels.joint: _JointMonitor() for plan in planned.plans}
        self.rows_read = 0

    def observe(self, chunks: Iterable[LogChunk]) -> Iterator[LogChunk]:
        """Yield the chunks of the log as they come, and collect statistics."""
        for chunk in chunks:
            self.rows_read += chunk.rows_read
            for window in self._windows.update(chunk.rows):
                self._update(window)
            yield chunk
        for window in self._windows.flush():
            self._update(window)

    def _update(self, window: Window) -> None:
        self._sampling.update(window)
        changed = changes(window)
        for joint, monitor in self._joints.items():
            monitor.update(joint_rows(window, joint, self._planned.period), changed)

    def sampling(self) -> Sampling | None:
        """Return the sampling of the log; None where it has no usable row."""
        return self._sampling.result()

    def joints(self, given: Collection[str]) -> tuple[JointInspection, ...]:
        """Return what the log holds of each joint.

        Parameters
        ----------
        given : collection of str
            Quantities whose unit the user gives.
        """
        return tuple(
            self._joints[plan.channels.joint].result(plan, given) for plan in self._planned.plans
        )
