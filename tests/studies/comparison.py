"""What do public packages say of joints that ``diagnose`` is tried on? Writes docs/comparison.md.

Every method is given the same simulated joint with the same base model. Results are kept in
``build/comparison.csv``; a second call goes on where the first one stopped, and repeats what
changed sources have made stale. Needs the extra ``study``.

Usage: python -m tests.studies.comparison [SEEDS]
"""

import csv
import hashlib
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli.simulator.settings import SynthesisSettings
from tests.simulation.torque_table import simulate_world
from tests.studies.competitors import METHODS
from tests.studies.effect_names import EFFECT_NAMES
from tests.studies.joints import SLIGHT, WORTHWHILE, Finding, Joint

ROOT = Path(__file__).parents[2]
STORE = ROOT / "build" / "comparison.csv"
PAGE = ROOT / "docs" / "comparison.md"
TEXT = Path(__file__).with_name("comparison.txt")
NOISES = ("white", "pair", "drift90", "drift97", "drift99", "outliers", "heteroscedastic")
PACKAGES = ("pysindy", "scikit-learn", "scipy", "numpy")
COLUMNS = (
    *("hidden", "noise", "seed", "method", "sources"),
    *("found", "claims", "gain", "found_gated", "claims_gated", "gain_gated", "seconds"),
)
SHARED = ("simulator", "pairs", "model", "effects", "diagnosis/data/problem.py")

SIZE = 1.0
"""RMS torque of a hidden effect before the base model takes its share. [N·m]"""

FIRST_SEED = 5000
"""The seeds of the other studies, on which the engine was developed, are not used again."""

ANSWERS = ("right alone", "right among several", "wrong", "found, no name", "nothing")
SIGNS = dict(zip(ANSWERS, "RSWU-", strict=True))


@dataclass(frozen=True)
class World:
    """One simulated joint: what is hidden, under which noise."""

    hidden: str
    noise: str
    seed: int

    def joint(self) -> Joint:
        """Simulate it."""
        settings = SynthesisSettings(
            seed=FIRST_SEED + self.seed,
            joint_kind="plain",
            noise_kind=self.noise,
            effects=(f"{self.hidden}:{SIZE}",) if self.hidden else (),
        )
        return Joint.of(simulate_world(settings).torques, self.seed)


def worlds(seeds: int) -> list[World]:
    """Return the clean joints of so many seeds, and those with an effect of one seed less."""
    clean = [World("", noise, seed) for seed in range(seeds) for noise in NOISES]
    hiding = range(max(seeds - 1, 1))
    return clean + [World(name, "default", seed) for seed in hiding for name in EFFECT_NAMES]


def sources() -> dict[str, str]:
    """Return per method a digest of the sources that its results depend on."""
    package = ROOT / "frictioncli"
    studies = [Path(__file__).with_name(name) for name in ("joints.py", "competitors.py")]
    shared = _digest([*(package / name for name in SHARED), *studies])
    own = {"diagnose": _digest([package, *studies])}
    return {method: own.get(method, shared) for method in METHODS}


def _digest(places: Iterable[Path]) -> str:
    files = [
        file
        for place in places
        for file in (sorted(place.rglob("*.py")) if place.is_dir() else [place])
    ]
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:12]


def examined(world: World, missing: dict[str, str]) -> list[list[object]]:
    """Simulate one world and return the rows of the methods that are missing, by their digest."""
    joint = world.joint()
    rows: list[list[object]] = []
    for method, digest in missing.items():
        began = time.perf_counter()
        outcome = METHODS[method](joint)
        spent = f"{time.perf_counter() - began:.1f}"
        key = [world.hidden, world.noise, world.seed, method, digest]
        rows.append([*key, *_cells(outcome.plain), *_cells(outcome.gated), spent])
    return rows


def _cells(finding: Finding) -> list[object]:
    claims = ";".join("|".join(claim) for claim in finding.claims)
    return [int(finding.found), claims, f"{finding.gain:.4f}"]


def stored(seeds: int, current: dict[str, str]) -> pd.DataFrame:
    """Return the rows that are not stale, of the worlds asked for."""
    rows = pd.read_csv(STORE, keep_default_na=False)
    wanted = {(world.hidden, world.noise, world.seed) for world in worlds(seeds)}
    keys = zip(rows["hidden"], rows["noise"], rows["seed"], strict=True)
    known = np.array([key in wanted for key in keys], dtype=bool)
    fresh = rows["sources"] == rows["method"].map(current)
    key = ["hidden", "noise", "seed", "method"]
    return rows[known & fresh].drop_duplicates(key).sort_values(key, ignore_index=True)


