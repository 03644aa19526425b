"""One world of the planning study: made ambiguous, planned for, measured again in three ways."""

import random
import time

import pandas as pd

from frictioncli.design.blocks import all_blocks
from frictioncli.design.plan import CHECK, plan_joint
from frictioncli.design.selection import steps_of
from frictioncli.design.settings import PlanSettings
from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.diagnose import diagnose_joint
from frictioncli.diagnosis.documents.extended_document import extended_model
from frictioncli.diagnosis.documents.from_diagnosis import diagnosis_document, extended_document
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.search.cause_search import find_causes
from frictioncli.diagnosis.search.margin import margin_of
from frictioncli.diagnosis.search.standing import with_standing, without_cancelling
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.effects import EFFECTS
from frictioncli.errors import OptionError
from frictioncli.model.fitting import fit_joint
from frictioncli.model.settings import FitSettings
from tests.simulation.motion_programme import simulate_programmes
from tests.studies.planning_random import blocks_at_random, motions_at_random
from tests.studies.planning_worlds import KEY, World, acts_of, beginning, thin

MAX_SPEED = 180.0
"""What the plans, and blocks at random, may use: the joint's own limit, which the thin experiment
does not reach. [deg/s]"""

TEMPERATURE = "motor"
WAYS = ("plan", "repeat", "blocks", "motions")
"""The plan, the thin experiment again, blocks at random, and motions at random; all of the same
length."""

COLUMNS = (
    *KEY,
    "sources",
    "verdict",
    "sets",
    "truth_held",
    "expected",
    "programme",
    *(f"{way}_sets" for way in WAYS),  # causes by ; and effects of a set by |, of all runs
    "note",
    "seconds",
)


def examined(world: World, digest: str) -> dict[str, object]:
    """Simulate one world, plan for it if its verdict is ambiguous, and return its row."""
    began = time.perf_counter()
    row: dict[str, object] = dict(zip(KEY, world.key, strict=True))
    row["sources"] = digest
    try:
        row |= _compared(world)
    except OptionError as error:
        row |= {"verdict": "not hidden", "note": str(error)}
    except Exception as error:  # a world that breaks down is a result, too
        row |= {"verdict": "failed", "note": f"{type(error).__name__}: {error}"}
    row["seconds"] = f"{time.perf_counter() - began:.1f}"
    return row


def _compared(world: World) -> dict[str, object]:
    first = thin(world.design)
    torques = simulate_programmes(world.settings(), [first], 1)[0]
    said = _diagnosed(torques)
    row: dict[str, object] = {"verdict": said.verdict, "sets": _sets(said)}
    open_sets = [cause.effects for cause in said.causes if len(cause.effects) > 1]
    row["truth_held"] = int(any(world.hidden in names for names in open_sets))
    if said.verdict != "ambiguous" or not row["truth_held"]:
        return row
    model = fit_joint(torques, {}, FitSettings(temperature=TEMPERATURE))
    settings = PlanSettings(minutes=world.minutes, max_speed=MAX_SPEED)
    plan = plan_joint(
        torques,
        "N·m",
        diagnosis_document(said, DiagnosisSettings()),
        extended_model(extended_document(said, model)),
        settings,
    )
    row["expected"] = ";".join(f"{one:.3f}" for one in plan.after_check.decision)
    row["programme"] = ";".join(block.name for block in plan.blocks)
    chance = random.Random(" ".join(world.key))
    blocks = all_blocks(plan.limits, settings.seed)
    days = [60 * world.minutes * share for share in (1 - CHECK, CHECK)]
    for way, (programme, check) in {
        "plan": [acts_of(steps_of(part)) for part in (plan.blocks, plan.check)],
        "repeat": [beginning(first, seconds) for seconds in days],
        "blocks": [blocks_at_random(chance, blocks, seconds) for seconds in days],
        "motions": [motions_at_random(chance, MAX_SPEED, seconds) for seconds in days],
    }.items():
        runs = simulate_programmes(world.settings(), [first, programme, check], 1)
        row[f"{way}_sets"] = _named(pd.concat(runs, ignore_index=True))
    return row


def _named(torques: pd.DataFrame) -> str:
    """Return the sets of causes that are named by all runs together, the last one not kept out."""
    problem, _ = build_problems(torques, TEMPERATURE)
    settings = DiagnosisSettings()
    margin = margin_of(problem, "N·m", settings)
    found = find_causes(problem, EFFECTS, settings, margin)
    judged = with_standing(found.causes, problem, margin, settings.alpha)
    judged = without_cancelling(judged, problem)
    causes = [cause for cause in judged if cause.standing == "named"]
    return ";".join("|".join(cause.effects) for cause in causes)


def _diagnosed(torques: pd.DataFrame) -> Diagnosis:
    return diagnose_joint(torques, TEMPERATURE, "N·m", DiagnosisSettings())


def _sets(said: Diagnosis) -> str:
    return ";".join("|".join(cause.effects) for cause in said.causes)
