# ruff: noqa: TID251
"""How time and memory of the stages grow with the log: one recording of 1e5, 1e6, ... samples.

The log is written as a KUKA trace, read by ``ingest``, and goes through the other stages; each is
a process of its own. Rows of the present package are not measured again. Writes docs/growth.png;
the table is on the page of ``make bench``. A sample needs 45 bytes of disk in the log and 30 in the
work folder while its size is measured; logs of more than 1e8 samples are compressed as they are
made, and read as a stream. What an earlier package took stays, marked so, until measured anew.

Usage: python -m tests.studies.bench_growth [--largest 1e8] [--data FOLDER]
"""

import argparse
import json
import shutil
from pathlib import Path

import numpy as np

from tests.moves import move_sequence
from tests.studies.bench_rounds import ROOT, STORE, measured_run, state
from tests.studies.benching import MEGABYTE, Disagreement, command

STAGES = ("ingest", "pair", "separate", "fit")

_COLOURS = ("#0072B2", "#009E73", "#9A7D00", "#D55E00")
ROWS = STORE / "growth.jsonl"
FIGURE = ROOT / "docs" / "growth.png"

SMALLEST = 10**5
LINEAR_FROM = 10**7
"""Slopes are fitted from this size on: below it, start-up is most of the time."""

SPEEDS = (20.0, 40.0, 67.5, 100.0)
PERIOD = 0.012
CHUNK = 200
"""Laps that are written at a time."""

STREAMED_BEYOND = 10**8
"""Samples beyond which a log is never on the disk as text."""


def write_log(path: Path, samples: int) -> None:
    """Write the trace of one long thermal cycle: there and back at four speeds, over and over.

    It is compressed if its name ends in ``.zst``.
    """
    import pyarrow as pa
    from pyarrow import csv

    generator = np.random.default_rng(9)
    motion = move_sequence(
        [0, 140] * len(SPEEDS) + [0], [v for v in SPEEDS for _ in "to"], period=PERIOD
    )
    lap = {name: motion[name].to_numpy() for name in ("position", "velocity", "acceleration")}
    load = 90 * np.cos(np.radians(lap["position"])) + 6 * np.radians(lap["acceleration"])
    names = ["Zeit[sec]", "AxisPos_Act2[°]", "GearTorq_Act2[Nm]", "Motortemperatur2[K]"]
    schema = pa.schema([(name, pa.float64()) for name in names])
    options = csv.WriteOptions(delimiter=";", quoting_style="none")
    with (
        pa.output_stream(path, compression="detect") as stream,
        csv.CSVWriter(stream, schema, write_options=options) as writer,
    ):
        for begin in range(0, samples, CHUNK * len(load)):
            count = min(CHUNK * len(load), samples - begin)
            number = np.arange(begin, begin + count)
            temperature = 25 + 40 * (1 - np.abs(2 * number / samples - 1))
            laps = {name: np.resize(values, count) for name, values in lap.items()}
            viscous = 3.48 + 15.66 * np.exp(-0.056 * temperature)
            friction = 10.57 + viscous * np.sqrt(np.abs(laps["velocity"]))
            torque = np.resize(load, count) + np.sign(laps["velocity"]) * friction
            columns = [
                np.round(number * PERIOD, 3),
                np.round(laps["position"], 4),
                np.round(torque + generator.normal(0, 0.2, count), 3),
                np.floor(temperature) + 273,
            ]
            writer.write_table(pa.table(dict(zip(names, columns, strict=True)), schema))


def stored() -> list[dict]:
    """Return the rows, one per stage and size; some may be of an earlier package."""
    lines = ROWS.read_text(encoding="utf-8").splitlines() if ROWS.exists() else []
    return [json.loads(line) for line in lines]


def present(rows: list[dict]) -> list[dict]:
    """Return the rows of the present package."""
    return [row for row in rows if row["state"] == state(".")]


