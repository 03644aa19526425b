"""Study of what has no name: laws outside the catalogue, located, described, used.

Each law is added to the torques of simulated joints with all nuisances, by a formula that no form
of the analysis has. Usage:

    python -m tests.studies.unnamed [--laws NAME ...] [--protocols paper enriched] [--seeds N ...]
                                    [--jobs N] [--write]

``--write`` writes ``docs/unnamed.md``.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pandas as pd

from frictioncli.arrays import Array
from frictioncli.diagnosis.diagnose import diagnose_joint, predicting
from frictioncli.diagnosis.documents.document import DiagnosisDocument
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document
from frictioncli.diagnosis.fit.columns import base_rows
from frictioncli.diagnosis.fit.extension import misfits
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from tests.simulation.torque_table import simulate_world
from tests.studies.blind_diagnosed import SETTINGS
from tests.studies.blind_truth import TEMPERATURE, base_and_measurement, problems
from tests.studies.blind_worlds import World
from tests.studies.unnamed_page import Case, write_page

SIZE = 1.0
"""RMS of each law over both days. [N·m]"""

SEEDS = (200,)
"""Joint of the first law, set by set; every law has its own. Thresholds were chosen with 100."""

LEFT = 0.75
"""RMS that the base and the effects of the measurement leave of a law that is planted once more,
where they leave less than the margin of 1 N·m of it: as much as of most others. [N·m]"""


@dataclass(frozen=True)
class Law:
    """A law that the catalogue does not hold.

    Attributes
    ----------
    name : str
        What it is.
    axes : tuple of frozenset of str
        What it depends on; two sets where there are two laws at once.
    channel : {"friction", "load"}
        The torque in which it shows.
    torque : callable
        Of the rows of a table of torques and the load without noise, the torque of unit size.
    """

    name: str
    axes: tuple[frozenset[str], ...]
    channel: str
    torque: Callable[[pd.DataFrame, Array], Array]


def _hump(values: Array, centre: float, half: float) -> Array:
    """Return a raised cosine that is nothing farther than its half-width from its centre."""
    away = np.clip(np.abs(values - centre) / half, 0.0, 1.0)
    return np.asarray((1 + np.cos(np.pi * away)) / 2)


def _of(*axes: str) -> tuple[frozenset[str], ...]:
    return (frozenset(axes),)


LAWS = (
    Law("bump at an angle", _of("position"), "friction", lambda r, _: _hump(r.position, 75, 16)),
    Law(
        "dent at an angle",
        _of("position"),
        "friction",
        lambda r, _: -1 / (1 + np.square((r.position - 120) / 7)),
    ),
    Law(
        "resonance at a speed",
        _of("speed"),
        "friction",
        lambda r, _: 1 / (1 + np.square(np.log(r.speed / 33) / 0.3)),
    ),
    Law(
        "fan that goes on at 45 °C",
        _of("temperature"),
        "friction",
        lambda r, _: np.tanh((r.motor_temperature - 45) / 2),
    ),
    Law(
        "peak at a temperature",
        _of("temperature"),
        "friction",
        lambda r, _: 1 / np.cosh((r.motor_temperature - 41) / 2.5),
    ),
    Law(
        "lifting loss",
        _of("load"),
        "load",
        lambda r, load: np.sign(load) * np.square(load / 50),
    ),
    Law(
        "dead zone of the load",
        _of("load"),
        "friction",
        lambda r, load: np.maximum(0.0, np.abs(load) - 40) / 10,
    ),
    Law(
        "peak at a load",
        _of("load"),
        "friction",
        lambda r, load: 1 / np.cosh((np.abs(load) - 55) / 6),
    ),
    Law(
        "load that hangs at one angle",
        _of("position"),
        "load",
        lambda r, _: _hump(r.position, 100, 22),
    ),
    Law(
        "warped housing",
        _of("position", "temperature"),
        "friction",
        lambda r, _: np.sin(3 * np.radians(r.position - 20)) * (r.motor_temperature - 42) / 20,
    ),
    Law(
        "resonance that moves with temperature",
        _of("speed", "temperature"),
        "friction",
        lambda r, _: 1 / np.cosh((np.log(r.speed / 40) - 0.05 * (r.motor_temperature - 45)) / 0.3),
    ),
    Law(
        "bump at an angle and peak at a temperature",
        (frozenset({"position"}), frozenset({"temperature"})),
        "friction",
        lambda r, _: (
            2.5 * _hump(r.position, 60, 14) + 1 / np.cosh((r.motor_temperature - 47) / 2.5)
        ),
    ),
)
"""Laws that are planted, one or two at once."""


def examined(number: int, protocol: str, seed: int) -> list[Case]:
    """Return a joint with a law, and with more of it where the base takes nearly all.

    Parameters
    ----------
    number : int
        Number of the law.
    protocol : {"paper", "enriched"}
        Programme of the joint.
    seed : int
        The joint's.
    """
    law = LAWS[number]
    first = _examined(law, protocol, seed, SIZE)
    if first.can_be_seen:
        return [first]
    return [first, _examined(law, protocol, seed, SIZE * LEFT / first.left)]


def _examined(law: Law, protocol: str, seed: int, size: float) -> Case:
    """Simulate a joint without and with a law, diagnose both and compare."""
    bare, quiet, without = _bare(protocol, seed)
    torque = np.asarray(law.torque(bare, quiet["load_torque"].to_numpy(float)), float)
    torque = torque * (size / np.sqrt(np.mean(np.square(torque))))
    column = f"{law.channel}_torque"
    rows = bare.assign(**{column: bare[column] + torque})
    began = time.perf_counter()
    diagnosis = diagnose_joint(rows, TEMPERATURE, "N·m", SETTINGS)
    seconds = time.perf_counter() - began
    document = diagnosis_document(diagnosis, SETTINGS)
    left, left_by_base = _left(rows, bare)
    gain, own = document.empirical, diagnosis_document(without, SETTINGS).empirical
    before = _after(diagnosis)
    said = _said(document)
    return Case(
        law=law.name,
        protocol=protocol,
        joint=seed,
        planted=size,
        left=left,
        left_by_base=left_by_base,
        margin=diagnosis.margin,
        verdict=diagnosis.verdict,
        axes=said,
        is_right=set(map(frozenset, said)) == set(law.axes),
        size=_size(document),
        described="; ".join(one.description or "" for one in gain.forms) if gain else "",
        before=before,
        after=gain.rmse_after if gain else before,
        known=_after(without),
        bare_gain=own.reduction if own else 0.0,
        wrong_names=tuple(
            cause.fit.effect.name for cause in diagnosis.causes if not cause.fit.effect.measurement
        ),
        seconds=seconds,
    )


@lru_cache(maxsize=1)
def _bare(protocol: str, seed: int) -> tuple[pd.DataFrame, pd.DataFrame, Diagnosis]:
    """Return a joint's torques without a law, these without noise, and what is said of them."""
    world = World("clean", "", seed, 0.0, protocol=protocol)
    bare = simulate_world(world.settings(())).torques
    quiet = simulate_world(world.settings((), noise_scale=0.0)).torques
    return bare, quiet, diagnose_joint(bare, TEMPERATURE, "N·m", SETTINGS)


