"""An extended model with known effects: the base model with another tau_c and two terms."""

import json
from dataclasses import asdict

from frictioncli.diagnosis.data.problem import build_problems

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
            "shape": {"velocity": VELOCITY, "exponent": EXPONENT, "shift": 0.0},
            "coefficients": {"boundary_torque": stated(TORQUE)},
        },
        {
            "name": "direction_asymmetry",
            "shape": {"exponent": 0.5},
            "coefficients": {
                "offset": stated(OFFSET),
                "speed_asymmetry": stated(0.0),
                "viscous_asymmetry": stated(0.0),
            },
        },
    ]
    return model
