"""Text logs to Parquet: one large file, thousands of small ones, and the memory it takes."""

import hashlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from tests.studies.benching import (
    MEGABYTE,
    Contestant,
    Disagreement,
    Goal,
    Round,
    Work,
    command,
    faster,
    peak,
)

HEADER = "Zeit[sec];AxisPos_Act2[°];AxisVel_Act2[°/s];GearTorq_Act2[Nm];MotorTemp_Act2[°C]\n"
PERIOD = 0.004
CYCLE = 100_000
"""Rows after which everything but time repeats; they take 400 s."""

READ = ("logs", "tables.py", "files.py", "provenance.py", "schemas.py")
SAMPLES = ("time", "position", "velocity", "torque", "motor_temperature")
IMPORTS = 130 * MEGABYTE
"""What Python with pyarrow and pandas takes before any work. [bytes]"""

PANDAS = "pd.read_csv(f, sep=';', decimal=',')"
PARSE = (
    "import sys; from pyarrow import csv;"
    " print(csv.read_csv(sys.argv[1], parse_options=csv.ParseOptions(delimiter=';'),"
    " convert_options=csv.ConvertOptions(decimal_point=',')).num_rows)"
)
POLARS = (
    "import sys, polars as pl;"
    " pl.scan_csv(sys.argv[1], separator=';', decimal_comma=True)"
    ".sink_parquet(sys.argv[2], compression='zstd', compression_level=1)"
)


