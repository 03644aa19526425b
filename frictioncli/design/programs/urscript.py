"""URScript programs, for robots of Universal Robots."""

from frictioncli.design.programs.robot_program import RobotProgram, to_ascii
from frictioncli.design.steps import (
    ACCELERATION,
    DWELL,
    LEAD,
    HeatStep,
    RestStep,
    SeriesStep,
    round_trip,
)

_PARTS = """\
  # Moves joint {axis} alone to an angle (deg) at a speed (deg/s); halts outside of the limits.
  def go_to(angle, speed):
    if angle < A_LOW or angle > A_HIGH or speed <= 0.0 or speed > V_MAX:
      popup("angle or speed outside of the limits", "friction", False, True, True)
      halt
    end
    q = q_start
    q[{index}] = d2r(angle)
    movej(q, a=d2r(ACCELERATION), v=d2r(speed))
  end

  # Waits while the joint is hotter than T_STOP (degC), an hour at the longest.
  def not_too_hot():
    waited = 0
    while get_joint_temp({index}) > T_STOP and waited < 720:
      sleep(5.0)
      waited = waited + 1
    end
    if get_joint_temp({index}) > T_STOP:
      popup("still too hot after an hour", "friction", False, True, True)
      halt
    end
  end

  # One pair: there and back at a speed (deg/s) from low to high (deg).
  def pair(low, high, speed):
    not_too_hot()
    go_to(high, speed)
    sleep(DWELL)
    go_to(low, speed)
    sleep(DWELL)
  end

  # Round trips between low and high (deg) at a speed (deg/s), or until the joint has a
  # temperature (degC).
  def heat(low, high, speed, trips, until):
    trip = 0
    while trip < trips and get_joint_temp({index}) < until:
      go_to(high, speed)
      go_to(low, speed)
      trip = trip + 1
    end
  end

  # Holds still for a number of seconds, or until the joint has cooled to a temperature (degC).
  def cool(seconds, until):
    waited = 0
    while waited < seconds and get_joint_temp({index}) > until:
      sleep(1.0)
      waited = waited + 1
    end
  end

  # USER HOOK: starts the recording; a recorder on RTDE can watch this register.
  def trace_on():
    write_output_integer_register(0, 1)
    sleep(LEAD)
  end

  # USER HOOK: ends the recording.
  def trace_off():
    write_output_integer_register(0, 0)
  end
"""


def program_files(program: RobotProgram) -> dict[str, str]:
    """Return the text of the script by file name.

    Parameters
    ----------
    program : RobotProgram
        The program.

    Returns
    -------
    dict of str to str
        Text by file name.
    """
    limits, name = program.limits, program.name.lower()
    constants = (
        ("A_LOW", limits.low, "lowest angle (deg)"),
        ("A_HIGH", limits.high, "highest angle (deg)"),
        ("V_MAX", limits.fastest * (1 + 1e-6), "highest speed (deg/s)"),
        ("V_APPROACH", program.approach, "approach to the start of a series (deg/s)"),
        ("ACCELERATION", ACCELERATION, "of all moves (deg/s2)"),
        ("T_STOP", limits.waiting, "wait above (degC)"),
        ("DWELL", DWELL, "pause at each end (s)"),
        ("LEAD", LEAD, "pause after a recording starts (s)"),
    )
    lines = [
        *(f"# {to_ascii(text)}" for text in program.header_lines()),
        f"def {name}():",
        "  # Limits of this program. Change them only towards the safe side.",
        *(f"  global {what} = {value:.6g} # {text}" for what, value, text in constants),
        "  global q_start = get_actual_joint_positions() # the other joints keep these angles",
        "",
        *_PARTS.format(axis=program.axis, index=program.axis - 1).splitlines(),
        "",
        '  popup("Tried at reduced speed? Path clear, payload fixed and set?", "friction", True,'
        " False, True)",
        *_main(program),
        "end",
    ]
    return {f"{name}.script": "\n".join(lines) + "\n"}


def _main(program: RobotProgram) -> list[str]:
    lines: list[str] = []
    at, payload = None, None
    for number, block in enumerate(program.blocks, start=1):
        lines += [
            "",
            f"  # ---- block {number}: {to_ascii(block.name)}",
            f"  # {to_ascii(block.reason)}",
        ]
        for step in block.steps:
            if isinstance(step, RestStep):
                lines.append(
                    f"  sleep({step.seconds:.1f}) # hold still"
                    if step.until is None
                    else f"  cool({step.seconds:.0f}, {step.until:.1f})"
                )
                continue
            if isinstance(step, SeriesStep) and step.payload not in (None, payload):
                payload = step.payload
                lines.append(
                    f'  popup("Mount {payload:g} kg and set its data", "friction", False, False,'
                    " True)"
                )
            if step.low != at:
                lines.append(f"  go_to({step.low:.3f}, V_APPROACH)")
                at = step.low
            if isinstance(step, HeatStep):
                until = program.limits.hottest if step.until is None else step.until
                trip = round_trip(step.speed, step.high - step.low) - 2 * DWELL
                lines.append(
                    f"  heat({step.low:.3f}, {step.high:.3f}, {step.speed:.3f},"
                    f" {max(int(step.seconds / trip), 1)}, {until:.1f})"
                )
            else:
                lines += [
                    "  trace_on()",
                    *(f"  pair({step.low:.3f}, {step.high:.3f}, {v:.3f})" for v in step.speeds),
                    "  trace_off()",
                ]
    return lines
