"""Algorithm 3 over 20 values of k and 20 of tmax, against its plain loop."""

import hashlib
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

import numpy as np

from tests.studies.benching import Disagreement, Round, Work, faster, function

SCALES = np.linspace(1.0, 20.0, 20)
FORCED = 60.0 * np.linspace(6.0, 120.0, 20)
"""Values of k, and of tmax. [s]"""


def works(small: bool) -> list[Work]:
    """Return grids over two lengths of a log."""
    sizes = {3000: (1, None)} if small else {10**5: (7, None), 10**6: (7, 20)}
    return [_work(size, must, reach) for size, (must, reach) in sizes.items()]


def _work(steps: int, must: float, reach: float | None) -> Work:
    return Work(
        name=f"schedule-{steps:.0e}".replace("+0", ""),
        title=f"Correction schedules, 20 x 20 of k and tmax, {steps:.0e} steps".replace("+0", ""),
        prepare=partial(warm, steps=steps),
        contestants=[
            function(
                "frictioncli",
                "tests.studies.bench_schedule:side_by_side",
                shown="frictioncli.correction.schedule.first_degree(time, temperature, k=, tmax=)",
            ),
            function(
                "plain loop",
                "tests.studies.bench_schedule:plain_loops",
                shown="tests.studies.bench_schedule.plain_loop over lists, for each k and tmax",
            ),
        ],
        check=same_events,
        goals=[faster("frictioncli", "plain loop", must, reach)],
        sources=("correction/schedule.py", "correction/degree_crossings.py"),
    )


def warm(data: Path, steps: int) -> None:
    """Write one instant a second, and the whole degrees that a controller registers."""
    time = 1.0 * np.arange(steps)
    noise = np.random.default_rng(20).normal(0, 0.02, steps)
    np.save(data / "log.npy", np.stack([time, np.round(45 + 20 * np.sin(time / 3000) + noise)]))


def grid() -> tuple[np.ndarray, np.ndarray]:
    """Return k and tmax of the 400 schedules."""
    k, tmax = np.meshgrid(SCALES, FORCED, indexing="ij")
    return k.ravel(), tmax.ravel()


def side_by_side(data: Path, out: Path) -> Callable[[], list[object]]:
    """Prepare frictioncli's schedules, all 400 at once."""
    from frictioncli.correction.schedule import first_degree

    time, temperature = np.load(data / "log.npy")
    k, tmax = grid()
    return lambda: told(
        events.tolist() for events in first_degree(time, temperature, k=k, tmax=tmax)
    )


def plain_loops(data: Path, out: Path) -> Callable[[], list[object]]:
    """Prepare Algorithm 3 as it is written, step by step, one schedule after the other."""
    time, temperature = (column.tolist() for column in np.load(data / "log.npy"))
    rules = list(zip(*(values.tolist() for values in grid()), strict=True))
    return lambda: told(plain_loop(time, temperature, k, tmax) for k, tmax in rules)


def plain_loop(time: list[float], temperature: list[float], k: float, tmax: float) -> list[int]:
    """Return the corrections of one schedule, with the first change by a degree as Delta_t."""
    events, start, registered = [0], time[0], temperature[0]
    limit, waiting = tmax, True
    for i, (now, degrees) in enumerate(zip(time, temperature, strict=True)):
        if waiting and abs(degrees - registered) >= 1:
            limit, waiting = min(k * (now - start), tmax), False
        if now - start > limit:
            events.append(i)
            start, registered = now, degrees
            limit, waiting = tmax, True
    return events


def told(schedules: Iterable[list[int]]) -> list[object]:
    """Return the number of events of all schedules and a digest of them."""
    every = list(schedules)
    return [sum(map(len, every)), hashlib.sha256(repr(every).encode()).hexdigest()]


def same_events(runs: Round) -> str:
    """Check that both have the same events in every schedule."""
    (count, ours), (_, theirs) = (runs[name].result for name in ("frictioncli", "plain loop"))
    if ours != theirs:
        raise Disagreement("the schedules have other events than the plain loop")
    return f"The same {count} events in 400 schedules."
