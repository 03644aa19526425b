"""DIAdem recordings for the tests, written from the description of the format."""

import struct
from pathlib import Path

import numpy as np

CODES = {
    "REAL32": "f",
    "REAL64": "d",
    "INT16": "h",
    "INT32": "i",
    "WORD8": "B",
    "WORD16": "H",
    "WORD32": "I",
}
KUKA_FACTORS = {
    "AxisPos_Act": 57.29578,
    "Istposition": 1e-6,
    "Sollposition": 1e-6,
}
"""What the headers of KUKA traces hold; other channels have the factor 1."""


def factor_of(name: str) -> float:
    return next((f for start, f in KUKA_FACTORS.items() if name.startswith(start)), 1.0)


def split(column: str) -> tuple[str, str]:
    name, _, unit = column.partition("[")
    return name, unit.removesuffix("]")


def raw_numbers(column: str, values):
    """Return what a KUKA controller stores of physical values: rad, 1e-6 deg, else the same."""
    name, _ = split(column)
    if name.startswith("AxisPos_Act"):
        return np.radians(values)
    return np.asarray(values) / factor_of(name)


def write_diadem(
    header: Path,
    columns,
    *,
    period: float | None = 0.012,
    kinds=None,
    scales=None,
    storage="BLOCK",
    order="High -> Low",
    words=("IMPLIZIT  ", "EXPLIZIT"),
    named: str | None = None,
    extra=(),
    samples: Path | None = None,
    encoding="cp1252",
    newline="\r\n",
) -> Path:
    """Write a header and its samples; ``columns`` are stored numbers by name with unit.

    ``kinds`` and ``scales`` name the type and (factor, offset) of columns that differ from REAL64
    and KUKA's; ``named`` is what key 211 says.
    """
    samples = samples or header.with_suffix(".r64")
    n = len(next(iter(columns.values())))
    kinds = [(kinds or {}).get(column, "REAL64") for column in columns]
    sign = "<" if order == "High -> Low" else ">"
    lines = ["DIAEXTENDED", "", "#BEGINGLOBALHEADER", "  1,DOS", "101,---"]
    lines += ['102,rob "#KR3R540 C4SR"', "104,19.05.2021", "105,15:03:52", "106,944500000"]
    lines += ["110,#dd.mm.yyyy HH:MM:SS ns", "111,9.9000000000E+34", f"112,{order}"]
    lines += [*extra, "#ENDGLOBALHEADER", ""]
    if period is not None:
        lines += ["#BEGINCHANNELHEADER", "200,Zeit", "201,Zeitkanal", "202,sec", f"210,{words[0]}"]
        lines += [f"220,{n}", "240,0.00000", f"241,{period:.8e}", "#ENDCHANNELHEADER", ""]
    content = []
    position = 0
    for number, (column, kind) in enumerate(zip(columns, kinds, strict=True), start=1):
        name, unit = split(column)
        factor, offset = (scales or {}).get(column, (factor_of(name), 0))
        first = number if storage == "BLOCK" else position // struct.calcsize(CODES[kind]) + 1
        lines += ["#BEGINCHANNELHEADER", f"200,{name}", "201,IpoActual", f"202,{unit}"]
        lines += [f"210,{words[1]}", f"211,{named or samples.name}", f"213,{storage}"]
        lines += [f"214,{kind}", f"220,{n}", f"221,{first}", f"240,{offset}", f"241,{factor:.6e}"]
        lines += ["#ENDCHANNELHEADER", ""]
        if storage == "CHANNEL":
            packed = struct.pack(f"{sign}{n}{CODES[kind]}", *_numbers(columns[column], kind))
            content.append(packed)
            position += len(packed)
    if storage == "BLOCK":
        code = sign + "".join(CODES[kind] for kind in kinds)
        rows = zip(
            *(_numbers(v, k) for v, k in zip(columns.values(), kinds, strict=True)), strict=True
        )
        content = [struct.pack(code, *row) for row in rows]
    header.parent.mkdir(parents=True, exist_ok=True)
    header.write_bytes(newline.join(lines).encode(encoding))
    samples.write_bytes(b"".join(content))
    return header


def _numbers(values, kind):
    return [float(v) if kind.startswith("REAL") else int(v) for v in values]
