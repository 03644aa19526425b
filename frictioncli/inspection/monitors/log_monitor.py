"""All rows of a log go by once; what they show is collected on the way."""

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
from frictioncli.logs.channels import aliases as names
from frictioncli.logs.channels.joint_plan import JointPlan
from frictioncli.logs.channels.recognition import LogChannel
from frictioncli.logs.samples.chunks import Chunk, PlannedLog

_SPIKY = (names.POSITION, names.VELOCITY, names.TORQUE)


@dataclass(slots=True)
class _JointMonitor:
    """Watches the rows of one joint."""

    channels: dict[str, ResolutionMonitor] = field(default_factory=dict)
    held: RepeatedSamplesMonitor = field(default_factory=RepeatedSamplesMonitor)
    torque: ConstantTorqueMonitor = field(default_factory=ConstantTorqueMonitor)
    agreement: VelocityAgreementMonitor = field(default_factory=VelocityAgreementMonitor)
    spikes: dict[str, SpikeMonitor] = field(default_factory=dict)

    def see(self, rows: JointRows, changed: Flags) -> None:
        for name in names.CHANNELS[1:]:
            values = rows.channel(name)
            if values is None:
                continue
            watch = self.channels.setdefault(name, ResolutionMonitor())
            watch.see(values[rows.new])
            if name in _SPIKY:
                spiky = self.spikes.setdefault(name, SpikeMonitor())
                spiky.see(rows, values, _step(watch))
        self.held.see(rows, changed)
        self.torque.see(rows)
        self.agreement.see(rows)

    def result(self, plan: JointPlan, told: Collection[str]) -> JointInspection:
        position = self.channels.get(names.POSITION)
        held, line = self.held.result(0.0 if position is None else _step(position))
        frozen_spans, frozen_s = self.torque.frozen()
        return JointInspection(
            joint=plan.channels.joint,
            torque_unit=plan.torque_unit,
            torque_side=plan.torque_side,
            gear_ratio=gear_ratio(plan),
            channels=tuple(
                self._channel(plan, name, told) for name in plan.conversions if name != names.TIME
            ),
            velocity_agreement=self.agreement.result(),
            held_samples=held,
            held_line=line,
            limits=self.torque.limits(),
            spikes=tuple(
                Spikes(name, watch.count, watch.line, watch.farthest)
                for name, watch in self.spikes.items()
                if watch.line is not None
            ),
            frozen_spans=frozen_spans,
            frozen_s=frozen_s,
        )

    def _channel(self, plan: JointPlan, name: str, told: Collection[str]) -> ChannelInspection:
        channel: LogChannel = getattr(plan.channels, name)
        watch = self.channels.get(name, ResolutionMonitor())
        return ChannelInspection(
            quantity=name,
            column=channel.name,
            side=channel.meaning.side if name in _SPIKY else "",
            unit_found=channel.unit,
            unit_believed=plan.conversions[name].unit,
            evidence=evidence(plan, name, told, max(abs(watch.lowest), abs(watch.highest))),
            lowest=watch.lowest,
            highest=watch.highest,
            grid=watch.grid(),
        )


def _step(watch: ResolutionMonitor) -> float:
    grid = watch.grid()
    return 0.0 if grid is None else grid.step


class LogMonitor:
    """Watches one log while it is read.

    Parameters
    ----------
    reading : PlannedLog
        The log about to be read.
    """

    def __init__(self, reading: PlannedLog) -> None:
        self._reading = reading
        self._windows = Windows()
        self._sampling = SamplingMonitor()
        self._joints = {plan.channels.joint: _JointMonitor() for plan in reading.plans}
        self.rows = 0

    def over(self, parts: Iterable[Chunk]) -> Iterator[Chunk]:
        """Yield the parts of the log as they come, having looked at them."""
        for part in parts:
            self.rows += part.rows
            for window in self._windows.see(part.block):
                self._see(window)
            yield part
        for window in self._windows.rest():
            self._see(window)

    def _see(self, window: Window) -> None:
        self._sampling.see(window)
        changed = changes(window)
        for joint, watch in self._joints.items():
            watch.see(joint_rows(window, joint, self._reading.period), changed)

    def sampling(self) -> Sampling | None:
        """Return how the log was sampled; None where it has no usable row."""
        return self._sampling.result()

    def joints(self, told: Collection[str]) -> tuple[JointInspection, ...]:
        """Return what the log holds of each joint.

        Parameters
        ----------
        told : collection of str
            Quantities whose unit the user gives.
        """
        return tuple(
            self._joints[plan.channels.joint].result(plan, told) for plan in self._reading.plans
        )