def main(seeds: int) -> None:
    """Run what is missing, then write the page."""
    STORE.parent.mkdir(exist_ok=True)
    if not STORE.exists():
        STORE.write_text(",".join(COLUMNS) + "\n", encoding="utf-8")
    current = sources()
    rows = stored(seeds, current)
    done = set(zip(rows["hidden"], rows["noise"], rows["seed"], rows["method"], strict=True))
    with ProcessPoolExecutor() as pool, STORE.open("a", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        tasks = []
        for world in worlds(seeds):
            key = (world.hidden, world.noise, world.seed)
            missing = {name: digest for name, digest in current.items() if (*key, name) not in done}
            if missing:
                tasks.append(pool.submit(examined, world, missing))
        for task in as_completed(tasks):
            writer.writerows(task.result())
            stream.flush()
    PAGE.write_text(page(stored(seeds, current)), encoding="utf-8")


def page(rows: pd.DataFrame) -> str:
    """Return the page: the text with the tables in their places."""
    rows, gated = _answered(rows), _answered(_gated(rows))
    clean, hiding = rows[rows["hidden"] == ""], rows[rows["hidden"] != ""]
    return TEXT.read_text(encoding="utf-8").format(
        clean=clean.groupby("method").size().max(),
        hiding=hiding.groupby("method").size().max(),
        size=SIZE,
        worthwhile=WORTHWHILE,
        slight=SLIGHT,
        versions=", ".join(f"{name} {version(name)}" for name in PACKAGES),
        alarms=_alarms(clean),
        answers=_table(hiding, ("method", *ANSWERS, "names", "gain", "seconds"), _answers),
        gated=_table(gated, ("method", "false alarms", *ANSWERS, "gain"), _gated_answers),
        effects=_effects(hiding),
    )


def _answered(rows: pd.DataFrame) -> pd.DataFrame:
    return rows.assign(answer=[_answer(row) for row in rows.to_dict("records")])


def _answer(row: dict[str, object]) -> str:
    """Return what a row's claims are worth where one effect is hidden."""
    names = set(str(row["claims"]).replace("|", ";").split(";")) - {""}
    if not row["found"]:
        return "nothing"
    if not names:
        return "found, no name"
    if row["hidden"] not in names:
        return "wrong"
    return "right alone" if len(names) == 1 else "right among several"


def _gated(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with what passes the gates of ``diagnose``."""
    return rows.assign(**{name: rows[f"{name}_gated"] for name in ("found", "claims", "gain")})


def _table(
    rows: pd.DataFrame, titles: Iterable[str], cells: Callable[[pd.DataFrame], list[str]]
) -> str:
    titles = list(titles)
    lines = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    for method in METHODS:
        part = rows[rows["method"] == method]
        lines.append("| " + " | ".join([method, *cells(part)]) + " |")
    return "\n".join(lines)


def _alarms(clean: pd.DataFrame) -> str:
    def cells(part: pd.DataFrame) -> list[str]:
        alarms = part[part["found"] == 1]
        worst = f"{alarms['gain'].min():.0%}" if len(alarms) else ""
        kinds = [_ratio(part.loc[part["noise"] == noise, "found"]) for noise in NOISES]
        return [*kinds, _ratio(part["found"]), _median(alarms["gain"]), worst]

    return _table(clean, ("method", *NOISES, "all", "their gain", "the worst"), cells)


def _answers(part: pd.DataFrame) -> list[str]:
    names = part.loc[part["claims"] != "", "claims"].str.replace("|", ";").str.split(";").str.len()
    mean = f"{names.mean():.1f}" if len(names) else ""
    return [*_counts(part), mean, _median(part["gain"]), f"{part['seconds'].median():.1f}"]


def _gated_answers(part: pd.DataFrame) -> list[str]:
    clean, hiding = part[part["hidden"] == ""], part[part["hidden"] != ""]
    return [_ratio(clean["found"]), *_counts(hiding), _median(hiding["gain"])]


def _effects(hiding: pd.DataFrame) -> str:
    """Return what each method said of each effect, one sign per joint."""
    lines = ["| hidden | " + " | ".join(METHODS) + " |", "|---|" + "---|" * len(METHODS)]
    for name in EFFECT_NAMES:
        part = hiding[hiding["hidden"] == name]
        cells = [
            " ".join(SIGNS[answer] for answer in part.loc[part["method"] == method, "answer"])
            for method in METHODS
        ]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _counts(part: pd.DataFrame) -> list[str]:
    return [str(int((part["answer"] == answer).sum())) for answer in ANSWERS]


def _ratio(found: pd.Series) -> str:
    return f"{int(found.sum())}/{len(found)}"


def _median(values: pd.Series) -> str:
    return f"{values.median():.0%}" if len(values) else ""


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
