"""KUKA programs (KRL): a ``.src`` with the motions and a ``.dat`` with the constants.

System variables used [1]_: ``$VEL_AXIS`` is a whole number of per cent of the axis' rated speed,
``$MOT_TEMP`` the motor temperature in whole kelvins, ``$TIMER`` counts milliseconds, ``$TRACE``
names, starts and ends the controller's trace, ``$MODE_OP`` is the operating mode and ``$OV_PRO``
the program override in per cent.

References
----------
.. [1] KUKA, System Variables for KUKA System Software 8.1 to 8.4, 2016.
"""

import math

from frictioncli.design.blocks import Block
from frictioncli.design.programs.robot_program import RobotProgram, to_ascii
from frictioncli.design.steps import DWELL, LEAD, HeatStep, RestStep, SeriesStep
from frictioncli.errors import OptionError

KELVIN = 273
"""0 °C; the controller states motor temperatures in whole kelvins. [K]"""

LONGEST_NAME = 24
"""Greatest length of a program name that the controller accepts."""

_ACCELERATION = 50
"""Acceleration in per cent of the greatest acceleration of the axis."""

_BODY = """\
; ---------------------------------------------------------------- parts
; Moves axis {axis} alone to A (deg) at V (deg/s); stops the program outside of the limits.
DEF GO_TO (A :IN, V :IN)
DECL REAL A, V
DECL INT PERCENT
IF (A < A_LOW) OR (A > A_HIGH) OR (V <= 0.0) OR (V > V_MAX) THEN
  HALT ; angle or speed outside of the limits in {name}.dat
ENDIF
IF (A >= A_LOW) AND (A <= A_HIGH) AND (V > 0.0) AND (V <= V_MAX) THEN
  PERCENT = V * 100.0 / V_RATED
  IF PERCENT < 1 THEN
    PERCENT = 1
  ENDIF
  $VEL_AXIS[{axis}] = PERCENT
  TARGET.A{axis} = A
  PTP TARGET
ENDIF
END

; One pair: there and back at V (deg/s) from LOW to HIGH (deg).
DEF PAIR (LOW :IN, HIGH :IN, V :IN)
DECL REAL LOW, HIGH, V
NOT_TOO_HOT( )
GO_TO(HIGH, V)
WAIT SEC DWELL
GO_TO(LOW, V)
WAIT SEC DWELL
END

; Moves between LOW and HIGH (deg) at V (deg/s) for a time (s), or until the motor has UNTIL_K (K).
DEF HEAT (LOW :IN, HIGH :IN, V :IN, SECONDS :IN, UNTIL_K :IN)
DECL REAL LOW, HIGH, V, SECONDS
DECL INT UNTIL_K
WAIT SEC 0.0 ; stops the advance run: the timer starts when the axis is at rest
$TIMER[1] = 0
$TIMER_STOP[1] = FALSE
WHILE ($TIMER[1] < SECONDS * 1000.0) AND ($MOT_TEMP[{axis}] < UNTIL_K)
  GO_TO(HIGH, V)
  GO_TO(LOW, V)
  WAIT SEC 0.0
ENDWHILE
$TIMER_STOP[1] = TRUE
END

; Holds still for a time (s), or until the motor has cooled to UNTIL_K (K).
DEF COOL (SECONDS :IN, UNTIL_K :IN)
DECL REAL SECONDS
DECL INT UNTIL_K
WAIT SEC 0.0
$TIMER[1] = 0
$TIMER_STOP[1] = FALSE
WHILE ($TIMER[1] < SECONDS * 1000.0) AND ($MOT_TEMP[{axis}] > UNTIL_K)
  WAIT SEC 1.0
ENDWHILE
$TIMER_STOP[1] = TRUE
END

; Waits while the motor is hotter than T_STOP_K (K), at most an hour.
DEF NOT_TOO_HOT ( )
WAIT SEC 0.0
$TIMER[2] = 0
$TIMER_STOP[2] = FALSE
WHILE ($MOT_TEMP[{axis}] > T_STOP_K) AND ($TIMER[2] < 3600000)
  WAIT SEC 5.0
ENDWHILE
$TIMER_STOP[2] = TRUE
IF $MOT_TEMP[{axis}] > T_STOP_K THEN
  HALT ; still too hot after an hour
ENDIF
END

; Speeds are those of the plan in automatic mode with the override at 100 %, and nowhere else.
DEF FULL_SPEED ( )
WAIT SEC 0.0
IF ($MODE_OP <> #T1) AND ($OV_PRO <> 100) THEN
  HALT ; set the override to 100 %, then start again
ENDIF
END

; USER HOOK: starts the recording under the name set before. In T1, a trial run, nothing is
; recorded. Needs a trace configuration that is loaded already, with position, velocity, torque and
; motor temperature of axis {axis}. Replace it if you record otherwise.
DEF TRACE_ON ( )
FULL_SPEED( )
IF $MODE_OP <> #T1 THEN
  $TRACE.MODE = #T_START
ENDIF
WAIT SEC LEAD
END

; USER HOOK: ends the recording and waits until it is written, at most a minute.
DEF TRACE_OFF ( )
WAIT SEC 0.0
IF $MODE_OP <> #T1 THEN
  $TRACE.MODE = #T_STOP
ENDIF
$TIMER[3] = 0
$TIMER_STOP[3] = FALSE
WHILE ($TRACE.STATE <> #T_END) AND ($TIMER[3] < 60000)
  WAIT SEC 0.5
ENDWHILE
$TIMER_STOP[3] = TRUE
END
"""


