"""Are the rules of a detectable size right, or the shapes that it is worked out for?

Usage: python -m tests.studies.challenge_rules WORK [NAME]

WORK is that of ``tests.studies.challenge`` after a search, NAME the case, ``kr10`` by default. The
size that a name needs is worked out for the torque that was planted there, instead of five shapes
of the catalogue, and stands beside the size at which it was found in docs/challenge.md.
"""

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

import numpy as np

from frictioncli import schemas, tables
from frictioncli.challenge.subject import Subject, read_subjects
from frictioncli.challenge.trial import Planter
from frictioncli.challenge_schema import CHALLENGE
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.detectable import detectable_sizes
from frictioncli.diagnosis.fit.columns import main_channel
from frictioncli.diagnosis.fit.left_by_base import left_by, span_of
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.ramps.evidence import ramp_logs
from frictioncli.diagnosis.search import detectable_size
from frictioncli.diagnosis.search.planted_torque import PlantedTorque
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import BY_NAME
from frictioncli.effects.base import Basis, Effect
from frictioncli.report.challenge_words import rows_of_table
from frictioncli.stages.settings import RunSettings
from frictioncli.wording import number_text
from frictioncli.workfiles import CHALLENGE as FILE
from frictioncli.workfiles import RAMPS, TORQUES
from tests.studies.challenge import SAMPLES

PAGE = Path(__file__).parents[2] / "docs" / "challenge.md"
BEGIN, END = "<!-- rules -->\n", "<!-- /rules -->\n"

CLOSE = 1.5
"""Factor within which a size by the rules shall be of the one found."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """One shape of a planted effect.

    Attributes
    ----------
    effect : str
        Its name.
    by_rules : float or None
        Size from which on it is named by the rules; none where it never is. [N·m]
    found : float
        Size at which it was found. [N·m]
    left : float
        Share of its torque that the base leaves. [-]
    missed : float
        Share of that which no coefficients of the effect explain. [-]
    """

    effect: str
    by_rules: float | None
    found: float
    left: float
    missed: float


def diagnosis_of(subject: Subject, work: Path) -> Diagnosis:
    """Return the diagnosis of a joint as it was logged."""
    facts = tables.facts(work / TORQUES)
    ramps = ramp_logs(work / RAMPS, facts.get("sign", {})).get(subject.joint)
    torques = tables.read(work / TORQUES, schemas.TORQUES)
    rows, temperature = torques[torques["joint"] == subject.joint], subject.model.temperature
    unit = facts.get("torque_unit", "N·m")
    return diagnose_joint(rows, temperature, unit, DiagnosisSettings(), ramps=ramps)


def planted(planter: Planter, diagnosis: Diagnosis, name: str, seed: int, size: float) -> Basis:
    """Return what a law adds to the rows of a diagnosis, shape (rows, 1) in each channel [N·m]."""
    friction, load, rows = planter.added_torque(name, seed, size)
    order = rows.assign(place=np.arange(len(rows)))
    order = order.sort_values(["run", "time", "pair", "position"])["place"].to_numpy()
    problem = diagnosis.base
    if not np.allclose(rows["load_torque"].to_numpy()[order], problem.load, atol=1e-6):
        raise ValueError("the rows of the diagnosis are not those of the pairs")
    return Basis(friction[order, np.newaxis], load[order, np.newaxis])


def nearest(diagnosis: Diagnosis, effect: Effect, torque: Basis) -> tuple[PlantedTorque, float]:
    """Return a torque of size 1 with the shape of its effect that explains most of it.

    And the share of what the base leaves of it that this shape misses.
    """
    problem, step = diagnosis.base, diagnosis.search.step
    size = float(np.sqrt(np.mean(np.square(main_channel(torque, effect)))))
    torque = Basis(*(one / size for one in torque))
    others = [problem.basis(one.effect, one.shape) for one in step.accepted]
    span = span_of(problem, [*step.precomputed.measurement, *others])
    wanted = left_by(span, torque)[:, 0]
    found = []
    for shape in effect.shapes(problem.all_runs):
        columns = problem.basis(effect, shape)
        left = left_by(span, columns)
        scale = np.linalg.norm(left, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        coefficients = np.linalg.lstsq(left / scale, wanted, rcond=1e-10)[0] / scale
        missed = float(np.linalg.norm(wanted - left @ coefficients))
        one = PlantedTorque(
            effect=effect, shape=shape, coefficients=coefficients, columns=columns, torque=torque
        )
        found.append((missed, len(found), one))
    missed, _, best = min(found)
    return best, missed / float(np.linalg.norm(wanted))


def by_rules(diagnosis: Diagnosis, effect: Effect, torque: PlantedTorque) -> float | None:
    """Return the size from which on a planted torque is named by the rules [N·m]."""
    one_effect = replace(diagnosis, tried=(effect,))
    with patch.object(detectable_size, "planted_torques", lambda *_: [torque]):
        return detectable_sizes(one_effect, DiagnosisSettings())[effect.name]


def compared(work: Path) -> Iterator[Compared]:
    """Yield the shapes whose size was found in a challenge, in the order of its table."""
    subject = read_subjects(work)[0]
    diagnosis, planter = diagnosis_of(subject, work), Planter(subject, work, RunSettings())
    rows = rows_of_table(tables.read(work / FILE, CHALLENGE))
    sizes: Mapping[tuple[str, int], float] = {
        (row["effect"], row["seed"]): row["size_found"] for row in rows if row["size_found"]
    }
    for (name, seed), found in sizes.items():
        effect = BY_NAME[name]
        torque = planted(planter, diagnosis, name, seed, found)
        one, missed = nearest(diagnosis, effect, torque)
        (left,) = detectable_size.left_shares(diagnosis.search.step.precomputed, [one.torque])
        size = by_rules(diagnosis, effect, one)
        result = Compared(effect=name, by_rules=size, found=found, left=float(left), missed=missed)
        print(result, flush=True)
        yield result


def table(found: list[Compared]) -> str:
    """Return the table of the page, and what it shows."""
    lines = [
        "| planted | by the rules | found | left by the base | of that another form |",
        "|---|---|---|---|---|",
    ]
    for name in dict.fromkeys(one.effect for one in found):
        own = [one for one in found if one.effect == name]
        cells = [
            ["none" if one.by_rules is None else number_text(one.by_rules, 2) for one in own],
            [number_text(one.found, 2) for one in own],
            [f"{one.left:.0%}" for one in own],
            [f"{one.missed:.0%}" for one in own],
        ]
        lines.append(f"| `{name}` | {' | '.join(', '.join(one) for one in cells)} |")
    sized = [one for one in found if one.by_rules is not None]
    ratios = [one.by_rules / one.found for one in sized if one.by_rules is not None]
    close = sum(1 / CLOSE <= one <= CLOSE for one in ratios)
    lines.append(
        f"\nOf the {len(found)} shapes {len(sized)} have a size by the rules; {close} of these are"
        f" within a factor of {CLOSE} of the one found."
    )
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> None:
    """Work out all shapes of a case, and write them to the page."""
    work, *names = arguments
    text = table(list(compared(Path(work) / (names[0] if names else SAMPLES))))
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}{text}{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
