"""Robot programs are read by another reader, run on a model arm, and must stay within limits.

The readers know only the part of each language that is meant to be used: anything else is an error.
"""

import re
from dataclasses import replace

import pytest

from frictioncli.design.blocks import Block, all_blocks
from frictioncli.design.limits import Limits
from frictioncli.design.paper_protocol import algorithms, new_limits
from frictioncli.design.programs import FORMS, krl
from frictioncli.design.programs.robot_program import RobotProgram
from frictioncli.design.selection import seconds_of
from frictioncli.design.settings import PlanSettings
from frictioncli.design.steps import HeatStep, RestStep, SeriesStep
from frictioncli.errors import OptionError
from tests.design.krl import Controller, KrlError, read_data, read_source
from tests.design.model_arm import Arm
from tests.design.urscript import Robot, ScriptError

RATED = 225.0
START = [10.0, 33.0, -20.0, 5.0, 60.0, 0.0]


def limits(**changes):
    usual = {"low": -100.0, "high": 20.0, "slowest": 2.25, "fastest": 112.5, "hottest": 65.0}
    return Limits(**usual | {"speed_step": RATED / 100, "payloads": (5.0,)} | changes)


def robot_program(blocks=None, *, axis=2, name="friction_a2", within=None):
    within = within or limits()
    blocks = all_blocks(within, 0) if blocks is None else blocks
    seconds = seconds_of(blocks, None)
    return RobotProgram(name=name, axis=axis, blocks=tuple(blocks), limits=within, seconds=seconds)


def run_krl(program, arm):
    files = FORMS["krl"](program)
    source, data = (text for _, text in sorted(files.items(), reverse=True))
    Controller(source, data, arm, RATED).run()
    return arm


def run_urscript(program, arm):
    (script,) = FORMS["urscript"](program).values()
    assert Robot(script, arm).run()
    return arm


RUNNERS = {"krl": run_krl, "urscript": run_urscript}


@pytest.fixture(params=sorted(RUNNERS))
def ran(request):
    """A program with every kind of block, after it was run."""
    program = robot_program()
    return program, RUNNERS[request.param](program, Arm(list(START)))


def test_only_its_axis_moves_and_within_limits(ran):
    program, arm = ran
    assert {move.axis for move in arm.moves} == {program.axis}
    others = [at for number, at in enumerate(arm.positions) if number != program.axis - 1]
    assert others == pytest.approx(START[:1] + START[2:])
    for move in arm.moves:
        assert program.limits.low - 1e-6 <= move.target <= program.limits.high + 1e-6
        assert 0 < move.speed <= program.limits.fastest * (1 + 1e-5)


def test_recorded_moves_are_those_of_the_plan(ran):
    program, arm = ran
    wanted = [
        (target, speed)
        for block in program.blocks
        for step in block.steps
        if isinstance(step, SeriesStep)
        for speed in step.speeds
        for target in (step.high, step.low)
    ]
    found = [(move.target, move.speed) for move in arm.moves if move.traced]
    assert len(found) == len(wanted)
    for (target, speed), (target_, speed_) in zip(found, wanted, strict=True):
        assert target == pytest.approx(target_, abs=1e-3)
        assert speed == pytest.approx(speed_, rel=1e-4)


def test_traces_are_the_series_and_the_arm_is_left_untraced(ran):
    program, arm = ran
    series = [s for block in program.blocks for s in block.steps if isinstance(s, SeriesStep)]
    assert len(arm.traces) == len(series)
    assert not arm.traced
    for (begin, end), one in zip(arm.traces, series, strict=True):
        assert end - begin == pytest.approx(one.seconds, rel=0.02, abs=0.5)


def test_the_whole_takes_as_long_as_the_plan_says(ran):
    program, arm = ran
    mounting = 240.0  # the operator's time is not in the program
    assert arm.clock == pytest.approx(program.seconds - mounting, rel=0.05)


