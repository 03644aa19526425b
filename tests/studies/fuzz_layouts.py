"""Small logs of every layout that is read, with the truth of each row by another route."""

import gzip
import io
import lzma
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet as pq
from numpy.typing import NDArray

from tests.logs.logs import back_and_forth

TIME, POSITION, VELOCITY, TORQUE = back_and_forth(seconds=3.0)
TORQUE = TORQUE + np.round(np.arange(len(TIME)) * 0.001, 3)  # every row is one of a kind
_RATIO = 90.72
_CALM = np.full(len(TIME), 31.0)


def _as_is(content: bytes) -> bytes:
    return content


@dataclass(frozen=True, slots=True)
class Layout:
    """A folder of logs whose rows are known.

    Attributes
    ----------
    name : str
        Which layout.
    log : str
        File that is damaged most.
    head, rows : tuple of bytes
        Its lines before the first row, and its rows: one line each, without line ends.
    newline : bytes
        What ends a line.
    pack : callable
        From text as bytes to the file's content.
    others : mapping of str to bytes
        Further files of the folder.
    map_file : str or None
        Which of them is the mapping file.
    gear_ratio : float or None
        What the user says of a log of the motor's side.
    joint : int
        Whose rows they are; a damaged log may seem to have more.
    binary : bytes
        The log where it is no text; there are no lines then.
    position, torque : ndarray of float, shape (n,)
        What the rows say, in deg and in the log's own unit of torque.
    """

    name: str
    log: str
    head: tuple[bytes, ...] = ()
    rows: tuple[bytes, ...] = ()
    newline: bytes = b"\n"
    pack: Callable[[bytes], bytes] = _as_is
    others: Mapping[str, bytes] = field(default_factory=dict)
    map_file: str | None = None
    gear_ratio: float | None = None
    joint: int = 2
    binary: bytes = b""
    position: NDArray[np.float64] = field(default_factory=lambda: POSITION)
    torque: NDArray[np.float64] = field(default_factory=lambda: TORQUE)

    def content(self, head: list[bytes] | None = None, rows: list[bytes] | None = None) -> bytes:
        """Return the log's bytes, with other lines where they are given."""
        if self.binary:
            return self.binary
        lines = [*(self.head if head is None else head), *(self.rows if rows is None else rows)]
        return self.pack(self.newline.join(lines) + self.newline)


def _text(
    name: str,
    columns: Mapping[str, NDArray[np.float64]],
    *,
    delimiter: str = ";",
    decimal: str = ".",
    encoding: str = "utf-8",
    bom: bool = False,
    digits: int = 9,
    **more,
) -> Layout:
    """Return a delimited layout; the truth is what the written digits say."""
    header = delimiter.join(columns).encode(encoding)
    rows = [
        delimiter.join(f"{value:.{digits}f}".replace(".", decimal) for value in row).encode()
        for row in zip(*columns.values(), strict=True)
    ]
    mark = b"\xef\xbb\xbf" if bom else b""
    return Layout(name, more.pop("log", "log.csv"), (mark + header,), tuple(rows), **more)


def _kuka(**more: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return {
        "Zeit[sec]": TIME,
        "AxisPos_Act2[°]": POSITION,
        "GearTorq_Act2[Nm]": TORQUE,
        "Motortemperatur2[°C]": _CALM,
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
            f"joint_temperatures_{joint}": _CALM,
        }
    return _text("Universal Robots", columns, delimiter=" ", digits=12, newline=b"\r\n\r\n")


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
        "Temp_1": _CALM,
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
    return _text(
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
    return _text("manifest", _kuka(), others={"manifest.csv": manifest.encode()})


def _with_motion_information() -> Layout:
    program = (
        "#BEGINMOTIONINFO\nTIME: 0.66\nMODULE: /R1/FRICTION\nTYPE: PTP\nSIGNAL: END\nLINE: 12\n"
        "VELOCITIES: {a1 100, a2 50}\nTOOL: {x 0, y 0, z 0, a 0, b 0, c 0}\n#ENDMOTIONINFO\n"
    )
    return _text(
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
            "motor_temperature_2 [degC]": _CALM,
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
        _text("KUKA A", plain | {"AxisVel_Act2[°/s]": VELOCITY}, encoding="cp1252"),
        _text("KUKA B", plain, delimiter="\t"),
        _text(
            "KUKA C",
            {
                "Istmoment_A2 (Nm)": TORQUE,
                "Istposition_A2 (°)": POSITION * _RATIO,
                "Motortemperatur_A2 (K)": _CALM + 273.15,
                "Sample": TIME * 1000,
            },
            bom=True,
            gear_ratio=_RATIO,
            torque=TORQUE * _RATIO,
        ),
        _text(
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
        _text("decimal comma", plain, decimal=",", newline=b"\r\n"),
        _quoted(),
        _universal_robots(),
        _text(
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
        _text("UTF-16", plain, pack=lambda text: text.decode("utf-8", "replace").encode("utf-16")),
        _text("gzip", plain, log="log.csv.gz", pack=lambda text: gzip.compress(text, 1, mtime=0)),
        _text("xz", plain, log="log.csv.xz", pack=lambda text: lzma.compress(text, preset=0)),
        _diadem("DIAdem header", damaged="dat"),
        _diadem("DIAdem samples", damaged="r64"),
        Layout("Parquet", "log.parquet", binary=_parquet()),
        Layout("Feather", "log.feather", binary=_feather()),
    )
