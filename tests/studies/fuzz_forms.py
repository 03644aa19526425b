"""Damaged maps, manifests, tables of contents, work folders, recordings and options, from a number.

Each input is a folder and the words of a call in it, which has to end with status 0, 2 or 3: 2 with
one message and everything in the work folder as it was.
"""

import csv
import hashlib
import io
import os
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tests.studies.fuzz_call import call, commands
from tests.studies.fuzz_damage import _CELLS, _TEXTS, _damaged
from tests.studies.fuzz_heads import heads
from tests.studies.fuzz_input import LOGS, RICH, RICH_LOGS, WORK, Input
from tests.studies.fuzz_recordings import COLUMNS, RECORDINGS, WRITERS, recording
from tests.studies.fuzz_work import work_folders

_INSPECTIONS: tuple[list[str], ...] = ([], ["--json"], ["--suggest-map"], ["--verbose"])
STATUS = (0, 2, 3)
"""Exit status that a call may have."""

_TOML = (
    *("1e308", "-1e308", "1e-308", "1e9", "1e-9", "0.5", "-2"),
    *("0", "-1", "1e999", "nan", "-inf", "true", "[]", "{}", '""', '"x"', "1979-05-27", "0x10"),
    *(
        "9" * 400,
        '["a", 1]',
        "[" * 300 + "]" * 300,
        '"' + "x" * 9000 + '"',
        "'''a\nb'''",
        '"\\u0000"',
    ),
    *('"utf-16"', '"idna"', '";"', '"°"', '"rad"', '"A"', '"torque_2"', "{ a = { b = 1 } }", "2.0"),
)
_OPTION = (
    *(
        "",
        "0",
        "-1",
        "1",
        "2.5",
        "1e308",
        "1e-308",
        "nan",
        "inf",
        "-inf",
        "x",
        "9" * 400,
        "é",
        "\u0661",
    ),
    *(
        "1,2",
        "1:2",
        "..",
        "/",
        "/dev/null",
        "logs",
        "work",
        "none",
        "auto",
        "a\nb",
        "-",
        "1e5",
    ),
)


def prepare(base: Path, *, rich: bool = False) -> None:
    """Make the folder that inputs of most forms begin with: logs of a joint and its outputs.

    With ``rich`` also every other output: a diagnosis with a cause, a plan, a challenge.
    """
    from tests.robustness.runs import write_warm_up

    write_warm_up(base / LOGS / "day", levels=(25, 39, 53), seed=1)
    status, said = call(["run", f"{base / LOGS}", "-w", f"{base / WORK}"])
    assert status == 0, said
    shutil.copytree(base / WORK, base / "other")
    if rich:
        write_warm_up(base / RICH_LOGS / "day", seed=1, ripple=1.5)
        logs, work = f"{base / RICH_LOGS}", f"{base / RICH}"
        for words in (["run", logs], ["plan"], ["challenge", logs, "--effect", "stribeck:2"]):
            status, said = call([*words, "-w", work])
            assert status == 0, said
        # challenge leaves the chain without what follows the diagnosis
        for words in (["simulate"], ["evaluate"], ["report"]):
            call([*words, "-w", work])