def test_heating_ends_at_its_temperature():
    heat = HeatStep(speed=112.5, low=-100.0, high=20.0, seconds=3600.0, until=40.0)
    series = SeriesStep(speeds=(45.0,), low=-100.0, high=20.0)
    program = robot_program([Block(name="heat", reason="heats", steps=(heat, series))])
    for runner in RUNNERS.values():
        arm = runner(program, Arm(list(START), warming=0.05))
        heating = [move for move in arm.moves if not move.traced and move.speed > 100.0]
        assert heating[-1].temperature < 41.0
        assert heating[-1].end < 1200.0


def test_a_motor_that_stays_too_hot_ends_the_program():
    program = robot_program(all_blocks(limits(payloads=()), 0)[:1])
    arm = Arm(list(START), temperature=200.0, cooling=0.0)
    (script,) = FORMS["urscript"](program).values()
    assert not Robot(script, arm).run()
    arm = run_krl(program, Arm(list(START), temperature=200.0, cooling=0.0))
    assert arm.halted > 0  # a KUKA program waits for the operator there


def test_every_recording_of_a_kuka_program_has_its_own_name():
    """A trace of the same name would overwrite the one before; the check of the next day too."""
    program = robot_program()
    names = []
    for one in (program, replace(program, name=f"{program.name}_check")):
        files = FORMS["krl"](one)
        source = next(text for name, text in files.items() if name.endswith(".src"))
        names += re.findall(r'^\$TRACE\.NAME\[\] = "(\w+)"$', source, flags=re.MULTILINE)
    series = [s for block in program.blocks for s in block.steps if isinstance(s, SeriesStep)]
    assert len(names) == len(set(names)) == 2 * len(series) > 2


@pytest.mark.parametrize(
    ("mode", "override", "halts", "records"),
    [("#AUT", 100, False, True), ("#AUT", 50, True, True), ("#T1", 30, False, False)],
)
def test_a_kuka_program_measures_at_full_speed_only(mode, override, halts, records):
    program = robot_program(all_blocks(limits(payloads=()), 0)[:1])
    source, data = (text for _, text in sorted(FORMS["krl"](program).items(), reverse=True))
    arm = Arm(list(START))
    Controller(source, data, arm, RATED, mode=mode, override=override).run()
    assert (arm.halted > 0) == halts
    assert bool(arm.traces) == records


@pytest.mark.parametrize("form", sorted(RUNNERS))
def test_a_changed_limit_stops_the_program_before_it_moves_too_far(form):
    """A user who narrows the limits at the top gets a stop, not a move beyond them."""
    program = robot_program(all_blocks(limits(payloads=()), 0)[:1])
    files = FORMS[form](program)
    arm = Arm(list(START))
    if form == "krl":
        data = files["friction_a2.dat"].replace("A_HIGH=20.000", "A_HIGH=0.000")
        Controller(files["friction_a2.src"], data, arm, RATED).run()
    else:
        script = files["friction_a2.script"].replace("A_HIGH = 20", "A_HIGH = 0")
        assert not Robot(script, arm).run()
    assert arm.halted > 0
    assert max((move.target for move in arm.moves), default=0.0) <= 0.0


@pytest.mark.parametrize("form", sorted(FORMS))
def test_every_program_says_to_try_it_slowly_and_is_plain_text(form):
    for name, text in FORMS[form](robot_program()).items():
        if not name.endswith(".dat"):
            assert "reduced speed first" in text
        assert text.isascii()
        assert text.endswith("\n")


def test_names_are_what_a_kuka_controller_takes():
    program = robot_program(name="friction_a2_check_and_much_more_than_that")
    files = FORMS["krl"](program)
    assert {len(name.split(".")[0]) for name in files} == {krl.LONGEST_NAME}
    name, _, _ = read_data(next(text for file, text in files.items() if file.endswith("dat")))
    assert re.fullmatch(r"[A-Z][A-Z0-9_]{0,23}", name)


def test_a_kuka_program_without_the_rated_speed_is_refused():
    with pytest.raises(OptionError, match="rated"):
        FORMS["krl"](robot_program(within=limits(speed_step=None)))


