"""Small logs as other brands, loggers and scripts write them; their clocks, units and shapes."""

import json
import struct
from collections.abc import Iterable, Sequence
from datetime import datetime, timedelta

import numpy as np

from tests.studies.fuzz_layout import CALM, POSITION, TIME, TORQUE, VELOCITY, Layout, text_layout

_MIDNIGHT = datetime(2024, 3, 14, 23, 59, 58, 500_000)
_MOTION = ("position [deg]", "velocity [deg/s]", "torque [Nm]")


def logger_layouts() -> tuple[Layout, ...]:
    """Return every layout of other brands, loggers and scripts."""
    return (
        _named("joints with names, topics", "/joint_states/{}/{}", ("position", "effort")),
        _named("joints with names, words", "{}_{}", ("pos_rad", "torque_Nm")),
        *(_long(f"long table, {kind}", kind) for kind in ("numbers", "names", "blocks")),
        _lists("lists in quotes", ",", '"', "[{}]"),
        _lists("lists of arrays", ";", "", "array('d', [{}])"),
        _dated("dates d.m.y", ["Time"], ["%d.%m.%Y %H:%M:%S,%f"], ";", ","),
        _dated("dates m/d/y, AM and PM", ["Date/Time"], ["%m/%d/%y %I:%M:%S.%f %p"], ",", "."),
        _dated("dates y/m/d", ["Time"], ["%Y/%m/%d %H:%M:%S.%f"], ";", "."),
        _dated("dates of ISO 8601", ["timestamp"], ["%Y-%m-%dT%H:%M:%S.%f+02:00"], ",", "."),
        _dated("times of day", ["Time"], ["%H:%M:%S.%f"], ";", "."),
        _dated("date and time of day", ["Datum", "Zeit"], ["%d.%m.%Y", "%H:%M:%S,%f"], "\t", ","),
        _commented("header in a comment", "#", " "),
        _commented("header in a comment, ;", "%", ";"),
        _data_recorder(),
        _counter("clock of 16 bits", 16, 64_000, 1e3, "time [ms]"),
        _counter("clock of 32 bits", 32, (1 << 32) - 1_500_000, 1e6, "time [us]"),
        _period(),
        _scaled(),
        _turns(),
        _scope(),
        _universal_robots_binary(),
        _without_position(),
        _objects(),
    )


def _lines(rows: Iterable[Sequence[object]], delimiter: str) -> tuple[bytes, ...]:
    return tuple(delimiter.join(map(str, row)).encode() for row in rows)


def _named(name: str, form: str, quantities: tuple[str, str]) -> Layout:
    """Return a log of two joints with names; the second one moves."""
    columns = {"__time": TIME}
    position = np.radians(POSITION)
    for joint, moves in (("left_hip", 0.0), ("left_knee", 1.0)):
        for quantity, values in zip(quantities, (position, TORQUE), strict=True):
            columns[form.format(joint, quantity)] = values * moves
    return text_layout(name, columns, delimiter=",", digits=12)


def _long(name: str, kind: str) -> Layout:
    """Return a table with rows of two joints, in turns or one joint after the other."""
    names = ("hip", "knee") if kind == "names" else ("1", "2")
    both = [
        (t, joint, q * moves, v * moves, u + 100 * (joint == 1))
        for t, q, v, u in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True)
        for joint, moves in ((1, 0.5), (2, 1.0))
    ]
    if kind == "blocks":
        both.sort(key=lambda row: row[1])
    rows = [
        (f"{t:.6f}", names[joint - 1], *(f"{value:.9f}" for value in row))
        for t, joint, *row in both
    ]
    column = "joint_name" if kind == "names" else "motor_id"
    header = ",".join(("time [s]", column, *_MOTION))
    time, joints, position, _, torque = (np.array(part) for part in zip(*both, strict=True))
    return Layout(
        name,
        "log.csv",
        (header.encode(),),
        _lines(rows, ","),
        joints=tuple(joints.tolist()),
        time=time,
        position=position,
        torque=torque,
    )


def _lists(name: str, delimiter: str, quote: str, form: str) -> Layout:
    """Return a log whose cells hold the values of two joints; the second one moves."""
    rows = []
    for t, *values in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True):
        lists = [form.format(f"0.0, {value:.9f}") for value in values]
        rows.append([f"{t:.6f}", *(f"{quote}{cell}{quote}" for cell in lists)])
    header = delimiter.join(("time", *_MOTION))
    return Layout(name, "log.csv", (header.encode(),), _lines(rows, delimiter))


def _dated(
    name: str, header: Sequence[str], forms: Sequence[str], delimiter: str, decimal: str
) -> Layout:
    """Return a log whose time is told by dates or times of day, and which passes midnight."""
    rows = []
    for t, *values in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True):
        moment = _MIDNIGHT + timedelta(seconds=float(t))
        texts = [moment.strftime(form.replace("%f", f"{moment:%f}"[:3])) for form in forms]
        rows.append([*texts, *(f"{value:.9f}".replace(".", decimal) for value in values)])
    first = delimiter.join((*header, *_MOTION))
    return Layout(name, "log.csv", (first.encode(),), _lines(rows, delimiter), joint=1)


def _commented(name: str, mark: str, delimiter: str) -> Layout:
    rows = [
        [f"{value:.9f}" for value in row]
        for row in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True)
    ]
    names = ("time", "position[deg]", "velocity[deg/s]", "torque[Nm]")
    head = (f"{mark} robot in cell 4".encode(), f"{mark} {delimiter.join(names)}".encode())
    return Layout(name, "log.txt", head, _lines(rows, delimiter), joint=1)


