"""Logs with random heads: names of many loggers, other alphabets, duplicates, units that lie.

What is read has to be the motion that was written, or the call says what it assumes.
"""

import random
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from numpy.typing import NDArray

from frictioncli.logs.channels import channel_names as names
from frictioncli.logs.channels import units
from tests.logs.logs import back_and_forth
from tests.studies.fuzz_damage import _TEXTS
from tests.studies.fuzz_input import LOGS, WORK, Input

TIME, POSITION, VELOCITY, TORQUE = back_and_forth(seconds=6.0, speed=30.0)
_QUANTITIES = {
    names.TIME: TIME,
    names.POSITION: POSITION,
    names.VELOCITY: VELOCITY,
    names.TORQUE: TORQUE,
}
_USUAL = {
    names.TIME: ("s", "ms"),
    names.POSITION: ("deg", "rad"),
    names.VELOCITY: ("deg/s", "rad/s", "rpm"),
    names.TORQUE: ("N·m", "mN·m"),
}
_OF_CURRENTS = ("A", "mA")
_OTHER_ALPHABETS = {
    names.TIME: ("时间", "時刻", "время", "χρόνος", "시간", "زمان"),
    names.POSITION: ("关节位置", "関節角度", "положение", "θέση", "위치", "موضع"),
    names.VELOCITY: ("关节速度", "速度", "скорость", "ταχύτητα", "속도", "سرعة"),
    names.TORQUE: ("力矩", "トルク", "момент", "ροπή", "토크", "عزم"),
}
_DECOYS = (
    "target_{}",
    "{}_cmd",
    "{} error",
    "ext_{}",
    "{}_filtered",
    "{} Soll",
    "d{}",
    "{}2",
    "{}",
)
_FORMS = (
    *("{n}{j}", "{n}_{j}", "{n} {j}", "{n}[{j}]", "{n}"),
    *("A{j}.{n}", "joint_{j}/{n}", "/j{j}/{n}"),
)
_UNIT_FORMS = ("{} [{}]", "{}[{}]", "{} ({})", "{}_{}", "{}_in_{}", "{}/{}", "{},{}")


def heads(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a log with a random head, read or inspected."""
    joint, form = draw.choice((0, 1, 2, 6, 12, 99)), draw.choice(_FORMS)
    columns: list[tuple[str, NDArray[np.float64]]] = []
    noise = np.random.default_rng(draw.randrange(1 << 30))
    alphabet = draw.randrange(6) if draw.random() < 0.1 else None
    lies = False
    for quantity, values in _QUANTITIES.items():
        if quantity == names.VELOCITY and draw.random() < 0.3:
            continue
        if quantity == names.TORQUE:
            values = values + noise.normal(0, 0.05, len(values))
        name, usual, some = _name(quantity, alphabet, draw)
        unit = draw.choice(usual if draw.random() < 0.7 else some)
        raw = values / units.FACTORS[quantity][unit]
        written = unit if draw.random() < 0.8 else ""
        if draw.random() < 0.1:
            written = draw.choice(some)
        # without unit, values are taken for those of a usual one
        lies |= written != unit and not (written == "" and unit == usual[0])
        if quantity != names.TIME:
            name = form.format(n=name, j=joint)
        columns.append((_with_unit(name, written, draw), raw))
        if draw.random() < 0.3:
            decoy = draw.choice(_DECOYS).format(name)
            columns.append((decoy, draw.choice((raw, 0 * raw, noise.normal(0, 1, len(raw))))))
    if draw.random() < 0.3:
        text = draw.choice([one for one in _TEXTS if b"Zeit" not in one]).decode("utf-8", "replace")
        columns.append((text, np.arange(float(len(TIME)))))
    if draw.random() < 0.5:
        draw.shuffle(columns)
    if draw.random() < 0.1:  # two columns of one name
        one, other = draw.randrange(len(columns)), draw.randrange(len(columns))
        columns[one] = (columns[other][0], columns[one][1])
    _write(folder / LOGS / "day" / "log.csv", columns, draw.choice((";", ",", "\t")))
    if draw.random() < 0.2:
        more = draw.choice(([], ["--json"], ["--suggest-map"]))
        return Input("head, inspected", ["inspect", LOGS, *more])
    check = None if lies else _contradiction
    return Input("head, lies" if lies else "head", ["ingest", LOGS, "-w", WORK], check=check)


def _name(
    quantity: str, alphabet: int | None, draw: random.Random
) -> tuple[str, Sequence[str], Sequence[str]]:
    """Return a name of a quantity, its usual units, the first without saying so, and all units.

    The name is a known one in any spelling, or one in another alphabet.
    """
    usual, some = _USUAL[quantity], sorted({*units.FACTORS[quantity]} - {*_OF_CURRENTS, "%", "‰"})
    if alphabet is not None:
        return _OTHER_ALPHABETS[quantity][alphabet], usual, some
    known = [name for name, one in names.MEANINGS.items() if one.quantity == quantity]
    name = draw.choice(known)
    own = names.MEANINGS[name].unit
    if own == "A":
        usual = some = _OF_CURRENTS
    elif own:
        usual = some = (own,)
    spelled = draw.choice((name, name.title(), name.upper(), f"actual_{name}", f"{name} act"))
    return spelled, usual, some


def _with_unit(name: str, unit: str, draw: random.Random) -> str:
    return draw.choice(_UNIT_FORMS).format(name, unit) if unit else name


def _write(path: Path, columns: Sequence[tuple[str, NDArray[np.float64]]], delimiter: str) -> None:
    path.parent.mkdir(parents=True)
    header = delimiter.join(name.replace(delimiter, " ").replace("\n", " ") for name, _ in columns)
    rows = zip(*(values.tolist() for _, values in columns), strict=True)
    lines = [header, *(delimiter.join(f"{one:.9g}" for one in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", errors="replace")


def _contradiction(work: Path, said: str) -> str:
    """Return how samples differ from the motion that was written; empty if that is told."""
    if "warning:" in said or "note: position of joint" in said:
        return ""
    table = pq.read_table(work / "samples.parquet").to_pandas()
    spans = table.groupby("joint")[["time", "position"]].agg(np.ptp)
    good = np.isclose(spans["time"], np.ptp(TIME), rtol=0.02)
    good &= np.isclose(spans["position"], np.ptp(POSITION), rtol=0.02)
    return "" if good.any() else f"{spans.to_dict('index')}\n{said[-900:]}"