def test_speeds_of_a_kuka_program_are_whole_per_cent():
    within = limits(slowest=3.1, fastest=101.0)
    for block in all_blocks(within, 0):
        for step in block.steps:
            for speed in getattr(step, "speeds", ()):
                assert speed / (RATED / 100) == pytest.approx(round(speed / (RATED / 100)))
                assert speed <= within.fastest


def test_the_table_holds_the_same_moves():
    program = robot_program(all_blocks(limits(payloads=()), 0))
    lines = [
        line for line in FORMS["csv"](program)["friction_a2.csv"].splitlines() if line[0] != "#"
    ]
    names = lines[0].split(";")
    rows = [dict(zip(names, line.split(";"), strict=True)) for line in lines[1:]]
    moves = [row for row in rows if row["action"] == "move"]
    pairs = sum(
        len(s.speeds) for block in program.blocks for s in block.steps if isinstance(s, SeriesStep)
    )
    assert len(moves) == 2 * pairs
    times = [float(row["time_s"]) for row in rows]
    assert times == sorted(times)
    ends = float(rows[-1]["time_s"]) + float(rows[-1]["duration_s"])
    assert ends == pytest.approx(program.seconds, rel=0.05)
    assert all(-100 <= float(row["target_deg"]) <= 20 for row in rows if row["target_deg"])


def test_the_papers_algorithms_run_through_a_thermal_cycle():
    settings = PlanSettings(
        joint=2, low=-100.0, high=0.0, max_speed=150.0, to="krl", rated_speed=RATED
    )
    within = new_limits(settings)
    program = robot_program(algorithms(within), within=within, name="friction_a2_new")
    arm = run_krl(program, Arm(list(START), warming=0.02, cooling=0.01))
    traced = [move for move in arm.moves if move.traced]
    assert len(arm.traces) == 1 + 41 + 40  # the sweep, every degree up to 65 °C, and back to 25 °C
    assert max(move.temperature for move in traced) == pytest.approx(65.0, abs=4.0)
    assert traced[-1].temperature == pytest.approx(25.0, abs=4.0)
    assert max(move.speed for move in arm.moves) <= 150.0
    cycle = {move.speed for move in arm.moves if move.traced and move.start > arm.traces[1][0]}
    # 19.1, 39.4, 67.5 and 101.2 deg/s in whole per cent of 225 deg/s: 8, 18, 30 and 45 %
    assert sorted(cycle) == pytest.approx([18.0, 40.5, 67.5, 101.25], abs=1e-3)


def test_the_reader_of_the_tests_refuses_what_it_does_not_know():
    files = FORMS["krl"](robot_program())
    source, data = files["friction_a2.src"], files["friction_a2.dat"]
    other = Controller(
        source.replace("PTP TARGET", "LIN_REL TARGET"), data, Arm(list(START)), RATED
    )
    with pytest.raises(KrlError, match="unknown statement"):
        other.run()
    wrong = data.replace("DECL REAL A_LOW", "DECL REAL A_LOWER")
    other = Controller(source, wrong, Arm(list(START)), RATED)
    with pytest.raises(KrlError, match="declared"):
        other.run()
    with pytest.raises(KrlError, match="does not end"):
        read_source(source.rsplit("END", 1)[0])
    (script,) = FORMS["urscript"](robot_program()).values()
    robot = Robot(script.replace("movej(", "movel("), Arm(list(START)))
    with pytest.raises(ScriptError, match="not known"):
        robot.run()


def test_rests_are_held_still():
    series = SeriesStep(speeds=(45.0,), low=-100.0, high=20.0)
    program = robot_program(
        [Block(name="rest", reason="rests", steps=(series, RestStep(300.0), series))]
    )
    for runner in RUNNERS.values():
        arm = runner(program, Arm(list(START)))
        gap = arm.traces[1][0] - arm.traces[0][1]
        assert gap == pytest.approx(300.0, abs=0.5)
