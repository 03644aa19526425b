"""The motor temperature of a run, put together from its recordings."""

from collections.abc import Sequence

import numpy as np

from frictioncli.logs.samples import quantized_temperature
from frictioncli.logs.samples.quantized_temperature import Changes, Knots
from frictioncli.logs.samples.temperature_register import TemperatureRegister
from frictioncli.logs.samples.timeline import Timeline


def run_knots(timeline: Timeline, joint: int) -> tuple[Knots | None, ...]:
    """Return, for each recording of a joint, the known temperatures to interpolate between.

    Where start times are known the whole run serves every recording; where they were invented each
    recording stands alone. None where a joint's register shows no staircase or too few changes.
    """
    shown = [
        (placed.start, placed.recorded.registers[joint])
        for placed in timeline.placed
        if joint in placed.recorded.registers
    ]
    levels = {level for _, register in shown for level in register.levels}
    step = quantized_temperature.find_step(np.array(sorted(levels)))
    if step is None:
        return (None,) * len(shown)
    if timeline.known:
        return (_knots(shown, step),) * len(shown)
    return tuple(_knots([one], step) for one in shown)


def _knots(shown: Sequence[tuple[float, TemperatureRegister]], step: float) -> Knots | None:
    parts = [(start, change) for start, register in shown for change in register.changes]
    begins = [start + register.first for start, register in shown if register.first is not None]
    ends = [start + register.last[0] for start, register in shown if register.last is not None]
    if not parts or not begins or not ends:
        return None
    changes = Changes(
        np.concatenate([start + change.time for start, change in parts]),
        np.concatenate([change.before for _, change in parts]),
        np.concatenate([change.after for _, change in parts]),
    )
    return quantized_temperature.knots(changes, step=step, span=(begins[0], ends[-1]))
