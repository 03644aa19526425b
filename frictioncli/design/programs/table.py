"""The programme as a table: for people, and for controllers that read one."""

from frictioncli.design.programs.programme import Programme
from frictioncli.design.steps import (
    DWELL,
    LEAD,
    MOUNTING,
    HeatStep,
    RestStep,
    SeriesStep,
    round_trip,
)

HEADER = "time_s;block;action;target_deg;back_deg;speed_deg_s;duration_s;until_degC;payload_kg"
"""Columns. ``duration_s`` is that of the action, its standing time included."""

_NOTE = f"# A recorded move ends with {DWELL:g} s of standing, which its duration includes."


def written(programme: Programme) -> dict[str, str]:
    """Return the table's text by file name.

    Actions: ``approach`` (move to a target, not recorded), ``record`` (stand, recording starts),
    ``move`` (to a target at constant speed, recorded), ``heat`` (between target and back for a
    time, or until the motor is as warm), ``rest`` (stand, perhaps until the motor is as cold),
    ``payload`` (the operator mounts it).
    """
    lines = [*(f"# {text}" for text in programme.told()), _NOTE, HEADER]
    now, at, payload = 0.0, None, None

    def row(block: str, action: str, seconds: float, **cells: float | None) -> None:
        nonlocal now
        names = ("target", "back", "speed", "until", "payload")
        target, back, speed, until, mass = (_cell(cells.get(name)) for name in names)
        told = f"{seconds:.1f}"
        lines.append(
            ";".join([f"{now:.1f}", block, action, target, back, speed, told, until, mass])
        )
        now += seconds

    def approached(block: str, angle: float) -> None:
        nonlocal at
        if at != angle:
            seconds = 0.0 if at is None else abs(angle - at) / programme.approach
            row(block, "approach", seconds, target=angle, speed=programme.approach)
        at = angle

    for block in programme.blocks:
        for step in block.steps:
            if isinstance(step, SeriesStep):
                if step.payload is not None and step.payload != payload:
                    payload = step.payload
                    row(block.name, "payload", MOUNTING, payload=payload)
                approached(block.name, step.low)
                row(block.name, "record", LEAD)
                for speed in step.speeds:
                    half = round_trip(speed, step.high - step.low) / 2
                    row(block.name, "move", half, target=step.high, speed=speed)
                    row(block.name, "move", half, target=step.low, speed=speed)
            elif isinstance(step, HeatStep):
                approached(block.name, step.low)
                row(
                    block.name,
                    "heat",
                    step.seconds,
                    target=step.high,
                    back=step.low,
                    speed=step.speed,
                    until=step.until,
                )
            elif isinstance(step, RestStep):
                row(block.name, "rest", step.seconds, until=step.until)
    return {f"{programme.name}.csv": "\n".join(lines) + "\n"}


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"