def program_files(program: RobotProgram) -> dict[str, str]:
    """Return the text of the ``.src`` and the ``.dat`` by file name.

    Parameters
    ----------
    program : RobotProgram
        The program.

    Returns
    -------
    dict of str to str
        Text by file name.

    Raises
    ------
    OptionError
        If the rated speed of the axis is not known.
    """
    step = program.limits.speed_step
    if step is None:
        raise OptionError("a KUKA program needs the rated speed of the axis: --rated-speed")
    name = program.name.upper()[:LONGEST_NAME]
    return {
        f"{name.lower()}.src": _source(program, name),
        f"{name.lower()}.dat": _data(program, name, 100 * step),
    }


def _source(program: RobotProgram, name: str) -> str:
    axis = program.axis
    head = [
        "&ACCESS RVP",
        "&REL 1",
        f"DEF {name} ( )",
        *(f"; {to_ascii(text)}" for text in program.header_lines()),
        f"; Limits and speeds are constants in {name.lower()}.dat. V_RATED there must be the rated",
        "; speed of the axis: speeds are stated in whole per cent of it. Run in T1 first, then in",
        "; automatic mode with the override at 100 %: another override changes all speeds.",
        ";FOLD INI",
        "  ;FOLD BASISTECH INI",
        "    GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM( )",
        "    INTERRUPT ON 3",
        "    BAS(#INITMOV, 0)",
        "  ;ENDFOLD",
        ";ENDFOLD",
        "PTP $AXIS_ACT ; block coincidence: the robot stays where it is",
        "TARGET = $AXIS_ACT ; the other axes keep these angles",
        f"$ACC_AXIS[{axis}] = {_ACCELERATION}",
        "FULL_SPEED( )",
    ]
    return "\n".join(
        [*head, *_main(program, name), "END", "", _BODY.format(axis=axis, name=name.lower())]
    )


def _main(program: RobotProgram, name: str) -> list[str]:
    lines: list[str] = []
    at, payload, traces = None, None, 0
    for number, block in enumerate(program.blocks, start=1):
        lines += ["", f"; ---- block {number}: {to_ascii(block.name)}", *_reason(block)]
        for step in block.steps:
            if isinstance(step, RestStep):
                lines.append(_rest(step))
                continue
            if isinstance(step, SeriesStep) and step.payload not in (None, payload):
                payload = step.payload
                lines += [
                    f"HALT ; OPERATOR: mount {payload:g} kg, set its load data, then start again",
                ]
            if step.low != at:
                lines.append(f"GO_TO({step.low:.3f}, V_APPROACH)")
                at = step.low
            if isinstance(step, HeatStep):
                until = program.limits.hottest if step.until is None else step.until
                lines.append(
                    f"HEAT({step.low:.3f}, {step.high:.3f}, {step.speed:.3f},"
                    f" {step.seconds:.1f}, {math.floor(until + KELVIN)})"
                )
            else:
                traces += 1
                # a trace of the same name would overwrite the one before
                lines += [
                    f'$TRACE.NAME[] = "{name}_{traces:03d}"',
                    "TRACE_ON( )",
                    *(f"PAIR({step.low:.3f}, {step.high:.3f}, {v:.3f})" for v in step.speeds),
                    "TRACE_OFF( )",
                ]
    return lines


def _rest(step: RestStep) -> str:
    if step.until is None:
        return f"WAIT SEC {step.seconds:.1f} ; hold still"
    return f"COOL({step.seconds:.1f}, {math.ceil(step.until + KELVIN)})"


def _reason(block: Block) -> list[str]:
    return [f"; {to_ascii(block.reason)}"]


def _data(program: RobotProgram, name: str, rated: float) -> str:
    limits = program.limits
    hottest = math.floor(limits.waiting) + KELVIN
    constants = (
        ("REAL", "V_RATED", f"{rated:.3f}", "rated speed of the axis: CHECK IT (deg/s)"),
        ("REAL", "V_MAX", f"{limits.fastest * (1 + 1e-6):.3f}", "highest speed (deg/s)"),
        (
            "REAL",
            "V_APPROACH",
            f"{program.approach:.3f}",
            "approach to the start of a series (deg/s)",
        ),
        ("REAL", "A_LOW", f"{limits.low:.3f}", "lowest angle (deg)"),
        ("REAL", "A_HIGH", f"{limits.high:.3f}", "highest angle (deg)"),
        ("INT", "T_STOP_K", f"{hottest}", "wait above (K)"),
        ("REAL", "DWELL", f"{DWELL:.3f}", "pause at each end (s)"),
        ("REAL", "LEAD", f"{LEAD:.3f}", "pause after a recording starts (s)"),
    )
    lines = [
        "&ACCESS RVP",
        "&REL 1",
        f"DEFDAT {name}",
        "; Limits of this program. Change them only towards the safe side.",
        ";FOLD EXTERNAL DECLARATIONS",
        "  EXT BAS (BAS_COMMAND :IN, REAL :IN)",
        ";ENDFOLD",
        *(f"DECL {kind} {what}={value} ; {text}" for kind, what, value, text in constants),
        "DECL E6AXIS TARGET ; target of the axis; the other axes as at the start",
        "ENDDAT",
    ]
    return "\n".join(lines) + "\n"
