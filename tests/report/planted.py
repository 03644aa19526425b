"""A diagnosis, and an extended model with known effects: another tau_c and two terms."""

import json
from dataclasses import asdict

from frictioncli.diagnosis.data.build_problem import build_problems
from frictioncli.diagnosis.documents.document import (
    CauseRecord,
    DiagnosisDocument,
    SimulationRecord,
)
from frictioncli.diagnosis.settings import DiagnosisSettings

TORQUE, VELOCITY, EXPONENT, SHIFT, OFFSET = 3.0, 8.0, 1.5, 0.4, 0.5


def stated(value, unit="N·m"):
    return {"estimate": value, "ci95": [value - 0.1, value + 0.1], "unit": unit}


def extended(work, torques, *, held_out="day-2"):
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


def cause(names, experiment="Wait."):
    """A cause with this credible set."""
    return CauseRecord(
        effects=tuple(names),
        probabilities={},
        channel="friction",
        claim="",
        equation="",
        parameters={},
        size=1.0,
        p_value=1e-9,
        seen_in="speed",
        figure=None,
        experiment=experiment,
    )


def diagnosis(*, sets, rmse, **changed):
    """A diagnosis whose causes have these credible sets, with nothing else to tell."""
    told = {"verdict": "named", "gain": None, "detectable": {}, "held_out": "day-2"} | changed
    return DiagnosisDocument(
        joint=2,
        causes=tuple(cause(names) for names in sets),
        simulation=SimulationRecord(rmse=rmse),
        torque_unit="N·m",
        runs=("day-1",),
        settings=DiagnosisSettings(),
        **told,
    )
