"""A plan as ``frictioncli plan`` writes it."""

PLAN = {
    "joint": 2,
    "verdict": "named",
    "torque_unit": "N·m",
    "limits": {
        "low_deg": 15.0,
        "high_deg": 165.0,
        "slowest_deg_s": 1.7,
        "fastest_deg_s": 101.0,
        "hottest_degC": 65.0,
        "payloads_kg": [],
        "speed_step_deg_s": None,
        "beyond_measured": [],
    },
    "programme": {
        "files": ["friction_a2.csv"],
        "duration_s": 1104.6,
        "blocks": [
            {
                "name": "heat",
                "reason": "a second thermal cycle",
                "start_s": 0.0,
                "duration_s": 976.5,
                "motor_temperature_degC": [16.0, 28.3],
                "steps": [
                    {
                        "kind": "heat",
                        "speed_deg_s": 99.0,
                        "low_deg": 15.0,
                        "high_deg": 165.0,
                        "duration_s": 900.0,
                        "until_degC": 65.0,
                    }
                ],
            },
            {
                "name": "even speeds",
                "reason": "the curvature of friction over speed",
                "start_s": 976.5,
                "duration_s": 128.1,
                "motor_temperature_degC": [28.3, 28.4],
                "steps": [
                    {
                        "kind": "series",
                        "speeds_deg_s": [45.0, 21.0],
                        "low_deg": 15.0,
                        "high_deg": 165.0,
                        "payload_kg": None,
                    }
                ],
            },
        ],
    },
    "intervals": [
        {
            "parameter": "run_in.travel",
            "estimate": 3471.0,
            "half_width_now": 1923.0,
            "half_width_after": 861.0,
            "unit": "deg",
            "wide": True,
        },
        {
            "parameter": "tau_c",
            "estimate": 10.6,
            "half_width_now": 0.55,
            "half_width_after": 0.52,
            "unit": "N·m",
            "wide": False,
        },
    ],
    "thermal": {"ambient_degC": 16.0, "time_constant_s": 11398.0},
    "budget_min": 45.0,
    "provenance": {
        "program": "frictioncli",
        "version": "0.1.0",
        "stage": "plan",
        "settings": {},
        "inputs": {},
    },
}