def _data_recorder() -> Layout:
    """Return a recording of a KUKA LBR iiwa, with a clock of seconds and nanoseconds."""
    ticks = np.round(TIME * 1e9).astype(np.int64) + 123_456_789
    rows = [
        (1_500_000_000 + t // 10**9, t % 10**9, f"{q:.12f}", f"{u:.9f}")
        for t, q, u in zip(ticks.tolist(), np.radians(POSITION), TORQUE, strict=True)
    ]
    head = (b"% LBR iiwa", b"% ZeitInSec ZeitInNanoSec q_2[rad] tau_2[Nm]")
    return Layout("KUKA data recorder", "DataRecorder_1.log", head, _lines(rows, " "))


def _counter(name: str, bits: int, start: int, per_second: float, column: str) -> Layout:
    """Return a log whose clock, a counter, begins anew in the middle."""
    ticks = (np.round(TIME * per_second).astype(np.int64) + start) % (1 << bits)
    rows = [
        (tick, *(f"{value:.9f}" for value in row))
        for tick, *row in zip(ticks.tolist(), POSITION, VELOCITY, TORQUE, strict=True)
    ]
    header = ",".join((column, *_MOTION)).encode()
    return Layout(name, "log.csv", (header,), _lines(rows, ","), joint=1)


def _period() -> Layout:
    """Return a log without time and header, whose map tells the period."""
    rows = [
        [f"{value:.12f}" for value in row]
        for row in zip(np.radians(POSITION), VELOCITY, TORQUE, strict=True)
    ]
    chart = "[channels]\nposition = 1\nvelocity = 2\ntorque = 3\n"
    chart += f'[units]\nposition = "rad"\n[csv]\nperiod = {TIME[1]}\n'
    return Layout(
        "period per row",
        "log.csv",
        rows=_lines(rows, ","),
        others={"channels.toml": chart.encode()},
        map_file="channels.toml",
        joint=1,
        time=None,
    )


def _scaled() -> Layout:
    """Return a log in counts of a drive, whose map tells what one is."""
    columns = {
        "time [ms]": 1000 * TIME,
        "position [pulse]": POSITION / 0.0875,
        "velocity [counts/s]": VELOCITY / 6 / 0.25,
        "torque": TORQUE / 0.03125,
    }
    chart = "[scale]\nposition = 0.0875\nvelocity = 0.25\ntorque = 0.03125\n"
    chart += '[units]\nvelocity = "rpm"\n'
    return text_layout(
        "scaled by a map",
        columns,
        delimiter=",",
        digits=12,
        others={"channels.toml": chart.encode()},
        map_file="channels.toml",
        joint=1,
    )


def _turns() -> Layout:
    columns = {
        "t [s]": TIME,
        "position [turns]": POSITION / 360,
        "velocity [min-1]": VELOCITY / 6,
        "torque [kgf.cm]": TORQUE / 0.0980665,
    }
    return text_layout("turns and kgf·cm", columns, delimiter="\t", digits=12, joint=1)


def _scope() -> Layout:
    """Return an export by TwinCAT Scope with a time for each channel."""
    keys = {
        "Name": ("Axes.Axis 2.ActPos", "Axes.Axis 2.ActVelo", "Axes.Axis 2.ActTorque"),
        "SampleTime[ms]": ("12", "12", "12"),
        "Unit": ("°", "°/s", "Nm"),
    }

    def row(key: str, values: Sequence[str]) -> str:
        return "\t".join(f"{key}\t{value}" for value in values)

    head = ["Name\tYT Scope Project", "Starttime of export\t132000000000000000", ""]
    head += [row(key, values) for key, values in keys.items()]
    rows = [
        row(f"{1000 * t:.6f}", [f"{value:.9f}" for value in values]).replace(".", ",")
        for t, *values in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True)
    ]
    return Layout(
        "TwinCAT Scope",
        "scope.csv",
        tuple(line.encode() for line in (*head, "")),
        tuple(line.encode() for line in rows),
        newline=b"\r\n",
    )


def _universal_robots_binary() -> Layout:
    still = np.zeros(len(TIME))
    columns = {"timestamp": TIME + 4021.128}
    for joint, moves in ((0, 0.0), (1, 1.0)):
        columns[f"actual_q_{joint}"] = np.radians(POSITION) * moves
        columns[f"actual_qd_{joint}"] = np.radians(VELOCITY) * moves
        columns[f"actual_current_{joint}"] = TORQUE * moves + still
    columns["joint_temperatures_1"] = CALM
    head = f"{' '.join(columns)}\n{' '.join(['DOUBLE'] * len(columns))}\n".encode()
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    packed = b"".join(struct.pack(f">{len(columns)}d", *row) for row in rows)
    return Layout("Universal Robots, binary", "robot_data.csv", binary=head + packed)


def _without_position() -> Layout:
    """Return a log of a drive; its position is an integral, which damage changes from there on."""
    columns = {"time [s]": TIME, "velocity [deg/s]": VELOCITY, "torque [Nm]": TORQUE}
    return text_layout("velocity alone", columns, joint=1, position=None)


def _objects() -> Layout:
    """Return a log of JSON objects in lines, with lists of two joints; the first one is off."""
    rows = [
        json.dumps({"t": t, "state": {"pos_deg": [0.5, q], "torque_Nm": [0.0, u]}})
        for t, q, u in np.round(np.stack((TIME, POSITION, TORQUE), axis=1), 9).tolist()
    ]
    return Layout("JSON objects in lines", "log.jsonl", rows=tuple(row.encode() for row in rows))
