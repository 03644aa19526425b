"""Constant-velocity parts out of Parquet against pandas, and angle bins against interpolation."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from tests.studies.benching import Disagreement, Goal, Round, Work, faster, function, peak, rate

PERIOD = 0.012
SPEEDS = (10.0, 20.0, 40.0, 80.0, 160.0)
ANGLE = 150.0
"""Way of every move. [deg]"""

FRICTION = 12.0
NOISE = 1.0
"""Friction torque, and standard deviation of the torque's noise. [N·m]"""

GRID = np.arange(-70.0, 71.0, 5.0)
"""Angles at which friction is wanted; bins of 5 deg have their centres there. [deg]"""

PART_COLUMNS = ("run", "recording", "joint", "time", "velocity", "torque")
_BLOCK = 1 << 18


def works(small: bool) -> list[Work]:
    """Return parts of long logs, of short moves too, and bins of many pairs."""
    rows = 10**6 if small else 2 * 10**7
    pairs = 200 if small else 2000
    return [
        _parts("parts", rows, SPEEDS),
        _parts("parts-short-moves", rows, (100.0, 120.0, 150.0)),
        _bins(pairs),
    ]


def _parts(name: str, rows: int, speeds: tuple[float, ...]) -> Work:
    rows -= rows % len(cycle(speeds)[0])  # whole cycles
    return Work(
        name=name,
        title=f"Constant-velocity parts of {rows / 1e6:.3g} M samples in Parquet,"
        f" moves at {speeds[0]:g} to {speeds[-1]:g} deg/s",
        prepare=partial(write_samples, rows=rows, speeds=speeds),
        contestants=[
            function(
                "frictioncli",
                "tests.studies.bench_motion:parts_of_frictioncli",
                shown="frictioncli.pairs.constant_speed_segments over tables.batches(samples)",
            ),
            function(
                "pandas",
                "tests.studies.bench_motion:parts_of_pandas",
                shown="pandas.read_parquet, rolling mean and diff of velocity, groupby(...).agg",
            ),
        ],
        check=same_parts,
        goals=[
            rate("frictioncli", rows, "rows", must=20e6),
            faster("frictioncli", "pandas", must=3),
            peak("frictioncli", 256),
        ],
        sources=("pairs", "tables.py"),
    )


def _bins(pairs: int) -> Work:
    return Work(
        name="bins",
        title=f"Friction at 29 angles of {pairs} pairs of moves, 3,700 samples each",
        prepare=partial(write_pairs, pairs=pairs),
        contestants=[
            function(
                "frictioncli",
                "tests.studies.bench_motion:bins_of_frictioncli",
                times=3,
                shown="frictioncli.pairs.bins.bin_means of many moves at once",
            ),
            function(
                "np.interp",
                "tests.studies.bench_motion:loop_of_interp",
                times=3,
                shown="np.interp(angles, position, torque) of each move",
            ),
        ],
        check=near_truth,
        goals=[
            rate("frictioncli", pairs, "pairs", must=40_000),
            faster("frictioncli", "np.interp", must=1),
            Goal(
                text="RMS error of friction, frictioncli to np.interp",
                figure=lambda runs: runs["frictioncli"].result / runs["np.interp"].result,
                must=2 / 3,
                at_most=True,
            ),
        ],
        sources=(
            "pairs/bins.py",
            "pairs/_bin_runs.c",
            "pairs/slices.py",
        ),
    )


