"""One joint of the blind study: simulated, diagnosed, and what is true and what is said in a row.

What has no fixed form stands in a row as JSON.
"""

import json
import time
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict
from typing import Any

from frictioncli.errors import NotEnoughData, OptionError
from frictioncli.model.document import PARAMETERS
from tests.studies.blind_diagnosed import (
    Said,
    said_of_logs,
    said_of_torques,
    sizes_without_discrepancy,
)
from tests.studies.blind_truth import Truth, truth_of
from tests.studies.blind_worlds import KEY, MEASUREMENT, World

NOT_PLANTED = "not planted"
"""Verdict where the programme cannot show the effect in that size."""

FAILED = "failed"
"""Verdict where the program broke down."""

DOCUMENTS = (
    *("hidden", "nuisances", "causes", "visible", "structure", "parameters", "detectable"),
    "without_discrepancy",
)
"""Columns that hold JSON."""

NUMBERS = (
    *("margin", "share_seen", "nuisance", "before", "after", "floor", "reachable"),
    *("with_term", "floor_said", "diagnosed", "seconds"),
)
"""Columns that hold a number."""

COLUMNS = (
    *KEY,
    "sources",
    "verdict",
    *(f"{name}_json" for name in DOCUMENTS),
    *NUMBERS,
    "note",
)

POWER = 5
"""Every so many-th joint with nothing hidden is asked for its sizes without discrepancy."""

_OF_CAUSE = (
    *("effects", "kind", "channel", "standing", "holds_on_new_run", "size", "p_value", "reason"),
    *("visible_size", "visible_ci95", "size_ci95", "seen_in", "when", "probabilities"),
    "only_on_new_run",
)
"""What is kept of a cause, where the diagnosis says it."""


def examined(world: World, digest: str) -> dict[str, object]:
    """Simulate one joint, diagnose it and return its row."""
    began = time.perf_counter()
    row: dict[str, object] = dict(zip(KEY, world.key, strict=True))
    row["sources"] = digest
    try:
        truth = truth_of(world)
        row |= _true(truth)
        said = said_of_logs(world) if world.path == "logs" else said_of_torques(truth.torques)
        row |= _said(said, with_sizes=world.kind == "clean")
        row["hidden_json"] = _json(_hidden(truth, _given_up(said)))
        if world.kind == "clean" and world.seed % POWER == 0:
            row["without_discrepancy_json"] = _json(sizes_without_discrepancy(truth.torques))
    except OptionError as error:
        row |= {"verdict": NOT_PLANTED, "note": str(error)}
    except NotEnoughData as error:
        row |= {"verdict": "no_evidence", "note": str(error)}
    except Exception as error:  # a joint on which the program breaks down is a result, too
        row |= {"verdict": FAILED, "note": f"{type(error).__name__}: {error}"}
    row["seconds"] = f"{time.perf_counter() - began:.2f}"
    return row


def _hidden(truth: Truth, given_up: Collection[str]) -> list[dict[str, object]]:
    """Return what is true of each effect, and what is left beside what the diagnosis set there."""
    left = truth.left_beside(given_up)
    return [
        asdict(one) | {"left_beside": size} for one, size in zip(truth.hidden, left, strict=True)
    ]


_GIVEN_UP = ("physically impossible", "these data determine")


def _given_up(said: Said) -> set[str]:
    """Return effects of the measurement that the diagnosis did not set beside the base."""
    in_sets = {
        name
        for cause in said.diagnosis["causes"]
        if cause["kind"] != "measurement"
        for name in cause["effects"]
        if name in MEASUREMENT
    }
    return in_sets | {
        name
        for cause in said.diagnosis.get("visible", ())
        for name in cause["effects"]
        if cause["kind"] == "measurement"
        and cause["standing"] == "undetermined"
        and any(text in cause["reason"] for text in _GIVEN_UP)
    }


def _true(truth: Truth) -> dict[str, object]:
    return {
        "hidden_json": _json(_hidden(truth, ())),
        "nuisances_json": _json(truth.nuisances),
        "margin": f"{truth.margin:.4g}",
        "share_seen": f"{truth.share_seen:.5g}",
        "nuisance": f"{truth.nuisance:.4g}",
        "before": f"{truth.before:.5g}",
        "floor": f"{truth.floor:.5g}",
        "reachable": f"{truth.reachable:.5g}",
    }


def _parameters(model: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the parameters of friction, beside the forms of what has no name if there are any."""
    beside = (model.get("empirical") or {}).get("parameters_beside")
    return beside or model["parameters"]


def _said(said: Said, *, with_sizes: bool) -> dict[str, object]:
    diagnosis = said.diagnosis
    gain, term = diagnosis.get("gain") or {}, _term(diagnosis)
    return {
        "verdict": diagnosis["verdict"],
        "causes_json": _json([_cause(one) for one in diagnosis["causes"] if one["effects"]]),
        "visible_json": _json([_cause(one) for one in diagnosis.get("visible", ())]),
        "structure_json": _json(_structure(diagnosis)),
        "parameters_json": _json(
            {name: _parameter(_parameters(said.model).get(name, {})) for name in PARAMETERS}
        ),
        "detectable_json": _json(diagnosis["detectable"]) if with_sizes else "",
        "after": f"{gain['rmse_after']:.5g}" if gain else "",
        "with_term": f"{term['rmse_after']:.5g}" if term.get("basis") == "new_run" else "",
        "floor_said": f"{gain['noise_floor']:.5g}" if gain else "",
        "diagnosed": f"{said.seconds:.2f}",
    }


def _term(diagnosis: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what the empirical term gains, of structure or of the smooth error of any joint."""
    return diagnosis.get("empirical") or diagnosis.get("discrepancy") or {}


def _cause(cause: Mapping[str, Any]) -> dict[str, Any]:
    found = {name: cause[name] for name in _OF_CAUSE if cause.get(name) is not None}
    if "parameters" in cause:
        found["parameters"] = {name: _parameter(one) for name, one in cause["parameters"].items()}
    return found


def _structure(diagnosis: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return structure without a name: its own entry, or the cause that has no effects."""
    found = diagnosis.get("structure")
    if found:
        return {name: found[name] for name in ("axis", "channel", "size", "ci95") if name in found}
    for cause in diagnosis["causes"]:
        if not cause["effects"]:
            axis = [part.strip() for part in cause["seen_in"].split(" and ")]
            return {"axis": axis, "channel": cause["channel"], "size": cause["size"]}
    return None


def _parameter(one: Mapping[str, Any]) -> list[float | None]:
    """Return estimate and interval of a parameter."""
    low, high = one.get("ci95") or (None, None)
    return [one.get("estimate"), low, high]


def _json(value: object) -> str:
    """Return JSON without blanks, numbers with five digits."""
    return json.dumps(_rounded(value), separators=(",", ":"), ensure_ascii=False)


def _rounded(value: object) -> object:
    if isinstance(value, float):
        return float(f"{value:.5g}")
    if isinstance(value, Mapping):
        return {str(name): _rounded(one) for name, one in value.items()}
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [_rounded(one) for one in value]
    return value
