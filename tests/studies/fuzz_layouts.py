"""Small logs of every layout that is read, with the truth of each row by another route."""

import gzip
import io
import lzma
from collections.abc import Mapping

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet as pq
from numpy.typing import NDArray

from tests.studies.fuzz_layout import CALM, POSITION, TIME, TORQUE, VELOCITY, Layout, text_layout
from tests.studies.fuzz_logger_layouts import logger_layouts

_RATIO = 90.72


def _kuka(**more: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return {
        "Zeit[sec]": TIME,
        "AxisPos_Act2[°]": POSITION,
        "GearTorq_Act2[Nm]": TORQUE,
        "Motortemperatur2[°C]": CALM,
        **more,
    }


def _universal_robots() -> Layout:
    columns = {"timestamp": TIME + 4021.128}
    for joint in range(2):
        moves = float(joint == 1)
        columns |= {
            f"actual_q_{joint}": np.radians(POSITION) * moves,
            f"actual_qd_{joint}": np.radians(VELOCITY) * moves,
            f"actual_current_{joint}": TORQUE * moves,
            f"joint_temperatures_{joint}": CALM,
        }
    return text_layout("Universal Robots", columns, delimiter=" ", digits=12, newline=b"\r\n\r\n")


def _variable_logger() -> Layout:
    lines = [
        f"{t:.3f};A1 {q:.9f} A2 {0:.1f} A3 {0:.1f} A4 0 A5 0 A6 0;{m:.3f};{v:.6f};304;63"
        for t, q, m, v in zip(TIME, POSITION, TORQUE, VELOCITY, strict=True)
    ]
    header = b"timestamp;AXIS_ACT;TORQUE_A1;VEL_AXIS_ACT_A1;MOT_TEMP_A1;BRAKE_SIG"
    rows = tuple(line.encode() for line in lines)
    return Layout("KUKA variable logger", "log.csv", (header,), rows, joint=1)


def _mapped() -> Layout:
    columns = {
        "Time (s)": TIME,
        "Pos_1": POSITION,
        "Velocity_1": VELOCITY,
        "Current_1": TORQUE,
        "Temp_1": CALM,
    }
    chart = """[channels]
time = "Time (s)"
position = "Pos_1"
velocity = "Velocity_1"
torque = "Current_1"
motor_temperature = "Temp_1"

[units]
position = "deg"
velocity = "deg/s"
torque = "A"
motor_temperature = "degC"

[joint]
number = 2
"""
    return text_layout(
        "mapping file",
        columns,
        delimiter=",",
        others={"channels.toml": chart.encode()},
        map_file="channels.toml",
    )


def _quoted() -> Layout:
    lines = [
        ",".join(f'"{value:.9f}"'.replace(".", ",") for value in row)
        for row in zip(*_kuka().values(), strict=True)
    ]
    header = ",".join(f'"{name}"' for name in _kuka())
    return Layout("quoted", "log.csv", (header.encode(),), tuple(x.encode() for x in lines))


def _with_manifest() -> Layout:
    manifest = (
        "file;started_at;phase;payload;ambient\nlog.csv;2024-05-17T09:30:00;heat-up;2.5;21,5\n"
    )
    return text_layout("manifest", _kuka(), others={"manifest.csv": manifest.encode()})


def _with_motion_information() -> Layout:
    program = (
        "#BEGINMOTIONINFO\nTIME: 0.66\nMODULE: /R1/FRICTION\nTYPE: PTP\nSIGNAL: END\nLINE: 12\n"
        "VELOCITIES: {a1 100, a2 50}\nTOOL: {x 0, y 0, z 0, a 0, b 0, c 0}\n#ENDMOTIONINFO\n"
    )
    return text_layout(
        "KUKA trace, _PROG.TXT",
        _kuka(),
        encoding="cp1252",
        log="move_KRCIpo.csv",
        others={"move_PROG.TXT": program.encode()},
    )


def _columns() -> pa.Table:
    return pa.table(
        {
            "time [s]": TIME,
            "position_2 [deg]": POSITION,
            "torque_2 [Nm]": TORQUE,
            "motor_temperature_2 [degC]": CALM,
        }
    )


def _parquet() -> bytes:
    sink = io.BytesIO()
    pq.write_table(_columns(), sink)
    return sink.getvalue()


def _feather() -> bytes:
    sink = io.BytesIO()
    pyarrow.feather.write_feather(_columns(), sink, compression="zstd")
    return sink.getvalue()


def diadem_header(channels: Mapping[str, str], data: str, period: float = TIME[1]) -> bytes:
    """Return the header of a DIAdem recording: channel name -> unit, samples in file ``data``."""
    lines = ["DIAEXTENDED", "#BEGINGLOBALHEADER", "  1,DOS", '102,rob "#KR10R900 ULTRA C4"']
    lines += ["104,06.03.2018", "105,08:56:29", "110,#dd.mm.yyyy HH:MM:SS ns"]
    lines += ["111,9.9000000000E+34", "112,High -> Low", "#ENDGLOBALHEADER"]
    lines += ["#BEGINCHANNELHEADER", "200,Zeit", "201,Zeitkanal", "202,sec", "210,IMPLIZIT"]
    lines += [f"220,{len(TIME)}", "240,0.00000", f"241,{period:.8f}", "#ENDCHANNELHEADER"]
    for number, (name, unit) in enumerate(channels.items(), start=1):
        lines += ["#BEGINCHANNELHEADER", f"200,{name}", f"202,{unit}", "210,EXPLIZIT"]
        lines += [f"211,{data}", "213,BLOCK", "214,REAL64", f"220,{len(TIME)}"]
        lines += [f"221,{number}", "240,0", "241,1", "#ENDCHANNELHEADER"]
    return ("\r\n".join(lines) + "\r\n").encode("cp1252")


def _diadem(name: str, *, damaged: str) -> Layout:
    header = diadem_header({"AxisPos_Act2": "°", "GearTorq_Act2": "Nm"}, "move_KRCIpo.r64")
    samples = np.column_stack((POSITION, TORQUE)).astype("<f8").tobytes()
    files = {"move_KRCIpo.dat": header, "move_KRCIpo.r64": samples}
    log = f"move_KRCIpo.{damaged}"
    return Layout(name, log, binary=files.pop(log), others=files)


def layouts() -> tuple[Layout, ...]:
    """Return every layout."""
    plain = _kuka()
    return (
        text_layout("KUKA A", plain | {"AxisVel_Act2[°/s]": VELOCITY}, encoding="cp1252"),
        text_layout("KUKA B", plain, delimiter="\t"),
        text_layout(
            "KUKA C",
            {
                "Istmoment_A2 (Nm)": TORQUE,
                "Istposition_A2 (°)": POSITION * _RATIO,
                "Motortemperatur_A2 (K)": CALM + 273.15,
                "Sample": TIME * 1000,
            },
            bom=True,
            gear_ratio=_RATIO,
            torque=TORQUE * _RATIO,
        ),
        text_layout(
            "KUKA D",
            {
                "Zeit(s)": TIME,
                "Istposition_A2(°)": POSITION * _RATIO,
                "Istmoment_A2(Nm)": TORQUE,
            },
            delimiter=",",
            gear_ratio=_RATIO,
            torque=TORQUE * _RATIO,
        ),
        text_layout("decimal comma", plain, decimal=",", newline=b"\r\n"),
        _quoted(),
        _universal_robots(),
        text_layout(
            "Franka",
            {
                "time": TIME * 1000,
                "state.q[0]": np.radians(POSITION),
                "state.dq[0]": np.radians(VELOCITY),
                "state.tau_J[0]": TORQUE,
            },
            delimiter=",",
            digits=12,
            joint=1,
        ),
        _variable_logger(),
        _mapped(),
        _with_manifest(),
        _with_motion_information(),
        text_layout(
            "UTF-16", plain, pack=lambda text: text.decode("utf-8", "replace").encode("utf-16")
        ),
        text_layout(
            "gzip", plain, log="log.csv.gz", pack=lambda text: gzip.compress(text, 1, mtime=0)
        ),
        text_layout("xz", plain, log="log.csv.xz", pack=lambda text: lzma.compress(text, preset=0)),
        _diadem("DIAdem header", damaged="dat"),
        _diadem("DIAdem samples", damaged="r64"),
        Layout("Parquet", "log.parquet", binary=_parquet()),
        Layout("Feather", "log.feather", binary=_feather()),
        *logger_layouts(),
    )