def cycle(speeds: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return velocity and angle of a move there and back at each speed, with ramps and rests."""
    moves = []
    for speed in speeds:
        rest, ramp = np.zeros(25), np.linspace(0.0, 1.0, 13)[1:-1]
        hold = np.ones(round(ANGLE / speed / PERIOD) - len(ramp))
        move = np.concatenate([rest, ramp, hold, ramp[::-1], rest])
        move *= ANGLE / PERIOD / move.sum()
        moves += [move, -move]
    velocity = np.concatenate(moves)
    return velocity, -ANGLE / 2 + PERIOD * np.cumsum(velocity)


def write_samples(data: Path, *, rows: int, speeds: tuple[float, ...]) -> None:
    """Write ``samples.parquet``, as ingest does, of recordings of 260,000 samples."""
    import pyarrow as pa

    from frictioncli import schemas, tables
    from frictioncli.provenance import Provenance

    velocity, position = cycle(speeds)
    generator = np.random.default_rng(7)
    path = data / "samples.parquet"
    with tables.TableWriter(path, schemas.SAMPLES, Provenance("ingest")) as writer:
        block = _BLOCK - _BLOCK % len(velocity)
        for first in range(0, rows, block):
            step = np.arange(first, min(first + block, rows))
            now = step % len(velocity)
            torque = FRICTION * np.sign(velocity[now])
            n = len(step)
            writer.write(
                pa.table(
                    {
                        "run": pa.array(["day1"] * n).dictionary_encode(),
                        "recording": pa.array([f"log{first // block:04d}"] * n),
                        "joint": np.full(n, 2, np.int16),
                        "time": (PERIOD * step).round(3),
                        "position": position[now].round(4),
                        "velocity": velocity[now] + generator.normal(0, 0.05, n),
                        "torque": (torque + generator.normal(0, NOISE, n)).round(3),
                        "motor_temperature": np.full(n, 40.0),
                    }
                )
            )


def parts_of_frictioncli(data: Path, out: Path) -> Callable[[], int]:
    """Prepare the package's way; the act leaves speed and mean torque of every part."""
    # pyarrow imports it for the first array: as for pandas' way, imports are no part of the work
    import pandas as pd  # noqa: F401

    from frictioncli import schemas, tables
    from frictioncli.pairs.chunks import chunks
    from frictioncli.pairs.constant_speed import constant_speed_segments
    from frictioncli.pairs.settings import SteadySettings
    from frictioncli.pairs.slices import slice_means
    from frictioncli.stages.prefetch import prefetch

    wanted = [column for column in schemas.SAMPLES.columns if column.name in PART_COLUMNS]
    table, settings = replace(schemas.SAMPLES, columns=tuple(wanted)), SteadySettings()

    def act() -> int:
        found = []
        batches = prefetch(tables.batches(data / "samples.parquet", table))
        for chunk in chunks(batches, ("torque",), settings):
            time, velocity = chunk.channels["time"], chunk.channels["velocity"]
            segments = constant_speed_segments(
                time, velocity, chunk.total, chunk.move_start, chunk.move_stop, settings
            )
            torque = slice_means(chunk.channels["torque"], segments.start, segments.stop)
            found.append(np.stack([segments.speed, torque]))
        return left(out, np.concatenate(found, axis=1))

    return act


def parts_of_pandas(data: Path, out: Path) -> Callable[[], int]:
    """Prepare what one would write with pandas; the act leaves the same."""
    import pandas as pd

    def act() -> int:
        frame = pd.read_parquet(data / "samples.parquet", columns=list(PART_COLUMNS))
        speed = frame["velocity"].rolling(9, center=True, min_periods=1).mean()
        steady = (speed.abs() > 0.2) & (speed.diff().abs() < 0.01 * speed.abs())
        ends = steady.ne(steady.shift()) | frame["recording"].ne(frame["recording"].shift())
        held = frame[steady].groupby(ends.cumsum()[steady])
        parts = held.agg(
            speed=("velocity", "mean"), torque=("torque", "mean"), samples=("torque", "size")
        )
        parts = parts[parts["samples"] >= 20]
        return left(out, parts[["speed", "torque"]].to_numpy().T)

    return act


def left(out: Path, parts: np.ndarray) -> int:
    """Leave parts for the check; return their number."""
    np.save(out / "parts.npy", parts)
    return parts.shape[1]


def same_parts(runs: Round) -> str:
    """Compare speed and mean torque part by part."""
    found = {name: np.load(run.out / "parts.npy") for name, run in runs.items()}
    ours, other = found["frictioncli"], found["pandas"]
    if ours.shape != other.shape:
        raise Disagreement(f"parts: {json.dumps({n: a.shape[1] for n, a in found.items()})}")
    speed = np.max(np.abs(ours[0] / other[0] - 1))
    torque = np.sqrt(np.mean(np.square(ours[1] - other[1])))
    if speed > 0.01 or torque > NOISE:
        raise Disagreement(f"speeds differ by {speed:.2%}, torques by {torque:.3g} N·m")
    return f"{ours.shape[1]:,} parts, speeds within {speed:.1%}, torques within {torque:.2g} N·m"


def write_pairs(data: Path, *, pairs: int) -> None:
    """Write angle and torque of moves from -75 to 75 deg and back at constant speed."""
    generator = np.random.default_rng(8)
    samples = 1850
    there = np.linspace(-75, 75, samples) + generator.uniform(-0.04, 0.04, (pairs, 1))
    position = np.stack([there, there[:, ::-1]], axis=1)
    torque = 90 * np.cos(np.radians(position)) + FRICTION * np.array([[[1.0], [-1.0]]])
    torque += generator.normal(0, NOISE, torque.shape)
    np.save(data / "pairs.npy", np.stack([position, torque]))


def bins_of_frictioncli(data: Path, out: Path) -> Callable[[], float]:
    """Prepare bin means of all moves; the act returns the RMS error of friction. [N·m]"""
    from frictioncli.pairs.bins import bin_means
    from frictioncli.pairs.slices import keep_freed_memory

    keep_freed_memory()
    position, torque = np.load(data / "pairs.npy")
    pairs, _, samples = position.shape
    # the angles wanted are the middles of bins; an angle's zero is no part of the work
    position, torque = position.ravel() + 2.5, torque.ravel()
    together = 2 * 100
    start = samples * np.arange(together)
    none, time = np.full(together * samples, np.nan), PERIOD * np.arange(together * samples)

    def act() -> float:
        friction = np.empty((pairs, len(GRID)))
        for first in range(0, 2 * pairs, together):
            here = slice(first * samples, (first + together) * samples)
            means = bin_means(
                position=position[here],
                torque=torque[here],
                load=none,
                time=time,
                start=start,
                stop=start + samples,
                width=5.0,
            )
            grid = (means.bin >= -14) & (means.bin <= 14)
            both = means.torque[grid].reshape(-1, 2, len(GRID))
            friction[first // 2 : (first + together) // 2] = (both[:, 0] - both[:, 1]) / 2
        return error(friction)

    return act


def loop_of_interp(data: Path, out: Path) -> Callable[[], float]:
    """Prepare interpolation move by move; the act returns the RMS error of friction. [N·m]"""
    position, torque = np.load(data / "pairs.npy")

    def act() -> float:
        friction = np.empty((len(position[:]), len(GRID)))
        for number in range(len(position)):
            ahead = np.interp(GRID, position[number, 0], torque[number, 0])
            back = np.interp(GRID, position[number, 1, ::-1], torque[number, 1, ::-1])
            friction[number] = (ahead - back) / 2
        return error(friction)

    return act


def error(friction: np.ndarray) -> float:
    """Return the RMS error against the friction that the torques were made with. [N·m]"""
    return float(np.sqrt(np.mean(np.square(friction - FRICTION))))


def near_truth(runs: Round) -> str:
    """Both find the friction within what the noise allows."""
    errors = {name: float(run.result) for name, run in runs.items()}
    if max(errors.values()) > NOISE:
        raise Disagreement(f"RMS errors of friction: {json.dumps(errors)} N·m")
    return "RMS error of friction " + ", ".join(f"{n} {e:.3g} N·m" for n, e in errors.items())