def measure_size(samples: int, data: Path) -> list[dict]:
    """Return the rows of one size, up to the first stage that fails."""
    folder = data / f"growth-{samples}"
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "logs").mkdir(parents=True)
    name = "trace.csv.zst" if samples > STREAMED_BEYOND else "trace.csv"
    write_log(folder / "logs" / name, samples)
    rows = []
    for stage in STAGES:
        logs = ["{data}/logs"] if stage == "ingest" else []
        contestant = command(stage, "{frictioncli}", stage, *logs, "-w", "{data}/work")
        out = folder / stage
        out.mkdir()
        try:
            run = measured_run(contestant, folder, out)
        except Disagreement as fault:
            print(f"{samples:.0e} {stage}: {fault}", flush=True)
            break
        row = {"state": state("."), "samples": samples, "stage": stage}
        rows.append(row | {"wall": run.wall, "cpu": run.cpu, "peak": run.peak})
        print(f"{samples:.0e} {stage}: {run.wall:.1f} s, {run.peak / MEGABYTE:.0f} MB", flush=True)
        if stage == "ingest":
            shutil.rmtree(folder / "logs")
    shutil.rmtree(folder)
    return rows


def slope(rows: list[dict], stage: str, measure: str) -> float:
    """Return by which power of the samples a stage's ``wall`` or ``peak`` grows; NaN if unknown."""
    large = [r for r in present(rows) if r["stage"] == stage and r["samples"] >= LINEAR_FROM]
    if len(large) < 2:
        return float("nan")
    samples, values = zip(*((row["samples"], row[measure]) for row in large), strict=True)
    return float(np.polyfit(np.log(samples), np.log(values), 1)[0])


def draw(rows: list[dict]) -> None:
    """Draw time and peak memory by samples, with the slopes in the legends."""
    from frictioncli.report.style import style_context

    with style_context():
        _draw(rows)


def _draw(rows: list[dict]) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4), layout="constrained")
    panels = figure.subplots(1, 2)
    for axes, (measure, scale, label) in zip(
        panels, (("wall", 1.0, "time [s]"), ("peak", MEGABYTE, "peak memory [MB]")), strict=True
    ):
        for stage, colour in zip(STAGES, _COLOURS, strict=True):
            own = sorted((r["samples"], r[measure] / scale) for r in rows if r["stage"] == stage)
            if own:
                text = f"{stage}, slope {slope(rows, stage, measure):.2f}"
                axes.loglog(*zip(*own, strict=True), marker="o", color=colour, label=text)
        axes.set(xlabel="number of samples", ylabel=label)
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, high / 100), high)
        axes.legend()
    figure.savefig(FIGURE, dpi=120, metadata={"Software": None})


def section() -> str:
    """Return the part of the page that tells of growth."""
    rows = stored()
    if not rows:
        return ""
    lines = [
        "## How cost grows",
        "",
        "One recording at 12 ms, read and taken through the stages, each a process of its own.",
        f"Slopes are powers of the number of samples, fitted from {LINEAR_FROM:.0e} on: 1 is linear"
        f" growth, 0 none. A log of more than {STREAMED_BEYOND:.0e} samples is compressed as it is"
        " made, and read as a stream.",
        "",
        "![Time and peak memory by number of samples](growth.png)",
        "",
        "| samples | " + " | ".join(f"{stage} [s] | [MB]" for stage in STAGES) + " |",
        "|---|" + "---|---|" * len(STAGES),
    ]
    for samples in sorted({row["samples"] for row in rows}):
        own = {row["stage"]: row for row in rows if row["samples"] == samples}
        cells = [
            f"{own[s]['wall']:.3g} | {own[s]['peak'] / MEGABYTE:.0f}" if s in own else "not done |"
            for s in STAGES
        ]
        mark = "" if present(list(own.values())) else " *earlier*"
        lines.append(f"| {samples:.0e}{mark} | " + " | ".join(cells) + " |")
    slopes = [f"{slope(rows, s, 'wall'):.2f} | {slope(rows, s, 'peak'):.2f}" for s in STAGES]
    lines += ["| slope | " + " | ".join(slopes) + " |", ""]
    if len(present(rows)) < len(rows):
        lines += ["*Earlier*: measured on an earlier state of the program; no part of slopes.", ""]
    return "\n".join(lines).replace("e+0", "e")


def main() -> None:
    """Measure the sizes that are missing, and draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--largest", type=float, default=1e8, help="Greatest number of samples.")
    parser.add_argument("--data", type=Path, default=STORE / "data", help="Folder for the logs.")
    asked = parser.parse_args()
    rows = stored()
    ROWS.parent.mkdir(parents=True, exist_ok=True)
    samples = SMALLEST
    while samples <= asked.largest:
        if not any(row["samples"] == samples for row in present(rows)):
            rows = [row for row in rows if row["samples"] != samples]
            rows += measure_size(samples, asked.data)
            ROWS.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
        samples *= 10
    draw(rows)


if __name__ == "__main__":
    main()