def _after(diagnosis: Diagnosis) -> float:
    """Return the misfit of base and causes on the day kept out [N·m]."""
    problem, extension = diagnosis.judged, diagnosis.extension
    left = (problem.friction_misfit, problem.load_misfit)
    if extension is not None:
        left = misfits(problem, predicting(extension, diagnosis.causes))
    return float(np.sqrt(np.mean(problem.squared(*left))))


def _said(document: DiagnosisDocument) -> tuple[tuple[str, ...], ...]:
    """Return along which quantities structure is said to be."""
    gain = document.empirical
    if gain is not None and gain.forms:
        return tuple(one.axes for one in gain.forms)
    if document.structure is not None:
        return (tuple(document.structure.axis),)
    return (gain.parts[0].axes,) if gain is not None else ()


def _size(document: DiagnosisDocument) -> float:
    """Return how large what has no name is said to be: of several forms, all together [N·m]."""
    gain, structure = document.empirical, document.structure
    if gain is not None:
        parts = gain.forms or gain.parts[:1]
        return float(np.sqrt(sum(one.size**2 for one in parts)))
    return structure.size if structure is not None else 0.0


def _left(rows: pd.DataFrame, bare: pd.DataFrame) -> tuple[float, float]:
    """Return the RMS of the law that base and measurement leave on the day seen, and base alone."""
    seen, _ = problems(rows)
    plain, _ = problems(bare)
    law = np.concatenate([seen.friction - plain.friction, seen.load - plain.load])
    found = []
    for columns in (base_and_measurement(seen), np.vstack(base_rows(seen))):
        left = law - columns @ np.linalg.lstsq(columns, law, rcond=1e-10)[0]
        found.append(float(np.sqrt(2 * np.mean(np.square(left)))))
    return found[0], found[1]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the study and print a line per joint."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--laws", nargs="+", default=[one.name for one in LAWS])
    parser.add_argument("--protocols", nargs="+", default=["paper", "enriched"])
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, help="first law's joints")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args(arguments)
    asked = [
        (number, protocol, seed + number)
        for seed in given.seeds
        for protocol in given.protocols
        for number, law in enumerate(LAWS)
        if law.name in given.laws
    ]
    cases = []
    with ProcessPoolExecutor(given.jobs) as pool:
        for found in pool.map(examined, *zip(*asked, strict=True)):
            for case in found:
                cases.append(case)
                print(line(case), flush=True)
    if given.write:
        write_page(cases)


def line(case: Case) -> str:
    """Return a case in one line."""
    return (
        f"{'ok' if case.is_right else 'MISSED':6} {case.protocol:8} {case.law:42}"
        f" {case.planted:.1f} N·m, left {case.left:.2f}, by base {case.left_by_base:.2f}"
        f" (margin {case.margin:.2f})"
        f" {case.verdict} {case.axes} size"
        f" {case.size:.2f} | day {case.before:.2f} -> {case.after:.2f}, known {case.known:.2f},"
        f" share {case.gain:.2f} | bare {case.bare_gain:+.1%} {','.join(case.wrong_names)} |"
        f" {case.described} | {case.seconds:.0f} s"
    )


if __name__ == "__main__":
    main()
