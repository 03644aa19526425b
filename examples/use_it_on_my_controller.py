"""Use it on my controller.

The model is exported as a C header or a JSON document; the correction of the temperature runs in
the control loop, sample by sample. Here the second day is replayed.
"""

# %%
import sys
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli.deployment.settings import ExportSettings
from frictioncli.model.zero_load import friction_at_zero_load
from frictioncli.stages.export import deployed, export
from frictioncli.stages.run import analyse

logs = Path(__file__).parents[1] / "sample_logs" / "kr10"
work = Path(sys.argv[1] if len(sys.argv) > 1 else "friction-run")
if not (work / "diagnosis.json").exists():
    analyse([logs], work)

# %% Write it down; each file says what was lost in its form
for target in ("c", "json", "urdf", "mjcf", "csv"):
    print(export(work, ExportSettings(to=target)), end="\n\n")

# %% The same in Python, with the corrector that a control loop would keep
joint = deployed(work, ExportSettings(to="json", k=5, tmax=3600))
corrector = joint.corrector()

# %% The second day's measured pairs, in their order, stand for what the robot does
torques = pd.read_parquet(work / "torques.parquet")
pairs = friction_at_zero_load(torques[torques["run"] == "day2"], joint.base.alpha)
cycle = pairs[pairs["phase"] != "sweep"]

missed = {"motor temperature alone": [], "corrected": []}
events = []
wanted = False
for pair in cycle.itertuples():
    corrector.update(pair.time, pair.motor_temperature, registered=pair.motor_temperature_reading)
    wanted = wanted or corrector.is_due
    # the task goes on until a pair at the correction speed comes by
    if wanted and abs(pair.speed / joint.correction_speed - 1) < 0.02:
        corrector.correct(friction=pair.friction_torque, load=0.0, speed=pair.speed)
        events.append(pair.time)
        wanted = False
    bare = joint.friction(load=0.0, speed=pair.speed, temperature=pair.motor_temperature)
    missed["motor temperature alone"].append(pair.friction_torque - float(bare))
    missed["corrected"].append(pair.friction_torque - corrector.friction(0.0, pair.speed))

print(f"{len(events)} corrections, at", ", ".join(f"{time / 60:.0f}" for time in events), "min")

# %% The extended model knows the gear's temperature: no correction at all
# What warms the gear is friction torque times speed; a controller knows it at every moment. This
# log has no record of the moves that heat the joint up between the pairs. As in the fit, they are
# taken to be like the fastest pairs, as long as the motor warms. The state begins with the day.
joint = deployed(work, ExportSettings(to="json", extended=True))
corrector = joint.corrector()
missed["extended, not corrected"] = errors = []
stroke = 2 * np.ptp(torques["position"])
load_part = joint.base.alpha * np.mean(np.square(torques["load_torque"]))
fastest, before, friction, fast = pairs["speed"].max(), None, 0.0, 0.0
for pair in pairs.itertuples():
    power = 0.0
    if before is not None:
        passed = pair.time - before.time
        recorded = min(stroke / before.speed / passed, 1.0)
        warming = pair.motor_temperature > before.motor_temperature
        power = recorded * friction * before.speed + (1 - recorded) * warming * fast
    corrector.update(
        pair.time,
        pair.motor_temperature,
        housing_temperature=pair.housing_temperature,
        power=power,
    )
    predicted = corrector.friction(0.0, pair.speed)
    if pair.phase != "sweep":
        errors.append(pair.friction_torque - predicted)
    before, friction = pair, predicted + load_part
    if pair.speed > 0.9 * fastest:
        fast = friction * pair.speed

# %% What each of them misses
for name, errors in missed.items():
    print(f"{name:24s} misses friction by {np.sqrt(np.mean(np.square(errors))):.2f} N·m RMS")
print(
    f"at the end friction arises {corrector.gear.excess:+.1f} °C from the motor's temperature;"
    f" start and time constant leave that uncertain by {corrector.gear.uncertainty:.1f} °C"
)
