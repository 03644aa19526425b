"""Agreement of velocity and position: change of position per integral of velocity."""

from dataclasses import dataclass, field

import numpy as np

from frictioncli.inspection.monitors.joint_rows import JointRows
from frictioncli.inspection.monitors.log_histogram import LogHistogram
from frictioncli.logs.channels import channel_names as names

_WIDTH = 8
_FEWEST = 20
_FAST = 0.3
"""Windows that travel less than this share of the farthest are not used. [-]"""


@dataclass(slots=True)
class VelocityAgreementMonitor:
    """Collects the ratio of the change of position to the integral of velocity."""

    _ratios: LogHistogram = field(default_factory=LogHistogram)
    _farthest: float = 0.0

    def update(self, rows: JointRows) -> None:
        """Add the next rows."""
        velocity = rows.channel(names.VELOCITY)
        if velocity is None or len(velocity) <= _WIDTH:
            return
        time, position = rows.window.rows.time, rows.required(names.POSITION)
        step = np.diff(time)
        area = np.where(rows.contiguous[1:], step * (velocity[1:] + velocity[:-1]) / 2, np.nan)
        by_velocity = np.lib.stride_tricks.sliding_window_view(area, _WIDTH).sum(axis=1)
        by_position = position[_WIDTH:] - position[:-_WIDTH]
        distance = np.abs(by_velocity)
        self._farthest = max(self._farthest, float(np.nanmax(distance, initial=0.0)))
        with np.errstate(invalid="ignore", divide="ignore"):
            far = (distance > _FAST * self._farthest) & (distance > 0)
            self._ratios.add(by_position[far] / by_velocity[far])

    def result(self) -> float | None:
        """Return the median ratio [-], 1 where the two agree; None without enough motion."""
        return self._ratios.quantile(0.5) if self._ratios.total >= _FEWEST else None
