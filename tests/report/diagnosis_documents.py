"""A diagnosis, and an extended model of known parameters: another tau_c and two effects."""

import json
from dataclasses import asdict

import numpy as np

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.documents.document import (
    CauseRecord,
    DiagnosisDocument,
    SimulationRecord,
)
from frictioncli.diagnosis.settings import DiagnosisSettings
from frictioncli.report.results import read_results

TORQUE, VELOCITY, EXPONENT, SHIFT, OFFSET = 3.0, 8.0, 1.5, 0.4, 0.5


def stated(value, unit="N·m"):
    return {"estimate": value, "ci95": [value - 0.1, value + 0.1], "unit": unit}


def extended_document(work, torques, *, held_out="day-2"):
    """The base model fitted without one run, with another tau_c and two effects."""
    model = json.loads((work / "model.json").read_text(encoding="utf-8"))
    base, _ = build_problems(torques, "motor", held_out)
    model["linear_about"] = asdict(base.parameters)
    for name in base.names:
        model["parameters"][name]["estimate"] = getattr(base.parameters, name)
    model["parameters"]["tau_c"]["estimate"] += SHIFT
    model["gravity"] = dict(zip(("cosine", "sine", "offset"), base.gravity.tolist(), strict=True))
    model["gravity_about"] = model["gravity"]
    model["effects"] = [
        {
            "name": "stribeck",
            "equation": "dtau = ts*exp(-(v/vs)^k)",
            "channel": "friction",
            "shape": {"velocity": VELOCITY, "exponent": EXPONENT, "shift": 0.0},
            "coefficients": {"boundary_torque": stated(TORQUE)},
        },
        {
            "name": "direction_asymmetry",
            "equation": "dL = offset",
            "channel": "load",
            "shape": {"exponent": 0.5},
            "coefficients": {
                "offset": stated(OFFSET),
                "speed_asymmetry": stated(0.0),
                "viscous_asymmetry": stated(0.0),
            },
        },
    ]
    return model


def cause(names, **changed):
    """A cause with this credible set."""
    fields = {
        "probabilities": {},
        "channel": "friction",
        "claim": "",
        "equation": "",
        "parameters": {},
        "size": 1.0,
        "p_value": 1e-9,
        "seen_in": "speed",
        "figure": None,
        "experiment": "Wait.",
    } | changed
    return CauseRecord(effects=tuple(names), **fields)


def diagnosis(*, sets=(), rmse=1.0, **changed):
    """A diagnosis whose causes have these credible sets, and nothing else."""
    causes = changed.pop("causes", tuple(cause(names) for names in sets))
    fields = {
        "verdict": "named",
        "gain": None,
        "detectable": {},
        "held_out": "day-2",
        "torque_unit": "N·m",
    } | changed
    return DiagnosisDocument(
        joint=2,
        causes=causes,
        simulation=SimulationRecord(rmse=rmse),
        runs=("day-1",),
        settings=DiagnosisSettings(),
        **fields,
    )


def cause_document(number, effects, probabilities, **changed):
    return {
        "effects": effects,
        "probabilities": probabilities,
        "channel": "friction",
        "claim": "Friction is above the model at low speed.",
        "equation": "dtau = ts*exp(-(v/vs)^k)",
        "parameters": {
            "velocity": {"estimate": VELOCITY, "ci95": None, "unit": "deg/s"},
            "boundary_torque": {"estimate": TORQUE, "ci95": [2.5, 3.5], "unit": "N·m"},
        },
        "size": 1.25,
        "p_value": 3e-9,
        "seen_in": "speed",
        "figure": f"diagnosis-{number}.svg",
        "experiment": "Measure more speeds.",
    } | changed


DIAGNOSIS_DOCUMENT = {
    "joint": 2,
    "verdict": "unnamed",
    "causes": [
        cause_document(1, ["stribeck"], {"stribeck": 0.97, "drift": 0.02}),
        cause_document(
            2,
            ["direction_asymmetry", "dress_pack"],
            {"direction_asymmetry": 0.6, "dress_pack": 0.4},
            channel="load",
        ),
        cause_document(
            3,
            [],
            {},
            seen_in="angle",
            claim="Residuals have structure along angle.",
            equation="",
            parameters={},
            figure=None,
        ),
    ],
    "visible": [
        cause_document(
            4,
            ["inertia"],
            {"inertia": 1.0},
            kind="load",
            standing="negligible",
            reason="the base leaves 0.05 N·m, less than 0.10 N·m",
            size=0.05,
            size_ci95=[0.031, 0.069],
            p_value=0.0,
            figure=None,
        )
    ],
    "margin": 0.1,
    "gain": {
        "basis": "new_run",
        "rmse_before": 2.0,
        "rmse_after": 1.0,
        "reduction": 0.5,
        "ci95": [0.4, 0.6],
        "noise_floor": 0.7,
    },
    "detectable": {"stribeck": 0.4, "run_in": None, "payload_change": None},
    "undetectable": {
        "payload_change": "cannot be distinguished from the base model with these data"
    },
    "simulation": {
        "rmse": 2.1,
        "worst": [
            {
                "channel": "friction",
                "axis": "temperature",
                "low": 25.0,
                "high": 31.0,
                "speed": 67.5,
                "misfit": -4.5,
                "phase": "heat-up",
            }
        ],
    },
    "torque_unit": "N·m",
    "runs": ["day-1"],
    "held_out": "day-2",
    "settings": {"alpha": 0.05, "seed": 0},
}


def stribeck_term(speed):
    """The known term of friction, written out by hand."""
    return TORQUE * np.exp(-((speed / VELOCITY) ** EXPONENT))


def write_diagnosis(folder):
    """Write a diagnosis and an extended model into a work folder."""
    torques = read_results(folder).joints[0].torques
    (folder / "diagnosis.json").write_text(json.dumps(DIAGNOSIS_DOCUMENT), encoding="utf-8")
    model = extended_document(folder, torques)
    (folder / "extended-model.json").write_text(json.dumps(model), encoding="utf-8")
    return folder