def works(small: bool) -> list[Work]:
    """Return one large log, the same with points for commas, many logs, and a very large one."""
    rows, files = (10**6, 100) if small else (48 * 10**6, 2000)
    return [_large(rows), _decimal_sign(rows // 4), _many(files), _memory(rows // 2)]


def _large(rows: int) -> Work:
    return Work(
        name="csv",
        title=f"One log of {rows * 42 / 1e9:.2g} GB to Parquet, decimal comma, rows in order",
        prepare=partial(write_log, name="log.csv", rows=rows),
        contestants=[
            _ingest("frictioncli", "{data}/log.csv"),
            command(
                "pandas",
                *("{python}", "-c"),
                f"import sys, pandas as pd; f = sys.argv[1]; {PANDAS}.to_parquet(sys.argv[2])",
                *("{data}/log.csv", "{out}/log.parquet"),
                shown=f"{PANDAS}.to_parquet(...)",
            ),
            command(
                "pyarrow's parse alone",
                *("{python}", "-c", PARSE, "{data}/log.csv"),
                shown="pyarrow.csv.read_csv(f, delimiter ';', decimal_point ',')",
            ),
            command(
                "polars",
                *("{python}", "-c", POLARS, "{data}/log.csv", "{out}/log.parquet"),
                shown="polars.scan_csv(f, separator=';', decimal_comma=True).sink_parquet(zstd 1)",
            ),
        ],
        check=same_numbers,
        goals=[
            faster("frictioncli", "pandas", 2, 2.5),
            faster("frictioncli", "pyarrow's parse alone", 0.75, 1.0),
            faster("frictioncli", "polars", 0.9, 1.2),
            peak("frictioncli", (IMPORTS + 256e6) / MEGABYTE),
        ],
        sources=READ,
    )


def _decimal_sign(rows: int) -> Work:
    return Work(
        name="csv-decimal",
        title=f"Decimal comma against decimal point, {rows * 42 / 1e9:.2g} GB",
        prepare=partial(write_both, rows=rows),
        contestants=[_ingest("comma", "{data}/comma.csv"), _ingest("point", "{data}/point.csv")],
        check=same_samples,
        goals=[faster("comma", "point", 0.9, measure="cpu")],
        sources=READ,
    )


def _many(files: int) -> Work:
    pandas = (
        "import sys, pathlib, pandas as pd\n"
        "for f in sorted(pathlib.Path(sys.argv[1]).glob('*.csv')):\n"
        f"    {PANDAS}.to_parquet(pathlib.Path(sys.argv[2], f.name + '.parquet'))"
    )
    return Work(
        name="csv-many",
        title=f"{files} logs of 10,000 rows to Parquet",
        prepare=partial(write_many, files=files),
        contestants=[
            _ingest("frictioncli", "{data}/logs"),
            command(
                "pandas, a loop",
                *("{python}", "-c", pandas, "{data}/logs", "{out}"),
                shown=f"for f in files: {PANDAS}.to_parquet(...)",
            ),
        ],
        check=same_numbers,
        goals=[
            faster("frictioncli", "pandas, a loop", 4, 5),
            peak("frictioncli", 200),
        ],
        sources=READ,
    )


def _memory(rows: int) -> Work:
    return Work(
        name="csv-memory",
        title=f"Memory for {rows * 42 / 1e9:.2g} GB and for ten times as much",
        prepare=partial(write_small_and_large, rows=rows),
        contestants=[_ingest("once", "{data}/once.csv"), _ingest("tenfold", "{data}/tenfold.csv")],
        check=tenfold_rows,
        goals=[
            peak("tenfold", (IMPORTS + 256e6) / MEGABYTE),
            Goal(
                text="peak memory, tenfold to once",
                figure=lambda runs: runs["tenfold"].peak / runs["once"].peak,
                must=1.1,
                at_most=True,
            ),
        ],
        sources=READ,
    )


def _ingest(name: str, logs: str) -> Contestant:
    return command(
        name, "{frictioncli}", "ingest", logs, "-w", "{out}", shown="frictioncli ingest LOGS -w RUN"
    )


def cycle() -> list[str]:
    """Return the rows of a joint that moves there and back, without their times."""
    time = PERIOD * np.arange(CYCLE)
    noise = np.random.default_rng(4).normal(size=(2, CYCLE))
    velocity = 40 * np.sign(np.sin(2 * np.pi * time / 8))
    position = -50 + PERIOD * np.cumsum(velocity)
    measured = velocity + 0.1 * noise[0]
    torque = 5 + 20 * np.sign(velocity) + 0.3 * noise[1]
    temperature = 30 + 5 * np.sin(np.pi * time / 400)
    columns = (position.round(4), measured.round(4), torque.round(4), temperature.round(3))
    return [";".join(map(str, row)) for row in zip(*map(np.ndarray.tolist, columns), strict=True)]


def write_log(
    data: Path,
    *,
    name: str,
    rows: int,
    first: int = 0,
    decimal: str = ",",
    kept: Sequence[str] = (),
) -> None:
    """Write a log of many cycles, from sample ``first`` on."""
    body = [row.replace(".", decimal) for row in kept or cycle()]
    with (data / name).open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(HEADER)
        for start in range(first, first + rows, CYCLE):
            steps = range(start, min(start + CYCLE, first + rows))
            stream.writelines(
                f"{step // 250}{decimal}{step % 250 * 4:03d};{body[step % CYCLE]}\n"
                for step in steps
            )


def write_both(data: Path, *, rows: int) -> None:
    """Write the same log with decimal comma and with decimal point."""
    write_log(data, name="comma.csv", rows=rows)
    write_log(data, name="point.csv", rows=rows, decimal=".")


def write_many(data: Path, *, files: int) -> None:
    """Write many short logs that follow one another."""
    kept = cycle()
    (data / "logs").mkdir()
    for number in range(files):
        name = f"log{number:05d}.csv"
        write_log(data / "logs", name=name, rows=10_000, first=10_000 * number, kept=kept)


def write_small_and_large(data: Path, *, rows: int) -> None:
    """Write a log and one ten times as long."""
    write_log(data, name="once.csv", rows=rows)
    write_log(data, name="tenfold.csv", rows=10 * rows)


def digest(files: list[Path], columns: list[str]) -> str:
    """Return a digest of every bit of some columns of doubles, rows in order."""
    found = [hashlib.sha256() for _ in columns]
    for file in files:
        with pq.ParquetFile(file, pre_buffer=False) as table:
            names = columns if set(columns) <= set(table.schema_arrow.names) else None
            for batch in table.iter_batches(columns=names):
                for one, values in zip(found, batch.columns, strict=True):
                    one.update(np.ascontiguousarray(values.cast(pa.float64()).to_numpy()))
    return ", ".join(one.hexdigest()[:12] for one in found)


def same_numbers(runs: Round) -> str:
    """Compare every double of all contestants that wrote any; of many logs time is left out."""
    one_log = "polars" in runs
    columns = list(SAMPLES if one_log else SAMPLES[1:])
    found = {}
    for name, run in runs.items():
        files = sorted(run.out.glob("*.parquet"))
        if name == "frictioncli":
            found[name] = digest([run.out / "samples.parquet"], columns)
        elif files:
            raw = pq.read_schema(files[0]).names
            found[name] = digest(files, raw if one_log else raw[1:])
    if len(set(found.values())) != 1:
        raise Disagreement(f"numbers differ: {found}")
    return f"every bit of {len(columns)} columns of doubles, of {', '.join(found)}"


def same_samples(runs: Round) -> str:
    """Compare every double of two tables of samples."""
    found = {
        name: digest([run.out / "samples.parquet"], list(SAMPLES)) for name, run in runs.items()
    }
    if len(set(found.values())) != 1:
        raise Disagreement(f"numbers differ: {found}")
    return "every bit of 5 columns of doubles"


def tenfold_rows(runs: Round) -> str:
    """Compare the numbers of samples."""
    rows = {
        name: pq.read_metadata(run.out / "samples.parquet").num_rows for name, run in runs.items()
    }
    if rows["tenfold"] != 10 * rows["once"]:
        raise Disagreement(f"rows: {rows}")
    return f"{rows['once']:,} and {rows['tenfold']:,} rows"
