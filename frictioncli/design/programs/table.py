"""Programs as a CSV table, for people and for other controllers."""

from frictioncli.design.programs.robot_program import RobotProgram
from frictioncli.design.steps import (
    DWELL,
    LEAD,
    PAYLOAD_CHANGE,
    HeatStep,
    RestStep,
    SeriesStep,
    round_trip,
)

HEADER = "time_s;block;action;target_deg;back_deg;speed_deg_s;duration_s;until_degC;payload_kg"
"""Column names; ``duration_s`` is the duration of an action with its standing time."""

_NOTE = f"# A recorded move ends with {DWELL:g} s of rest, which its duration includes."


def program_files(program: RobotProgram) -> dict[str, str]:
    """Return the text of the table by file name.

    Actions: ``approach`` (unrecorded move to a target), ``record`` (stand while the recording
    starts), ``move`` (recorded move to a target at constant speed), ``heat`` (moves between target
    and back for a time, or until the motor reaches a temperature), ``rest`` (stand for a time, or
    until the motor has cooled to a temperature), ``payload`` (the operator mounts it).

    Parameters
    ----------
    program : RobotProgram
        The program.

    Returns
    -------
    dict of str to str
        Text by file name.
    """
    lines = [*(f"# {text}" for text in program.header_lines()), _NOTE, HEADER]
    now, at, payload = 0.0, None, None

    def row(block: str, action: str, seconds: float, **cells: float | None) -> None:
        nonlocal now
        names = ("target", "back", "speed", "until", "payload")
        target, back, speed, until, mass = (_cell(cells.get(name)) for name in names)
        duration = f"{seconds:.1f}"
        lines.append(
            ";".join([f"{now:.1f}", block, action, target, back, speed, duration, until, mass])
        )
        now += seconds

    def approach(block: str, angle: float) -> None:
        nonlocal at
        if at != angle:
            seconds = 0.0 if at is None else abs(angle - at) / program.approach
            row(block, "approach", seconds, target=angle, speed=program.approach)
        at = angle

    for block in program.blocks:
        for step in block.steps:
            if isinstance(step, SeriesStep):
                if step.payload is not None and step.payload != payload:
                    payload = step.payload
                    row(block.name, "payload", PAYLOAD_CHANGE, payload=payload)
                approach(block.name, step.low)
                row(block.name, "record", LEAD)
                for speed in step.speeds:
                    half = round_trip(speed, step.high - step.low) / 2
                    row(block.name, "move", half, target=step.high, speed=speed)
                    row(block.name, "move", half, target=step.low, speed=speed)
            elif isinstance(step, HeatStep):
                approach(block.name, step.low)
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
    return {f"{program.name}.csv": "\n".join(lines) + "\n"}


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"