def maps(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a call with a mapping file that is damaged."""
    shutil.copytree(base / LOGS, folder / LOGS)
    lines = [
        *("[channels]", 'time = "Zeit[sec]"', 'position = "AxisPos_Act2[°]"'),
        *('torque = "GearTorq_Act2[Nm]"', 'motor_temperature = "Motortemperatur2[°C]"', "[units]"),
        *(
            'torque = "N·m"',
            "[csv]",
            'delimiter = ";"',
            "period = 0.012",
            "[scale]",
            "position = 1.0",
            "torque = -1.0",
            "[joint]",
            "number = 2",
            "gear_ratio = 1.0",
        ),
    ]
    kind = draw.choice(("value", "value", "value", "key", "line", "bytes"))
    at = draw.choice([i for i, line in enumerate(lines) if "=" in line])
    key, _, value = lines[at].partition(" = ")
    if kind == "value":
        lines[at] = f"{key} = {draw.choice(_TOML)}"
    elif kind == "key":
        lines[at] = f"{draw.choice(('', 'x', 'number', 'time.x', '[a]', '°', key * 900))} = {value}"
    elif kind == "line":
        lines[at] = draw.choice(
            (lines[at] * 2, f"{lines[at]}\n{lines[at]}", "[joint]", "[[units]]", "[units.torque]")
        )
    content = ("\n".join(lines) + "\n").encode()
    if kind == "bytes":
        kind, content = _damaged(content, draw)
    (folder / "map.toml").write_bytes(content)
    if draw.random() < 0.2:
        more = draw.choice(_INSPECTIONS)
        return Input(f"map: {kind}", ["inspect", LOGS, "--map", "map.toml", *more])
    return Input(f"map: {kind}", ["ingest", LOGS, "--map", "map.toml", "-w", WORK])


def manifests(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a call on logs whose manifest is damaged."""
    shutil.copytree(base / LOGS, folder / LOGS)
    path = folder / LOGS / "day" / "manifest.csv"
    rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8")), delimiter=";"))
    added = [["payload", "ambient"], *[["2", "21"]] * len(rows[1:])]
    rows = [[*row, *more] for row, more in zip(rows, added, strict=True)]
    kind = _damage_rows(rows, draw)
    delimiter = draw.choice((";", ";", ";", ",", "\t"))
    content = _csv(rows, delimiter)
    if draw.random() < 0.25:
        kind, content = _damaged(content, draw)
    path.write_bytes(content)
    return Input(f"manifest: {kind}", ["ingest", LOGS, "-w", WORK])


def contents(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a fleet whose table of contents is damaged; its only log is refused at once."""
    for day in "12":
        (folder / LOGS / day).mkdir(parents=True)
        (folder / LOGS / day / "log.csv").write_text("t;q\n", encoding="utf-8")
    rows = [["robot", "joint", "run", "path", "map", "gear_ratio"]]
    rows += [["A", j, f"2024-01-0{day}", f"logs/{day}", "", "1"] for j in "12" for day in "12"]
    kind = _damage_rows(rows, draw)
    if draw.random() < 0.3:
        name, columns = "fleet.parquet", list(zip(*rows[1:], strict=False))
        arrays = [_column(column, draw) for column in columns]
        names = [*rows[0], *"abcdefgh"][: len(arrays)]
        sink = io.BytesIO()
        pq.write_table(pa.Table.from_arrays(arrays, names), sink)
        content = sink.getvalue()
    else:
        name, content = "fleet.csv", _csv(rows, draw.choice((";", ",")))
    if draw.random() < 0.3:
        kind, content = _damaged(content, draw)
    (folder / name).write_bytes(content)
    return Input(f"contents: {kind}", ["fleet", name, "-w", WORK])


def _column(values: tuple[str, ...], draw: random.Random) -> pa.Array:
    kind = draw.choice(("text", "text", "number", "bytes", "dictionary"))
    if kind == "bytes":
        return pa.array([b"\xff" + value.encode() for value in values])
    if kind == "number":
        return pa.array([float(i) for i, _ in enumerate(values)])
    array = pa.array(values)
    return array.dictionary_encode() if kind == "dictionary" else array


def _damage_rows(rows: list[list[str]], draw: random.Random) -> str:
    """Damage cells of a table; the first row is its header."""
    kind = draw.choice(("cell", "cell", "cell", "lost", "more", "twice", "header", "huge", "none"))
    row = draw.randrange(len(rows))
    at = draw.randrange(len(rows[row]))
    if kind == "cell":
        rows[row][at] = draw.choice((*_CELLS, *_TEXTS)).decode("utf-8", "replace")
    elif kind == "lost":
        del rows[row][at]
    elif kind == "more":
        rows[row].append("x")
    elif kind == "twice":
        rows.append(list(rows[row]))
    elif kind == "header":
        rows[0][draw.randrange(len(rows[0]))] = draw.choice(("", rows[0][0], "Path", "x"))
    elif kind == "huge":
        rows[row][at] = "9" * draw.choice((400, 5_000, 200_000))
    return kind


def _csv(rows: list[list[str]], delimiter: str) -> bytes:
    sink = io.StringIO()
    csv.writer(sink, delimiter=delimiter, lineterminator="\n").writerows(rows)
    return sink.getvalue().encode("utf-8", "surrogatepass")


def options(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a call with options of strange values."""
    for name in (LOGS, WORK, "other"):
        shutil.copytree(base / name, folder / name)
    known = commands()
    command = draw.choice(sorted(known))
    words = [command]
    if command in ("inspect", "ingest", "challenge", "run"):
        words.append(LOGS)
    elif command == "fleet":
        shutil.copytree(base / LOGS, folder / "robots" / "robot=A" / "joint=2" / "run=1")
        shutil.rmtree(folder / WORK)
        words += ["robots", "--no-report", "--no-diagnosis"]
    elif command == "compare":
        words += [WORK, "other"]
    elif command == "synthesize":
        words.append("made")
    elif command == "export":
        words += ["--to", draw.choice(("json", "c"))]
    if "-w" in known[command]:
        words += ["-w", WORK]
    for name in draw.sample(
        sorted(known[command]), min(len(known[command]), draw.choice((1, 1, 2)))
    ):
        if name not in ("--help", "-w"):
            words += [name] if known[command][name] else [name, draw.choice(_OPTION)]
    return Input("options", words)


def binary(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a recording in a container of measurements or messages, damaged."""
    name = draw.choice(RECORDINGS)
    kind, content = _damaged(recording(name), draw)
    (folder / LOGS / "day").mkdir(parents=True)
    (folder / LOGS / "day" / name).write_bytes(content)
    words = ["ingest", LOGS, "-w", WORK]
    if draw.random() < 0.25:
        words = ["inspect", LOGS, *draw.choice(_INSPECTIONS)]
    return Input(f"{name}: {kind}", words)


def rows(folder: Path, base: Path, draw: random.Random) -> Input:
    """Return a whole table, in any container, whose values are damaged."""
    columns = {name: values.copy() for name, values in COLUMNS.items()}
    count = len(columns["time"])
    for _ in range(draw.choice((1, 1, 5, 40))):
        values = columns[draw.choice(sorted(columns))]
        at = draw.randrange(count)
        part = slice(at, at + draw.choice((1, 1, 1, 3, 50)))
        values[part] = draw.choice((np.nan, np.inf, -np.inf, 0.0, 1e308, -1e308, 1e-308, 1e9, -1.0))
    if draw.random() < 0.2:
        at = np.array(sorted(draw.choices(range(count), k=count)))
        columns = {name: values[at] for name, values in columns.items()}
    name = draw.choice(sorted(WRITERS))
    (folder / LOGS / "day").mkdir(parents=True)
    WRITERS[name](folder / LOGS / "day" / name, columns)
    if draw.random() < 0.1:
        return Input(f"values of {name}", ["inspect", LOGS, *draw.choice(_INSPECTIONS)])
    return Input(f"values of {name}", ["ingest", LOGS, "-w", WORK], count)


def examine(form: str, number: int, folder: Path, base: Path) -> tuple[Input, str, str]:
    """Prepare an input in an empty folder and call the program; return the outcome and a text."""
    one = FORMS[form](folder, base, random.Random(f"{form} {number}"))
    before = digests(folder / WORK)
    here = os.getcwd()
    os.chdir(folder)
    try:
        status, said = call(one.words)
    finally:
        os.chdir(here)
    if isinstance(status, str):
        return one, status, said
    if status not in STATUS:
        return one, f"status {status}", said
    # a chain leaves what its stages have made
    chain = one.words[0] in ("challenge", "run", "fleet")
    if status == 2 and not chain and digests(folder / WORK) != before:
        return one, "half-written", said
    if status == 2 and not 1 <= len(said.splitlines()) <= 4 and "Usage:" not in said:
        return one, "not one message", said
    if status == 0 and one.rows is not None:
        wrong = lost_rows(folder / WORK, one.rows)
        return one, "wrong" if wrong else "read", wrong
    if status == 0 and one.check is not None:
        wrong = one.check(folder / WORK, said)
        return one, "wrong" if wrong else "read", wrong
    return one, "refused" if status == 2 else "read", ""


def digests(work: Path) -> dict[str, str]:
    """Return file name -> SHA-256 of a work folder."""
    files = (path for path in sorted(work.rglob("*")) if path.is_file())
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def lost_rows(work: Path, count: int) -> str:
    """Return what is wrong with the number of rows kept and rejected; empty where nothing is."""
    (one,) = pq.read_table(work / "recordings.parquet").to_pylist()
    kept = pq.read_table(work / "samples.parquet").num_rows
    lost = pq.read_table(work / "rejected.parquet").column("row").drop_null()
    if kept + len(lost) != count or len(set(lost.to_pylist())) != len(lost):
        return f"{kept} kept + {len(lost)} rejected of {count} rows"
    if (one["rows_read"], one["rows_kept"], one["rows_rejected"]) != (count, kept, len(lost)):
        return f"{one}, {count} rows"
    return ""


FORMS: dict[str, Callable[[Path, Path, random.Random], Input]] = {
    "maps": maps,
    "manifests": manifests,
    "contents": contents,
    "work": work_folders,
    "options": options,
    "recordings": binary,
    "rows": rows,
    "heads": heads,
}
